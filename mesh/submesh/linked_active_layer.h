#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/background/background_mesh.h"
#include "mesh/background/vertex_links.h"
#include "mesh/base/id_set.h"
#include "mesh/submesh/active_layer.h"
#include "mesh/submesh/submesh.h"

namespace umtet {

/// A layer and where its vertices are in the background mesh.
struct BackgroundLayer {
  ActiveLayer layer;
  std::vector<std::int64_t> background_vertex;  ///< ascending
};

/// Cuts the layer of the tets with an inside vertex out of the background mesh: positive vertices, `layers` layers of
/// other vertices behind them, and the rings of all these.
///
/// Every vertex that moves has its whole ring in the layer. Colours are those of a colouring of the
/// vertex types, or, outside of lattices, greedy ones.
/// Cost: linear in the layer, plus a scan of the bits of the background's vertices.
/// @param inside  none of its vertices on the background boundary
/// @param among   only these may move; null: all
/// \throw std::invalid_argument if a vertex type of the tiling is its own neighbour (types then do not colour it)
BackgroundLayer linked_active_layer(const BackgroundMesh& background, const VertexLinks& links, const IdSet& inside,
                                    int layers = 2, const IdSet* among = nullptr);

/// The first of its two steps: the vertices that move.
IdSet movable_vertices(const BackgroundMesh& background, const VertexLinks& links, const IdSet& inside, int layers = 2);

/// The second, for a process that moves some of them: the tets with one of those, in the order that they have in the
/// whole layer. The others are Fixed.
/// @param movable  all that move, at least those in a tet with an own one
/// @param own      those that move here
BackgroundLayer layer_part(const BackgroundMesh& background, const VertexLinks& links, const IdSet& inside,
                           const IdSet& movable, const IdSet& own);

/// The same for the vertices of omega_h within `reach` edges of one of `centres`, whatever their distance from the
/// boundary: these move. Every tet of omega_h with a vertex that near to a centre is in the patch.
/// \pre the centres have ids
BackgroundLayer active_patch(const BackgroundMesh& background, const VertexLinks& links, const IdSet& inside,
                             const std::vector<std::int64_t>& centres, int reach);

/// Per vertex of the layer: whether it is in the set.
std::vector<std::uint8_t> inside_of(const BackgroundLayer& layer, const IdSet& inside);

/// omega_h of these inside vertices: equal to assemble_submesh() bit for bit, cell by cell with threads, and
/// that function itself without cells or where the tets of one have more than 64 corners (slab and cube).
/// Cost: some ns per tet, and a few per cell of the background mesh.
Submesh emit_submesh(const BackgroundMesh& background, const IdSet& inside);

struct SubmeshOutline {
  Submesh submesh;  ///< with the vertices; tets and faces may be missing
  std::size_t n_tets = 0;
};
/// The vertices of omega_h and how many tets it has, at a quarter of the cost.
SubmeshOutline outline_submesh(const BackgroundMesh& background, const IdSet& inside);

}  // namespace umtet
