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

/// Parameters of sample_body().
struct BodySampleParams {
  double spacing = 0;                   ///< maximum spacing of the samples, model units; 0: default_spacing()
  bool turn = true;                     ///< false: triangles keep their orientation
  bool cap = true;                      ///< close openings with a plane rim by that plane (plane_caps.h)
  Touching touching = Touching::Apart;  ///< treatment of pieces that meet along an edge or at a corner
};
std::vector<std::string> problems(const BodySampleParams&);

/// Properties of the triangles, and the changes made to them.
struct TriangleReport {
  std::size_t n_triangles = 0;  ///< number of triangles of the input
  DroppedFaces dropped;
  FaceSidesReport sides;
  double spacing = 0;                    ///< spacing of the samples
  double least_spacing = 0;              ///< least spacing, used where the body or a gap in it is thin
  std::optional<double> thickness = {};  ///< thickness below which a two-hundredth of the surface lies; none if the
                                         ///< body is thick everywhere
  std::size_t n_samples = 0;             ///< samples of all triangles
  std::size_t n_inside = 0;              ///< samples inside the body: of inner walls, and where bodies overlap
  std::size_t n_inside_out = 0;  ///< samples between outside and inside-out, which are not on the body's boundary
  /// Fraction of the samples at which the winding number differs from a whole number by more than a quarter. There the
  /// inner side is a guess.
  double unsure = 0;
  std::vector<PlaneCap> caps = {};  ///< openings that were closed
  TouchingReport touching = {};
};

/// Error for triangles that bound no body; what() states the reason.
struct NoBody : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

/// A triangle on the boundary of a body has the label group + 1, or -group if a part of it is inside the body. Its
/// group is its label in the input if that is positive, else 0; all groups are 0 without labels in the input, or with
/// more than kMostGroupsOfBody different ones.
inline constexpr std::size_t kMostGroupsOfBody = 1000;
inline bool is_partly_inside(int label) { return label <= 0; }
inline int group_of(int label) { return label <= 0 ? -label : label - 1; }

/// The boundary of the body bounded by triangles, sampled as a scan.
struct BodySamples {
  /// With labels if the triangles have labels, or an opening was closed. The first cap has the least label above all
  /// others, the next caps follow, and triangles without a label then have label 1.
  OrientedPointCloud cloud;
  /// The triangles on the boundary, outward, with the lines of the input. Labels are those of group_of().
  TriangleMesh boundary;
  TriangleReport report;
};

/// Samples the boundary of {w > 1/2}, with w the winding number of all triangles (triangle_winding.h) after they are
/// oriented outward (face_sides.h) and openings with a plane rim are closed. Samples are distributed as by
/// sample_triangles(); normals are those of the triangles. Where the body, or a gap between two sheets of it, is
/// thinner than three spacings (body_thickness.h), the spacing is a third of the thickness. The triangles are cut there
/// into pieces of some spacings, and each piece has one of a few spacings.
///
/// A sample is kept if w is close to zero just in front of it, at most .3: w then falls by one to this value from
/// behind the sample. Where a part is missing, it falls from less than one to a lower value. In front of an inner wall,
/// which has the body on both sides, it is about 1/2, and inside of an overlap 1.
///
/// \throw std::invalid_argument for a problem of params, if no triangle has an area, or for more than 20 million
///        samples
/// \throw NoBody for triangles that share few edges, and whose winding number is not a whole number
/// \throw Cancelled
///
/// Cost: O(n log n), about ten microseconds per sample. The result does not depend on the number of threads.
BodySamples sample_body(TriangleMesh mesh, const BodySampleParams& params = {}, const Context& context = {});

/// The default spacing: .006 of the diagonal, or the spacing with as many samples as the triangles have corners if this
/// is finer; at most a million samples.
double default_spacing(const TriangleMesh& mesh);

}  // namespace umtet
