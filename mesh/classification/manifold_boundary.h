#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "common/context.h"
#include "mesh/background/background_mesh.h"
#include "mesh/background/vertex_links.h"
#include "mesh/base/id_set.h"
#include "mesh/classification/classification.h"
#include "mesh/core/implicit_function.h"
#include "mesh/submesh/um_result.h"

namespace umtet {

/// Report of make_manifold().
struct ManifoldReport {
  std::vector<ManifoldFlip> flips;  ///< all changed states, ascending
  std::size_t n_bad = 0;            ///< outside vertices where the boundary was not a manifold
  std::size_t n_one_way = 0;        ///< changes that were made one way only
  std::size_t psi_evaluations = 0;
};

/// The outside vertices where the boundary of omega_h is not a manifold, ascending. Cost: linear in the background.
/// @param links  links of the background, or null
std::vector<std::int64_t> vertices_not_manifold(const BackgroundMesh& background, const VertexLinks* links,
                                                const IdSet& inside);

/// Makes the boundary of omega_h a closed 2-manifold, and so omega_h a 3-manifold with boundary, by changing which
/// vertices count as inside. It always ends.
///
/// The boundary of omega_h depends on `inside` alone. It is a manifold if and only if, at every outside vertex with
/// tets of omega_h, these tets form a half-ball (half_ball.h). Call the other outside vertices bad.
/// 1. At a bad vertex, the vertex itself or one of its inside neighbours is flipped. The flip is the one that lowers
///    the energy of classify_vertices() most, or raises it least; a non-manifold vertex costs as much as there. Each
///    vertex is flipped this way at most once.
/// 2. If a bad vertex has no such flip left, changes are made one way only: the vertex is filled, once. If it cannot be
///    filled, all its inside neighbours are removed for good, which leaves it without a tet.
///
/// No vertex is filled or removed twice, so the loop ends; and it ends only when no vertex is bad.
///
/// Bad vertices are treated one after the other, the least id first; the result is the same for any number of threads.
/// The change at a bad vertex depends on the vertices within kManifoldReach edges.
/// @param links        links of the background, or null: then they are computed from the stars
/// @param has_walls    vertices on the background boundary may be inside; otherwise none is inside or becomes so
/// @param bad          result of vertices_not_manifold()
/// @param inside       receives the changes; may become empty
/// @param read         if other processes store the classification: called before a bad vertex is examined; inserts the
///                     inside vertices within kManifoldReach edges into `inside`, unless it has done so before
/// \throw Cancelled
ManifoldReport make_manifold(const BackgroundMesh& background, const VertexLinks* links, ImplicitFunctionRef psi,
                             const ClassificationParams& params, bool has_walls, const std::vector<std::int64_t>& bad,
                             IdSet& inside, const Context& context = {},
                             const std::function<void(std::int64_t vertex)>& read = {});

/// In edges. The costs of a flip next to a bad vertex are those of its neighbours, which depend on their neighbours;
/// one edge is spare.
inline constexpr int kManifoldReach = 4;

}  // namespace umtet
