#pragma once

#include <cstdint>
#include <vector>

#include "mesh/background_mesh.h"
#include "mesh/detail/id_set.h"
#include "mesh/implicit_function.h"
#include "mesh/submesh.h"

namespace umtet::detail {

/// Algorithm 1, steps 14-22, once it is known which tets are in omega_h and which of their vertices are inside.
/// Both searches end here, so that equal sets give equal bytes.
/// @param tets  background ids, ascending
Submesh assemble_submesh(const BackgroundMesh& background, std::vector<std::int64_t> tets, const IdSet& inside);

/// The background vertices with psi < 0.                                   Alg. 1, step 7
/// @param n_evaluations  receives the number of values of psi
IdSet inside_vertices(const BackgroundMesh& background, ImplicitFunctionRef psi, std::size_t& n_evaluations);

struct CrawledVertices {
  IdSet inside;
  std::vector<std::size_t> lost_seeds;
  std::size_t n_psi_evaluations = 0;
};
/// The inside vertices that crawl() finds from these seeds.
CrawledVertices crawl_inside(const BackgroundMesh& background, ImplicitFunctionRef psi, const std::vector<Vec3>& seeds);

}  // namespace umtet::detail
