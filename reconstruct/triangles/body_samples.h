#pragma once

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/context.h"
#include "reconstruct/cloud/point_cloud.h"
#include "reconstruct/triangles/face_patches.h"
#include "reconstruct/triangles/face_sides.h"
#include "reconstruct/triangles/plane_caps.h"
#include "reconstruct/triangles/touching_pieces.h"
#include "reconstruct/triangles/triangle_mesh.h"

namespace umtet {

struct BodySampleParams {
  double spacing = 0;                   ///< of the samples at most, model units; 0: default_spacing()
  bool turn = true;                     ///< false: triangles look to the side that they look to
  bool cap = true;                      ///< close openings with a plane rim by that plane (plane_caps.h)
  Touching touching = Touching::Apart;  ///< what becomes of pieces that meet along an edge or at a corner
};
std::vector<std::string> problems(const BodySampleParams&);

/// What the triangles were like, and what became of them.
struct TriangleReport {
  std::size_t n_triangles = 0;  ///< as they came
  DroppedFaces dropped;
  FaceSidesReport sides;
  double spacing = 0;                    ///< of the samples
  double least_spacing = 0;              ///< where the body, or a gap in it, is thin
  std::optional<double> thickness = {};  ///< that a two-hundredth of the surface falls below; none where all is thick
  std::size_t n_samples = 0;             ///< of all triangles
  std::size_t n_inside = 0;              ///< of these, inside of the body: of inner walls, and where bodies overlap
  std::size_t n_inside_out = 0;          ///< between outside and inside-out: no boundary of the body
  /// Share of the samples at which the winding number is not within a quarter of a whole number: which side is inside
  /// is a guess there.
  double unsure = 0;
  std::vector<PlaneCap> caps = {};  ///< openings that were closed
  TouchingReport touching = {};
};

/// The triangles bound no body; what() says why.
struct NoBody : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

/// The boundary of the body that triangles bound, as a scan.
struct BodySamples {
  /// Labels where the triangles have some, or an opening was closed: the first cap has the least label above all
  /// others, the next one that and one more, and triangles without a label are 1 then.
  OrientedPointCloud cloud;
  TriangleMesh boundary;  ///< the triangles on the boundary, outward; label 0: only a part of it is
  TriangleReport report;
};

/// Samples of the boundary of {w > 1/2}, w the winding number of all triangles (triangle_winding.h) once they look
/// outward (face_sides.h) and openings with a plane rim are closed. Spread as sample_triangles() does; normals are
/// those of the triangles. Where the body, or a gap between two sheets of it, is thinner than three spacings
/// (body_thickness.h) samples are nearer to each other, a third of that: there the triangles are cut into pieces of
/// some spacings, each of which has a spacing of its own, one of a few.
///
/// A sample stays where w is near zero just before it, at most .3: then it falls to that from behind it, by one. Where
/// a part is missing it falls from less than one, and lower. Before an inner wall, which has the body on both sides, it
/// is about 1/2, and inside of an overlap 1.
///
/// \throw std::invalid_argument  a problem of params; no triangle has an area; more than 20 million samples
/// \throw NoBody     triangles that hardly share an edge, and whose winding number is no whole number
/// \throw Cancelled
///
/// Cost: O(n log n), some ten microseconds a sample. The result does not depend on the number of threads.
BodySamples sample_body(TriangleMesh mesh, const BodySampleParams& params = {}, const Context& context = {});

/// The spacing that is chosen: .006 of the diagonal, or as many samples as the triangles have corners if that is
/// finer; at most a million samples.
double default_spacing(const TriangleMesh& mesh);

}  // namespace umtet
