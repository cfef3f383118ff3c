#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/background_mesh.h"
#include "mesh/implicit_function.h"
#include "mesh/keep_going.h"
#include "mesh/tet_mesh.h"

namespace umtet {

/// T^{omega_h}: the tets of the background mesh with at least one vertex in Omega       [Rangarajan2018, Section 2.2.1]
///
/// Vertices and tets are numbered anew, in ascending order of their background ids, so that two searches that find
/// the same set return equal bytes.
struct Submesh {
  TetMesh mesh;                                 ///< coordinates are those of the background mesh
  std::vector<std::int64_t> background_vertex;  ///< id in the universal mesh of each vertex, ascending
  std::vector<std::int64_t> background_tet;     ///< id in the universal mesh of each tet, ascending
  std::vector<Triangle> positive_faces;         ///< Gamma_h^+, local vertex ids, outward; one per positively cut tet
  std::vector<int> positive_tets;               ///< the positively cut tet behind each positive face, ascending
  std::vector<int> positive_vertices;           ///< I^+, local ids, ascending
};

/// A tet is positively cut if exactly one of its four vertices is inside; `inside` bit k belongs to local vertex k.
inline bool is_positively_cut(unsigned inside) { return inside == 1 || inside == 2 || inside == 4 || inside == 8; }

/// Algorithm 1, steps 1-22: evaluates psi at every vertex of the background mesh.
/// Cost: one value of psi per background vertex. A vertex with psi = 0 counts as outside.
/// @param n_psi_evaluations  if not null, receives that number
/// \throw std::length_error if omega_h has more than 2^31 - 1 tets or vertices; MeshCancelled
Submesh find_submesh(const BackgroundMesh& background, ImplicitFunctionRef psi,
                     std::size_t* n_psi_evaluations = nullptr, const KeepGoing& keep_going = {});

/// About how many tets omega_h will have at mean edge length h: the volume and the area of the boundary, read off a
/// coarse sampling of psi, in the count 46 (volume + .27 a area) / a^3 for an A15 of cell edge a, and as much more or
/// less as the tiling has tets a volume. 0 when no sample lies inside. Within 10 % when the features of the domain
/// exceed 1/64 of the longest side of its own box; that is looked for in `box` first, so the domain must exceed 1/64 of
/// the longest side of `box` there. Cost: at most 2 * 65^3 values of psi. \throw std::invalid_argument for h <= 0 or an
/// empty box
double expected_tets(const Tiling& tiling, ImplicitFunctionRef psi, const Box& box, double h);
double expected_tets(ImplicitFunctionRef psi, const Box& box, double h);  ///< for A15

/// A mean edge length h at which omega_h has about n_tets tets, by the same count.
/// \throw std::invalid_argument for n_tets <= 0, an empty box, or when no sample lies inside
double h_for_tets(const Tiling& tiling, ImplicitFunctionRef psi, const Box& box, double n_tets);
double h_for_tets(ImplicitFunctionRef psi, const Box& box, double n_tets);  ///< for A15

}  // namespace umtet
