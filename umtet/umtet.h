#pragma once

#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "body/errors.h"
#include "body/fidelity/mesh_measures.h"
#include "body/fidelity/verdict.h"
#include "body/options.h"
#include "body/scan/scan_reports.h"
#include "body/shared_function.h"
#include "common/context.h"
#include "common/message.h"
#include "mesh/core/tet_mesh.h"
#include "mesh/second_order/quadratic_tets.h"
#include "reconstruct/cloud/cloud_file.h"
#include "reconstruct/cloud/point_cloud.h"
#include "reconstruct/level_set/level_set.h"
#include "reconstruct/triangles/body_samples.h"
#include "reconstruct/triangles/triangle_mesh.h"

// From a scan, triangles, a level set or a function to a certified tetrahedral mesh, in memory: the way of `umtet run`
// without files. Include this header alone.
//
//   const umtet::Mesh mesh = umtet::mesh_body(cloud);
//   std::printf("%zu tets: %s\n", mesh.tets.size(), mesh.verdict.word().c_str());
namespace umtet {

/// All options, with defaults that suit most bodies.
struct Options {
  BodyOptions body = {};
  VerdictOptions verdict = {};
  /// How triangles are sampled. Spacing 0: from mesh.h if it is given, else default_spacing(). NormalsOf::Given turns
  /// no triangles; Closing::Smooth and Closing::None leave plane openings to the fit.
  BodySampleParams triangles = {};
  std::optional<Box> box = {};                                  ///< that the background has to cover; none: that of psi
  double max_memory = std::numeric_limits<double>::infinity();  ///< bytes that the mesh may take
  Context context = {};                                         ///< progress and cancellation
};

/// A mesh with its certificate. All coordinates are those of the input.
struct Mesh {
  std::vector<Vec3> points;
  std::vector<Tet> tets;           ///< positive orientation
  std::vector<Triangle> boundary;  ///< faces on psi = 0, counter-clockwise from outside
  std::vector<int> labels = {};    ///< of each boundary face, if the input has labels: vote_labels() of the samples
  std::vector<Triangle> walls;     ///< faces in the walls of the box, with MeshOptions::box_walls
  std::optional<QuadraticTetMesh> curved = {};  ///< the same with mid-sides, with MeshOptions::order = 2
  double h = 0;                                 ///< edge length of the background, the least if it is graded
  MeshMeasures measures;                        ///< what is true of it
  Verdict verdict;                              ///< whether that will do, and why not
  std::vector<Message> notices = {};            ///< what was changed or guessed on the way; text_of() says it
};

/// psi of a scan or of triangles.
struct FittedBody {
  LevelSet psi;              ///< in working coordinates: those of the cloud less report.shift
  OrientedPointCloud cloud;  ///< the samples that it was fitted to
  LevelSetReport report;
  InputFacts facts;                              ///< what was done to the normals, or guessed
  std::optional<TriangleMesh> boundary = {};     ///< the given triangles on the boundary of the body, outward
  std::optional<TriangleReport> triangles = {};  ///< what was changed in the given triangles
  std::vector<Message> notices;                  ///< what was changed or guessed; text_of() says it
};

/// Cleans a scan, orients its normals and fits psi.
/// @param cloud  without normals, or with zero ones, these are estimated
/// \throw std::invalid_argument  arrays of different lengths, or points that are not finite or beyond 1e50
/// \throw CloudRefused, SolveError, SolveTooLarge, UsageError, Cancelled
FittedBody fit_body(OrientedPointCloud cloud, const Options& options = {});

/// Samples the boundary of the body that triangles bound, and fits psi.
/// \throw std::invalid_argument  indices out of range, no triangle with an area, or more than 20 million samples
/// \throw NoBody                 triangles that bound no body
/// \throw CloudRefused, SolveError, SolveTooLarge, UsageError, Cancelled
FittedBody fit_body(TriangleMesh triangles, const Options& options = {});

/// Meshes {psi < 0}. A mesh whose certificate fails is returned all the same: see Mesh::verdict. The mesh of triangles
/// is also measured against them.
///
/// \throw TooThin            there is no mesh, as the body is thinner than h can show
/// \throw MeshingImpossible  there is no mesh for another reason
/// \throw ResourceLimit, UsageError, Cancelled
Mesh mesh_body(const FittedBody& body, const Options& options = {});

/// Fits psi and meshes it. \throw as fit_body() and mesh_body()
Mesh mesh_body(OrientedPointCloud cloud, const Options& options = {});
Mesh mesh_body(TriangleMesh triangles, const Options& options = {});

/// Meshes {psi < 0} of a function with a Hessian. \throw as mesh_body(); std::invalid_argument  there is no options.box
Mesh mesh_body(const SharedFunction& psi, const Options& options);

/// The same for any implicit function, for instance a LevelSet, which is moved or copied.
template <ImplicitFunction F>
Mesh mesh_body(F psi, const Options& options) {
  return mesh_body(shared_function(std::move(psi)), options);
}

}  // namespace umtet
