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

/// A layer with the background ids of its vertices.
struct BackgroundLayer {
  ActiveLayer layer;
  std::vector<std::int64_t> background_vertex;  ///< ascending
};

/// Extracts the active layer from the background mesh, restricted to the tets with an inside vertex: positive vertices,
/// `layers` layers of other vertices behind them, and the rings of all these vertices.
///
/// The layer contains the whole ring of every vertex that moves. In a lattice the colour of a vertex follows from its
/// type; otherwise the colouring is greedy. Cost: linear in the layer, plus a scan of the bits of the background's
/// vertices.
/// @param inside  contains no vertex of the background boundary
/// @param among   only these vertices may move; null: all
/// \throw std::invalid_argument if a vertex type of the tiling is its own neighbour (types are then not a colouring)
BackgroundLayer linked_active_layer(const BackgroundMesh& background, const VertexLinks& links, const IdSet& inside,
                                    int layers = 2, const IdSet* among = nullptr);

/// First step of linked_active_layer(): the vertices that move.
IdSet movable_vertices(const BackgroundMesh& background, const VertexLinks& links, const IdSet& inside, int layers = 2);

/// Second step of linked_active_layer(), for a process that moves some of the vertices: the tets with an own vertex, in
/// their order in the whole layer. The other vertices are Fixed.
/// @param movable  all vertices that move, or at least those in a tet with an own vertex
/// @param own      the vertices that move here
BackgroundLayer layer_part(const BackgroundMesh& background, const VertexLinks& links, const IdSet& inside,
                           const IdSet& movable, const IdSet& own);

/// The patch around some vertices: the vertices of omega_h within `reach` edges of one of `centres` move, at any
/// distance from the boundary. The patch contains every tet of omega_h with such a vertex.
/// \pre the centres are valid ids
BackgroundLayer active_patch(const BackgroundMesh& background, const VertexLinks& links, const IdSet& inside,
                             const std::vector<std::int64_t>& centres, int reach);

/// Per vertex of the layer, whether it is in the set.
std::vector<std::uint8_t> inside_of(const BackgroundLayer& layer, const IdSet& inside);

/// omega_h of these inside vertices, equal to assemble_submesh() bit for bit. It works cell by cell with threads.
/// Without cells, or where the tets of a cell have more than 64 corners (slab and cube), it calls assemble_submesh().
/// Cost: some ns per tet, and a few per cell of the background mesh.
Submesh emit_submesh(const BackgroundMesh& background, const IdSet& inside);

/// The vertices of omega_h and the number of its tets.
struct SubmeshOutline {
  Submesh submesh;  ///< contains the vertices; tets and faces may be missing
  std::size_t n_tets = 0;
};
/// The vertices of omega_h and the number of its tets, at a quarter of the cost of emit_submesh().
SubmeshOutline outline_submesh(const BackgroundMesh& background, const IdSet& inside);

}  // namespace umtet
