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
#include "body/patches/boundary_division.h"
#include "body/regions/label_regions.h"
#include "body/regions/region_bodies.h"
#include "body/scan/scan_reports.h"
#include "body/shared_function.h"
#include "common/context.h"
#include "common/message.h"
#include "mesh/core/piecewise_domain.h"
#include "mesh/core/tet_mesh.h"
#include "mesh/second_order/quadratic_tets.h"
#include "reconstruct/cloud/cloud_file.h"
#include "reconstruct/cloud/point_cloud.h"
#include "reconstruct/level_set/level_set.h"
#include "reconstruct/triangles/body_samples.h"
#include "reconstruct/triangles/triangle_mesh.h"

// Makes a certified tetrahedral mesh of a scan, triangles, a level set or a function in memory, as `umtet run` does
// with files. Users include only this header.
//
//   const umtet::Mesh mesh = umtet::mesh_body(cloud);
//   std::printf("%zu tets: %s\n", mesh.tets.size(), mesh.verdict.word().c_str());
namespace umtet {

/// All options, with defaults that suit most bodies.
struct Options {
  BodyOptions body = {};
  VerdictOptions verdict = {};
  /// Options for sampling triangles. With spacing 0, the spacing follows from mesh.h if it is given, else from
  /// default_spacing(). With NormalsOf::Given no triangle is turned over. With Closing::Smooth and Closing::None the
  /// fit closes plane openings.
  BodySampleParams triangles = {};
  /// Division of the boundary into patches.
  PatchOptions patches = {};
  /// Box that the background must cover; empty: the box of psi.
  std::optional<Box> box = {};
  double max_memory = std::numeric_limits<double>::infinity();  ///< bytes of memory that the mesh may use
  Context context = {};                                         ///< progress and cancellation
};

/// A mesh with its certificate. All coordinates are those of the input.
struct Mesh {
  std::vector<Vec3> points;
  std::vector<Tet> tets;           ///< positive orientation
  std::vector<Triangle> boundary;  ///< faces on psi = 0, counter-clockwise from outside
  std::vector<int> labels = {};    ///< label of each boundary face, if the input has labels (vote_labels())
  std::vector<Triangle> walls;     ///< faces in the walls of the box, with MeshOptions::box_walls
  /// Patches of the boundary and the walls, with the numbers that `umtet export` writes: divide_boundary(), and the
  /// closed holes of a scan by take_holes().
  std::vector<MeshPart> patches = {};
  /// For each face of `boundary`, then for each face of `walls`: its index in `patches`.
  std::vector<int> face_patch = {};
  /// For a piecewise smooth body: the vertices of each sharp edge in order (of a closed one with the first at the end
  /// again; empty: the mesh lacks it).
  std::vector<std::vector<int>> curves = {};
  std::optional<QuadraticTetMesh> curved = {};  ///< the mesh with mid-sides, with MeshOptions::order = 2
  /// Edge length of the background; the least edge length if it is graded.
  double h = 0;
  MeshMeasures measures;              ///< all measurements of the mesh
  Verdict verdict;                    ///< the judgements of the mesh, with reasons
  std::vector<Message> notices = {};  ///< changes and guesses; text_of() returns their texts
};

/// psi of a scan or of triangles.
struct FittedBody {
  LevelSet psi;              ///< in working coordinates, which are those of the cloud minus report.shift
  OrientedPointCloud cloud;  ///< the samples to which it was fitted
  LevelSetReport report;
  InputFacts facts;  ///< changes and guesses of normals
  /// The triangles of the input on the boundary of the body, oriented outwards.
  std::optional<TriangleMesh> boundary = {};
  std::optional<TriangleReport> triangles = {};  ///< changes to the triangles of the input
  std::vector<Message> notices;                  ///< changes and guesses; text_of() returns their texts
};

/// Cleans a scan, orients its normals and fits psi.
/// @param cloud  missing or zero normals are estimated
/// \throw std::invalid_argument  arrays of different lengths, or points that are not finite or have a coordinate beyond
///   1e50
/// \throw CloudRefused, SolveError, SolveTooLarge, UsageError, Cancelled
FittedBody fit_body(OrientedPointCloud cloud, const Options& options = {});

/// Samples the boundary of the body that triangles bound, and fits psi.
/// \throw std::invalid_argument  indices out of range, no triangle with an area, or more than 20 million samples
/// \throw NoBody                 triangles that bound no body
/// \throw CloudRefused, SolveError, SolveTooLarge, UsageError, Cancelled
FittedBody fit_body(TriangleMesh triangles, const Options& options = {});

/// Meshes {psi < 0}. A mesh whose certificate fails is also returned (Mesh::verdict). If the input is triangles, the
/// mesh is also compared with them.
///
/// \throw TooThin            there is no mesh, as the body is thinner than h can show
/// \throw MeshingImpossible  there is no mesh for another reason
/// \throw std::invalid_argument  an angle of options.patches is out of range
/// \throw ResourceLimit, UsageError, Cancelled
Mesh mesh_body(const FittedBody& body, const Options& options = {});

/// Fits psi and meshes it. Clouds and triangles with sharp edges get a function for each smooth patch instead of a fit,
/// and the mesh has the edges; if that mesh is not right, psi is fitted. Edges are found by angle; TriangleMesh::lines
/// and the borders between TriangleMesh::labels are edges, too, and the only ones with SharpEdgeUse::Given. \throw as
/// fit_body() and mesh_body()
Mesh mesh_body(OrientedPointCloud cloud, const Options& options = {});
Mesh mesh_body(TriangleMesh triangles, const Options& options = {});

/// Meshes {psi < 0} of a function with a Hessian. \throw as mesh_body(); std::invalid_argument  there is no options.box
Mesh mesh_body(const SharedFunction& psi, const Options& options);

/// Meshes a body whose boundary is piecewise smooth: its sharp edges are chains of edges, its corners vertices
/// (domain_of_formula() in mesh/features/formula_domain.h). \throw as the former
Mesh mesh_body(const PiecewiseDomain& body, const Options& options);

/// Meshes {psi < 0} of any implicit function, for instance a LevelSet, which is moved or copied.
template <ImplicitFunction F>
Mesh mesh_body(F psi, const Options& options) {
  return mesh_body(shared_function(std::move(psi)), options);
}

/// One of several bodies that mesh_region_bodies() meshes with one mesh, in which they share their interfaces, as
/// `umtet regions` does:
///
///   const umtet::RegionBodyMesh mesh =
///       umtet::mesh_region_bodies({umtet::region_body("bone", bone), umtet::region_body("marrow", marrow)}, {});
///
/// \throw std::invalid_argument  psi has no Hessian
RegionBody region_body(std::string name, const SharedFunction& psi);
/// The body of a fit, in the coordinates of its input, with the samples that judge the mesh.
RegionBody region_body(std::string name, const FittedBody& body);

}  // namespace umtet
