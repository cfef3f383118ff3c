#pragma once

#include <cstdint>
#include <vector>

#include "common/context.h"
#include "mesh/background/background_mesh.h"
#include "mesh/base/id_set.h"
#include "mesh/core/far_from_zero.h"
#include "mesh/core/implicit_function.h"
#include "mesh/submesh/submesh.h"

namespace umtet {

/// The tets with an inside vertex, ascending.                                 Alg. 1, steps 14-16
std::vector<std::int64_t> cut_or_inside_tets(const BackgroundMesh& background, const IdSet& inside);

/// Assembles omega_h from its tets and inside vertices: Algorithm 1, steps 14-22. Works tet by tet, with threads;
/// emit_submesh() makes the same result from the same set.
/// @param tets  background ids, ascending
Submesh assemble_submesh(const BackgroundMesh& background, std::vector<std::int64_t> tets, const IdSet& inside);

/// Assembles omega_h without tets and faces. @param n_tets  receives the number of tets
Submesh assemble_vertices(const BackgroundMesh& background, const IdSet& inside, std::size_t& n_tets);

/// The background vertices with psi < 0.                                   Alg. 1, step 7
/// @param n_evaluations  receives the number of values of psi
/// @param known          saves evaluations at vertices within its reach of the former mesh
/// \throw Cancelled
IdSet inside_vertices(const BackgroundMesh& background, ImplicitFunctionRef psi, std::size_t& n_evaluations,
                      const Context& context = {}, const KnownSigns& known = {});

/// Result of crawl_inside().
struct CrawledVertices {
  IdSet inside;
  std::vector<std::size_t> lost_seeds;
  std::size_t n_psi_evaluations = 0;
};
/// The inside vertices that crawl() finds from these seeds. \throw Cancelled
CrawledVertices crawl_inside(const BackgroundMesh& background, ImplicitFunctionRef psi, const std::vector<Vec3>& seeds,
                             const Context& context = {});

}  // namespace umtet
