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
#include "mesh/certify/quadratic_tets.h"
#include "mesh/core/tet_mesh.h"
#include "reconstruct/cloud/cloud_file.h"
#include "reconstruct/cloud/point_cloud.h"
#include "reconstruct/level_set/level_set.h"

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
  std::optional<Box> box = {};  ///< that the background has to cover; none: that of psi
  double max_memory = std::numeric_limits<double>::infinity();  ///< bytes that the mesh may take
  Context context = {};                                         ///< progress and cancellation
};

/// A mesh with its certificate. All coordinates are those of the input.
struct Mesh {
  std::vector<Vec3> points;
  std::vector<Tet> tets;            ///< positive orientation
  std::vector<Triangle> boundary;   ///< faces on psi = 0, counter-clockwise from outside
  std::vector<Triangle> walls;      ///< faces in the walls of the box, with MeshOptions::box_walls
  std::optional<QuadraticTetMesh> curved = {};  ///< the same with mid-sides, with MeshOptions::order = 2
  double h = 0;                                 ///< edge length of the background, the least if it is graded
  MeshMeasures measures;                        ///< what is true of it
  Verdict verdict;                              ///< whether that will do, and why not
  std::vector<std::string> notices = {};        ///< what was changed or guessed on the way
};

/// psi of a scan.
struct FittedBody {
  LevelSet psi;              ///< in working coordinates: those of the cloud less report.shift
  OrientedPointCloud cloud;  ///< the samples that it was fitted to
  LevelSetReport report;
  InputFacts facts;                  ///< what was done to the normals, or guessed
  std::vector<std::string> notices;  ///< what was changed or guessed
};

/// Cleans a scan, orients its normals and fits psi.
/// @param cloud  without normals, or with zero ones, these are estimated
/// \throw std::invalid_argument  arrays of different lengths, or points that are not finite or beyond 1e50
/// \throw CloudRefused, SolveError, SolveTooLarge, UsageError, Cancelled
FittedBody fit_body(OrientedPointCloud cloud, const Options& options = {});

/// Meshes {psi < 0}. A mesh whose certificate fails is returned all the same: see Mesh::verdict.
/// \throw TooThin            there is no mesh, as the body is thinner than h can show
/// \throw MeshingImpossible  there is no mesh for another reason
/// \throw ResourceLimit, UsageError, Cancelled
Mesh mesh_body(const FittedBody& body, const Options& options = {});

/// Both. \throw as fit_body() and mesh_body()
Mesh mesh_body(OrientedPointCloud cloud, const Options& options = {});

/// Meshes {psi < 0} of a function with a Hessian. \throw as mesh_body(); std::invalid_argument  there is no options.box
Mesh mesh_body(const SharedFunction& psi, const Options& options);

/// The same for any implicit function, for instance a LevelSet, which is moved or copied.
template <ImplicitFunction F>
Mesh mesh_body(F psi, const Options& options) {
  return mesh_body(shared_function(std::move(psi)), options);
}

}  // namespace umtet
