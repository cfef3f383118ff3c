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

struct ManifoldReport {
  std::vector<ManifoldFlip> flips;  ///< what is otherwise than it was, ascending
  std::size_t n_bad = 0;            ///< outside vertices where the boundary was no manifold
  std::size_t n_one_way = 0;        ///< of all changes those that were made one way only
  std::size_t psi_evaluations = 0;
};

/// The outside vertices where the boundary of omega_h is no manifold, ascending. Cost: linear in the background.
/// @param links  of the background, or null
std::vector<std::int64_t> vertices_not_manifold(const BackgroundMesh& background, const VertexLinks* links,
                                                const IdSet& inside);

/// Makes the boundary of omega_h a closed 2-manifold, and so omega_h a 3-manifold with boundary, by changing which
/// vertices count as inside; it always ends.
///
/// The boundary of omega_h depends on `inside` alone, and is a manifold if and only if the tets of omega_h are a
/// half-ball at every outside vertex that has any (half_ball.h). At a vertex where they are not, the flip of it or of
/// one of its inside neighbours is made that lowers the energy of classify_vertices() most, or raises it least, where a
/// vertex that is no manifold costs as much as there. Each vertex is flipped this way once at most. Where that leaves a
/// bad vertex without a flip, changes are made one way only: the vertex is filled, once; and if it cannot be, all its
/// inside neighbours are removed for good, which leaves it without a tet. No vertex is filled or removed twice, so this
/// ends, and it ends only where no vertex is bad.
///
/// One bad vertex after the other, the least id first: the same for any number of threads. What is done for one depends
/// on what is within kManifoldReach edges.
/// @param links        of the background, or null: then links are read off the stars
/// @param has_walls    vertices on the background boundary may be inside; else none is, nor becomes it
/// @param bad          vertices_not_manifold()
/// @param inside       receives the changes; may become empty
/// @param read         where others have the classification, or nothing: called before a bad vertex is looked at; puts
///                     what is within kManifoldReach edges into `inside`, if it has not before
/// \throw Cancelled
ManifoldReport make_manifold(const BackgroundMesh& background, const VertexLinks* links, ImplicitFunctionRef psi,
                             const ClassificationParams& params, bool has_walls, const std::vector<std::int64_t>& bad,
                             IdSet& inside, const Context& context = {},
                             const std::function<void(std::int64_t vertex)>& read = {});

/// Costs of a flip next to a bad vertex are those of its neighbours, which depend on theirs; and one to spare.
inline constexpr int kManifoldReach = 4;

}  // namespace umtet
