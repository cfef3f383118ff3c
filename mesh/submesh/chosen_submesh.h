#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "common/context.h"
#include "mesh/background/background_mesh.h"
#include "mesh/background/vertex_links.h"
#include "mesh/base/id_set.h"
#include "mesh/core/implicit_function.h"
#include "mesh/submesh/submesh_params.h"
#include "mesh/submesh/um_result.h"

namespace umtet {

/// A vertex that keeps its position of a mesh in another background.
struct KeptVertex {
  std::int64_t vertex;    ///< id in the background
  Vec3 projected, final;  ///< positions, as in UmResult
};

/// The tets of the background mesh that become the mesh, before any vertex has moved.
struct ChosenSubmesh {
  UmStatus status = UmStatus::Success;
  UmEvidence evidence;          ///< set when status != Success
  IdSet inside{0};              ///< background vertices that count as inside; if it is empty, `submesh` is whole
  Submesh submesh;              ///< omega_h: complete, or its vertices only
  bool is_whole = false;        ///< `submesh` includes its tets and faces
  std::vector<Triangle> walls;  ///< for BackgroundBoundary::Wall: see UmResult::walls
  std::vector<ManifoldFlip> manifold_flips;
  std::shared_ptr<const VertexLinks> links;  ///< links of the background if choosing used them, else null
  std::size_t n_tets = 0;  ///< tets of omega_h, and of every mesh made from it; 0 when status != Success
  std::size_t n_psi_evaluations = 0;
  std::vector<KeptVertex> kept;  ///< ascending; empty: all vertices begin at their positions in the background
};

/// Initial result for these choices; moves from `chosen`.
UmResult result_of(ChosenSubmesh&& chosen);

/// "; n of m seeds led to no positively cut tet": text for the evidence of SubmeshSearch::Crawl.
std::string text_of_lost_seeds(std::size_t n_lost, std::size_t n_seeds);

/// omega_h by the sign of psi: Algorithm 1, steps 1-22. The vertices with psi < 0 are inside. Also checks that the
/// domain stays off the background boundary (Section 2.1), or far enough from a wall.
/// @param seeds  for SubmeshSearch::Crawl: at least one point near every component of the boundary
/// \throw std::length_error if omega_h has more than 2^31 - 1 tets or vertices; Cancelled
ChosenSubmesh submesh_by_sign(const BackgroundMesh& background, ImplicitFunctionRef psi, const SubmeshParams& params,
                              const Context& context, const std::vector<Vec3>& seeds);

}  // namespace umtet
