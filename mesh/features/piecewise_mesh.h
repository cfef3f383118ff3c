#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "common/context.h"
#include "mesh/background/background_mesh.h"
#include "mesh/core/piecewise_domain.h"
#include "mesh/core/tet_mesh.h"
#include "mesh/fast/fast_params.h"
#include "mesh/fast/flips/local_flips.h"
#include "mesh/features/feature_embedding.h"
#include "mesh/features/feature_graph.h"
#include "mesh/features/stratified_projection.h"
#include "mesh/submesh/chosen_submesh.h"
#include "mesh/submesh/submesh_params.h"
#include "mesh/submesh/um_result.h"

namespace umtet {

/// Parameters of make_piecewise_mesh().
struct PiecewiseMeshParams {
  SubmeshParams submesh = {};
  ClassificationParams classification = {};
  int layers = 4;  ///< layers of vertices behind the boundary that move; >= 1
  StratifiedProjectionParams projection = {};
  SmoothingParams smoothing = {};
  bool flips = true;
  LocalFlipParams local_flips = {};

  PiecewiseMeshParams();
};

/// A mesh that fits a piecewise smooth domain.
struct PiecewiseMesh {
  UmStatus status = UmStatus::Success;
  UmEvidence evidence;  ///< set when status != Success
  TetMesh mesh;
  std::vector<std::int64_t> background_vertex;  ///< id in the background of each vertex, ascending
  std::vector<double> h;                        ///< edge length of the background at each vertex
  std::vector<std::int64_t> tet_of_chosen;      ///< per tet: its number in `chosen`, ascending; then -1 for new ones
  std::vector<Triangle> faces;                  ///< the boundary, outward
  std::vector<int> face_tet;                    ///< per face: its tet, ascending
  std::vector<int> face_patch;                  ///< per face; -1: no single patch
  FeatureGraph graph;                           ///< the curves and corners of the domain
  std::vector<Stratum> strata;                  ///< as FeatureEmbedding::strata
  std::vector<int> stratum;                     ///< per vertex; -1 inside
  std::vector<int> corner_vertex;               ///< per corner of the graph; -1: none
  /// Per curve of the graph: its vertices in order, of a closed one with the first at the end again; empty where the
  /// curve could not be embedded.
  std::vector<std::vector<int>> chains;
  std::vector<FeatureDefect>
      defects;  ///< everything that is not as the domain asks for; the mesh is valid all the same
  LocalFlipReport flips;
  /// The mesh before the flips: omega_h with coordinates of the background, and its vertices after projection and after
  /// smoothing.
  Submesh chosen;
  std::vector<Vec3> projected, smoothed;
};

/// Boundary-fitting mesh of a piecewise smooth domain. Its sharp curves are chains of edges, its corners vertices, and
/// its faces lie on one patch each.
///
/// 1. The inside vertices are chosen as for a smooth body (classification.h).
/// 2. The curves of the domain are traced (feature_graph.h) and embedded in the boundary of omega_h
///    (feature_embedding.h).
/// 3. Boundary vertices move onto their corner, curve or patch (stratified_projection.h); then they slide there while
///    the layer is smoothed (p_norm_smoothing.h).
/// 4. Local flips raise the worst tets (local_flips.h): omega_h has an inside vertex in every tet, and so at least two
///    tets at every edge, where one would often be better.
///
/// The bytes are the same for any number of threads.
/// @param graph  the curves and corners; null: they are traced. \pre not null unless domain.decides_by_signs()
/// \throw std::invalid_argument naming every broken constraint of params; Cancelled
PiecewiseMesh make_piecewise_mesh(const PiecewiseDomain& domain, const BackgroundMesh& background,
                                  const PiecewiseMeshParams& params = {}, const Context& context = {},
                                  const FeatureGraph* graph = nullptr);

/// Steps 2 to 4 of make_piecewise_mesh(). Reports the steps "project", "relax" and "repair".
/// @param chosen  result of choose_submesh() in UmMode::Fast with params.classification; a failure there is passed on
/// @param graph   the curves and corners of the domain, where they are known; null: they are traced
/// \throw as make_piecewise_mesh()
PiecewiseMesh fit_piecewise_mesh(const PiecewiseDomain& domain, const BackgroundMesh& background, ChosenSubmesh chosen,
                                 const FeatureGraph* graph = nullptr, const PiecewiseMeshParams& params = {},
                                 const Context& context = {});

}  // namespace umtet
