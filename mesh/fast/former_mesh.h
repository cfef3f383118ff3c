#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "common/context.h"
#include "mesh/background/background_mesh.h"
#include "mesh/background/vertex_links.h"
#include "mesh/base/id_set.h"
#include "mesh/core/implicit_function.h"
#include "mesh/core/psi_values.h"
#include "mesh/fast/backtracking_projection.h"
#include "mesh/submesh/chosen_submesh.h"
#include "mesh/submesh/linked_active_layer.h"
#include "mesh/submesh/um_result.h"

namespace umtet {

/// A mesh of the same psi in another background.
struct FormerMesh {
  const BackgroundMesh& background;
  const UmResult& mesh;          ///< UmStatus::Success
  std::vector<Vec3> seeds = {};  ///< as those of universal_mesh() where it has not all pieces of psi; else none
};

/// What is left of it in a background that differs at some places only: an octree with smaller leaves there. Away from
/// them the tets at a vertex are the same, by keys (BackgroundMesh::key_of_vertex()) and places.
struct FormerStates {
  /// Vertices that count as inside: those that did where the background is the same around them, elsewhere those with
  /// psi < 0, of the pieces with a seed if there are any.
  IdSet inside{0};
  IdSet same{0};  ///< vertices around which the background is the same
  /// Those at which it is not, with a neighbour on the other side: where classify_vertices() has work.
  PsiValues cut;
  std::size_t psi_evaluations = 0;
};
/// Cost: some 200 ns a vertex of the background, by all threads. \throw Cancelled
FormerStates former_states(const BackgroundMesh& background, const VertexLinks& links, ImplicitFunctionRef psi,
                           const FormerMesh& former, const Context& context = {});

/// The vertices of omega_h that keep the places of the former mesh, ascending: with the same background around them and
/// the same neighbours inside.
/// @param before  FormerStates::inside
/// @param inside  of the mesh to come
std::vector<KeptVertex> kept_vertices(const BackgroundMesh& background, const VertexLinks& links,
                                      const FormerMesh& former, const FormerStates& states, const IdSet& inside);

/// Which vertices of omega_h may move: within a few edges of one that is not kept.
IdSet loose_vertices(const BackgroundMesh& background, const VertexLinks& links, const IdSet& inside,
                     const std::vector<KeptVertex>& kept);

/// Puts those vertices of a layer that are kept where the former mesh had them. Where that leaves a tet with a vertex
/// that is not kept below least_quality, vertices that may move go back to the background.
void begin_where_kept(const std::vector<KeptVertex>& kept, const ProjectionParams& projection, BackgroundLayer& layer);

}  // namespace umtet
