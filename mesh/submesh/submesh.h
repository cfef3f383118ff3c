#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/context.h"
#include "mesh/background/background_mesh.h"
#include "mesh/core/far_from_zero.h"
#include "mesh/core/implicit_function.h"
#include "mesh/core/tet_mesh.h"

namespace umtet {

/// T^{omega_h}: the tets of the background mesh with at least one vertex in Omega       [Rangarajan2018, Section 2.2.1]
///
/// Vertices and tets are renumbered in ascending order of their background ids, so that two searches that find the same
/// set return equal bytes.
struct Submesh {
  TetMesh mesh;                                 ///< with coordinates of the background mesh
  std::vector<std::int64_t> background_vertex;  ///< id in the universal mesh of each vertex, ascending
  std::vector<std::int64_t> background_tet;     ///< id in the universal mesh of each tet, ascending
  std::vector<Triangle> positive_faces;         ///< Gamma_h^+, local vertex ids, outward; one per positively cut tet
  std::vector<int> positive_tets;               ///< the positively cut tet behind each positive face, ascending
  std::vector<int> positive_vertices;           ///< I^+, local ids, ascending
};

/// A tet is positively cut if exactly one of its four vertices is inside; `inside` bit k belongs to local vertex k.
inline bool is_positively_cut(unsigned inside) { return inside == 1 || inside == 2 || inside == 4 || inside == 8; }

/// Finds omega_h by evaluating psi at every vertex of the background mesh: Algorithm 1, steps 1-22. A vertex with psi =
/// 0 counts as outside.
/// Cost: one value of psi per background vertex.
/// @param n_psi_evaluations  if not null, receives the number of evaluations
/// @param known              known signs, which save evaluations
/// \throw std::length_error if omega_h has more than 2^31 - 1 tets or vertices; Cancelled
Submesh find_submesh(const BackgroundMesh& background, ImplicitFunctionRef psi,
                     std::size_t* n_psi_evaluations = nullptr, const Context& context = {},
                     const KnownSigns& known = {});

}  // namespace umtet
