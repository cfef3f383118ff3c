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

/// A vertex that is where a mesh in another background had it.
struct KeptVertex {
  std::int64_t vertex;    ///< of the background
  Vec3 projected, final;  ///< as UmResult has them
};

/// Which tets of the background mesh become the mesh, before any vertex has moved.
struct ChosenSubmesh {
  UmStatus status = UmStatus::Success;
  UmEvidence evidence;          ///< filled when status != Success
  IdSet inside{0};              ///< background vertices that count as inside; where it is empty, `submesh` is whole
  Submesh submesh;              ///< omega_h: whole, or its vertices only
  bool is_whole = false;        ///< `submesh` has its tets and faces
  std::vector<Triangle> walls;  ///< BackgroundBoundary::Wall: as UmResult::walls
  std::vector<ManifoldFlip> manifold_flips;
  std::shared_ptr<const VertexLinks> links;  ///< of the background, where choosing took them; or null
  std::size_t n_tets = 0;                    ///< of omega_h, and of every mesh made from it; 0 when status != Success
  std::size_t n_psi_evaluations = 0;
  std::vector<KeptVertex> kept;  ///< ascending; empty: all begin at their places in the background
};

/// What a result of these choices begins with; moves from `chosen`.
UmResult result_of(ChosenSubmesh&& chosen);

/// "; n of m seeds led to no positively cut tet": of SubmeshSearch::Crawl, for the evidence.
std::string text_of_lost_seeds(std::size_t n_lost, std::size_t n_seeds);

/// Algorithm 1, steps 1-22: the vertices with psi < 0 are inside; and whether the domain stays off the background
/// boundary (Section 2.1), or far enough from a wall.
/// @param seeds  for SubmeshSearch::Crawl: at least one point near every component of the boundary
/// \throw std::length_error if omega_h has more than 2^31 - 1 tets or vertices; Cancelled
ChosenSubmesh submesh_by_sign(const BackgroundMesh& background, ImplicitFunctionRef psi, const SubmeshParams& params,
                              const Context& context, const std::vector<Vec3>& seeds);

}  // namespace umtet
