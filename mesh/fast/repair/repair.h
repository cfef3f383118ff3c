#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "common/context.h"
#include "mesh/classification/classification.h"
#include "mesh/core/quality_target.h"
#include "mesh/fast/defects/bad_tets.h"
#include "mesh/fast/projection/backtracking_projection.h"
#include "mesh/submesh/chosen_submesh.h"
#include "mesh/submesh/linked_active_layer.h"

namespace umtet {

/// Parameters of repair(). docs/constants.md lists the effect of other values.
struct RepairParams {
  double target = kQualityTarget;  ///< mean ratio: tets below it, and misaligned faces, are repaired; in (0, 1)
  int reach = 3;                   ///< a patch moves vertices within this many edges of the flip and the tet; >= 1
  int max_tries = 24;              ///< vertices reclassified on trial for one tet; >= 0. 0: no repair
  /// Patches tried in one pass, for the worst tets first; there are up to five passes. The number is lower in small
  /// meshes, and a patch that was begun is completed. If more are needed, h is too large, and no classification repairs
  /// that.
  std::size_t max_patches = 3000;
  /// smooth_all_vertices() raises the tets that the first pass leaves below the target, and those above the target by
  /// less than `lift`.
  bool all_vertices = true;
  /// Outside of lattices, targets rise by this step, beginning at the worst tet. Where all vertices of a patch move at
  /// once, they rise by a quarter of it in all backgrounds. 0: there is one target; else in [.001, target]
  double target_step = .01;
  /// Tets above the target by less than this are raised to target + lift, in few patches. >= 0; 0: they stay unchanged
  double lift = .01;
  bool slides = true;  ///< patches are given to relax_tangentially() at the end, because smoothing undoes it
  /// In edges: a vertex higher than this is not flipped. The value exceeds ClassificationParams::reach_out, because
  /// repair examines the mesh itself and not a cost of distance; >= 0
  double reach_out = .5;
  ProjectionParams projection;
  SmoothingParams smoothing = patch_smoothing();

  /// Smoothing of a patch, which settles in a dozen sweeps or not at all. A gain counts if it would count near bad
  /// tets, and every move enqueues neighbours.
  static SmoothingParams patch_smoothing() {
    SmoothingParams params;
    params.margin = .04;
    params.fine_gain = params.least_gain;
    params.least_step = 0;
    params.max_sweeps = 15;
    return params;
  }
};

/// All broken constraints, not just the first.
std::vector<std::string> problems(const RepairParams&);

/// Changes made by repair(), and its work.
struct RepairReport {
  std::size_t tries = 0;  ///< patches shaped on a copy
  std::size_t psi_evaluations = 0;
  std::vector<std::pair<std::int64_t, Vec3>> moved;  ///< background vertices with a new position, ascending
  std::vector<std::int64_t> flipped;                 ///< background vertices with a changed state, ascending
};

/// Local reclassification of background vertices that repairs tets below the target and misaligned boundary faces
/// (patch_state.h). Where smoothing has settled, connectivity is the limit.
///
/// For each such tet, the worst first and folded over faces before all others, states of its vertices and of their
/// neighbours are changed, first one at a time, then in pairs. Each change is made on a copy of the patch around them:
/// the patch's boundary is projected and its inside is smoothed, while its outer vertices are held. A patch with a
/// misaligned face also starts from the lattice positions. A patch that falls far behind during smoothing is given up.
/// Once a flip helps, flips that cost much more are not tried.
///
/// The best change is kept if one of these measures improves and all of these conditions hold:
/// - the least quality of the patch does not fall;
/// - the number of tets below target does not rise;
/// - the number of misaligned faces does not rise;
/// - the number of folded over faces does not rise;
/// - the least cosine does not fall, unless fewer faces are then misaligned.
///
/// A state changes only where classify_vertices() might change it: at simple vertices, without a new non-manifold
/// vertex of the boundary, and not where the body or the gap is thin. The topology is therefore preserved.
///
/// Where targets rise, the rule applies to the target of the moment; but the whole mesh never has more tets below
/// RepairParams::target than before. Outside of lattices the last target is .03 lower if there are initially more than
/// ten thousand bad_tets() below target + lift.
///
/// Tets that no flip improves, and tets above the target by less than `lift`, are then raised by smooth_all_vertices(),
/// first without flips and then with any flip, against targets that rise from the worst tet on. Outside of lattices,
/// where many tets are below the target, the target also rises in the first pass, which tries the few most promising
/// flips.
///
/// Tets far from each other are repaired at once. The bytes are the same for any number of threads.
/// @param layer   smoothed; its coordinates are not changed, `moved` lists the changes
/// @param kept    vertices that are off their background positions although they are not in the layer; ascending
/// @param inside  receives the changes
/// \throw std::invalid_argument naming every broken constraint, Cancelled
RepairReport repair(const BackgroundMesh& background, const VertexLinks& links, ImplicitFunctionRef psi,
                    const ClassificationParams& classification, const RepairParams& params,
                    const BackgroundLayer& layer, IdSet& inside, const Context& context = {},
                    const std::vector<KeptVertex>& kept = {});

/// State and position of a vertex before repair.
struct LayerVertex {
  std::int64_t vertex;
  bool is_inside;
  Vec3 place;
};

/// A layer in a lattice that is stored by other processes and repaired by this one. This process reads a few thousand
/// positions of it, for any size of the layer.
class RemoteLayer {
 public:
  /// bad_tets() of the whole layer with the bound target + lift, in the order of the whole layer.
  virtual const std::vector<BadTet>& bad() const = 0;
  /// The corners of the bad tets.
  virtual const std::vector<LayerVertex>& corners() const = 0;
  virtual std::size_t n_tets() const = 0;
  /// The vertices within `reach` + 3 edges of a vertex, and perhaps more, that are inside or off their background
  /// positions. Each vertex is returned once; vertices that repair has changed since are not returned again.
  virtual std::vector<LayerVertex> around(std::int64_t vertex) = 0;

 protected:
  ~RemoteLayer() = default;
};

/// Repairs a layer that other processes store. The repair of a tet depends only on vertices within reach + 3 edges of
/// its first vertex, which are requested before.
/// @param inside  empty; receives the vertices that were requested, with the changes
RepairReport repair(const BackgroundMesh& background, const VertexLinks& links, ImplicitFunctionRef psi,
                    const ClassificationParams& classification, const RepairParams& params, RemoteLayer& layer,
                    IdSet& inside, const Context& context = {});

}  // namespace umtet
