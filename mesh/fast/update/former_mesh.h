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
#include "mesh/fast/projection/backtracking_projection.h"
#include "mesh/submesh/chosen_submesh.h"
#include "mesh/submesh/linked_active_layer.h"
#include "mesh/submesh/um_result.h"

namespace umtet {

/// A mesh of the same psi in another background.
struct FormerMesh {
  const BackgroundMesh& background;
  const UmResult& mesh;  ///< UmStatus::Success
  /// Seeds of universal_mesh() if some components of psi are not meshed; otherwise empty.
  std::vector<Vec3> seeds = {};
};

/// The states of a former mesh that carry over to a background that differs only locally, such as an octree with
/// smaller leaves there. Away from the differences the tets at a vertex are the same, by keys
/// (BackgroundMesh::key_of_vertex()) and by positions.
struct FormerStates {
  /// Vertices that count as inside. Where the background is the same around a vertex, the former state holds. Elsewhere
  /// they are the vertices with psi < 0, restricted to the components with a seed if there are seeds.
  IdSet inside{0};
  IdSet same{0};  ///< vertices around which the background is the same
  /// The other vertices that have a neighbour on the other side: classify_vertices() works on them.
  PsiValues cut;
  std::size_t psi_evaluations = 0;
};
/// Carries the states of a former mesh over to a background. Cost: about 200 ns per vertex of the background, by all
/// threads. \throw Cancelled
FormerStates former_states(const BackgroundMesh& background, const VertexLinks& links, ImplicitFunctionRef psi,
                           const FormerMesh& former, const Context& context = {});

/// The vertices of omega_h that keep their positions in the former mesh, ascending: the background around them is the
/// same, and so are their inside neighbours.
/// @param inside  inside vertices of the new mesh
std::vector<KeptVertex> kept_vertices(const BackgroundMesh& background, const VertexLinks& links,
                                      const FormerMesh& former, const FormerStates& states, const IdSet& inside);

/// The vertices of omega_h that may move: they are within a few edges of a vertex that is not kept.
IdSet loose_vertices(const BackgroundMesh& background, const VertexLinks& links, const IdSet& inside,
                     const std::vector<KeptVertex>& kept);

/// Puts the kept vertices of a layer at their positions in the former mesh. Where a tet with a vertex that is not kept
/// then falls below least_quality, vertices that may move go back to the background.
void begin_where_kept(const std::vector<KeptVertex>& kept, const ProjectionParams& projection, BackgroundLayer& layer);

}  // namespace umtet
