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
#include "mesh/fast/backtracking_projection.h"
#include "mesh/fast/bad_tets.h"
#include "mesh/submesh/chosen_submesh.h"
#include "mesh/submesh/linked_active_layer.h"

namespace umtet {

/// docs/constants.md has what other values do.
struct RepairParams {
  double target = kQualityTarget;  ///< mean ratio: tets below it are mended, and misaligned faces; in (0, 1)
  int reach = 3;                   ///< edges from the flip and the tet within which a patch moves vertices; >= 1
  int max_tries = 24;              ///< vertices reclassified on trial for one tet; >= 0. 0: no repair
  /// Patches of one pass, of which there are up to five, for the worst tets first; fewer in small meshes, and what is
  /// begun is ended. Where more are needed h is too large, which no classification mends.
  std::size_t max_patches = 3000;
  /// What the first pass leaves, and what is above the target by less than lift, is raised by smooth_all_vertices().
  bool all_vertices = true;
  /// Outside of lattices targets rise by so much from the worst tet on; where all vertices of a patch move at once they
  /// rise by a quarter of it in all backgrounds. 0: there is one target; else in [.001, target]
  double target_step = .01;
  /// Tets that are above the target by less than this are raised up to it, in few patches. >= 0, 0: they stay as they
  /// are
  double lift = .01;
  bool slides = true;  ///< patches relax_tangentially() when all is mended: their smoothing has undone that
  /// Edges: a vertex higher than this is not flipped. More than ClassificationParams::reach_out, because here the mesh
  /// itself is looked at and not a cost of distance; >= 0
  double reach_out = .5;
  ProjectionParams projection;
  SmoothingParams smoothing = patch_smoothing();

  /// Smoothing of a patch, which settles in a dozen sweeps or not at all: gains are those that count near bad tets, and
  /// every move enqueues.
  static SmoothingParams patch_smoothing() {
    SmoothingParams params;
    params.margin = .04;
    params.fine_gain = params.least_gain;
    params.least_step = 0;
    params.max_sweeps = 15;
    return params;
  }
};

/// Every broken constraint, not just the first.
std::vector<std::string> problems(const RepairParams&);

struct RepairReport {
  std::size_t tries = 0;  ///< patches shaped on a copy
  std::size_t psi_evaluations = 0;
  std::vector<std::pair<std::int64_t, Vec3>> moved;  ///< background vertices with a new place, ascending
  std::vector<std::int64_t> flipped;                 ///< background vertices with another state, ascending
};

/// Mends tets below the target, and boundary faces misaligned away from psi = 0 (patch_state.h), by changing which
/// vertices next to them count as inside: connectivity is the limit where smoothing has settled.
///
/// For each such tet, the worst first and folded over faces before all, states of its vertices and their neighbours are
/// changed one by one, then in pairs, on a copy of the patch around them, whose boundary is projected and whose inside
/// is smoothed, the patch's outer vertices held. A patch with a misaligned face also starts from the lattice anew. A
/// patch far behind while it is smoothed is given up, and where a flip helps, those that cost much more are not tried.
/// The best is kept if neither the least quality of the patch falls nor its below target tets, its misaligned or its
/// folded over faces become more, and its least cosine does not fall unless fewer faces are misaligned then; and if one
/// of these gets better. A state changes only where classify_vertices() might change it: at simple vertices, without a
/// new spot where the boundary is no manifold, and not where the body or the gap is thin. So topology stays.
///
/// Where targets rise, the rule is that of the target at the time; but never are more tets of the whole mesh below
/// RepairParams::target than before. Outside of lattices the last one is .03 lower where there are more than ten
/// thousand bad_tets() up to target + lift at first.
///
/// What nothing helps, and tets above the target by less than lift, are then raised by smooth_all_vertices(), without a
/// flip and after that with any, against targets that rise from the worst tet on. Outside of lattices, where many tets
/// are below the target, it rises in the first pass, too, which tries the few most promising flips.
///
/// Tets far from each other are mended at once. The same bytes for any number of threads.
/// @param layer   smoothed; its coordinates stay as they are, `moved` says what has changed since
/// @param kept    vertices that are not where the background has them although they are not in the layer; ascending
/// @param inside  receives the changes
/// \throw std::invalid_argument naming every broken constraint, Cancelled
RepairReport repair(const BackgroundMesh& background, const VertexLinks& links, ImplicitFunctionRef psi,
                    const ClassificationParams& classification, const RepairParams& params,
                    const BackgroundLayer& layer, IdSet& inside, const Context& context = {},
                    const std::vector<KeptVertex>& kept = {});

/// A vertex before repair.
struct LayerVertex {
  std::int64_t vertex;
  bool is_inside;
  Vec3 place;
};

/// A layer in a lattice that other processes have, and this one repairs: some thousand places of it, however large it
/// is.
class RemoteLayer {
 public:
  /// bad_tets() of all of it, those up to target + lift, in the order of the whole layer.
  virtual const std::vector<BadTet>& bad() const = 0;
  /// Their corners.
  virtual const std::vector<LayerVertex>& corners() const = 0;
  virtual std::size_t n_tets() const = 0;
  /// What is within `reach` + 3 edges of a vertex, and perhaps more: vertices that are inside, or not where the
  /// background has them. Each is given once; so is what repair has changed since never given again.
  virtual std::vector<LayerVertex> around(std::int64_t vertex) = 0;

 protected:
  ~RemoteLayer() = default;
};

/// The same for a layer elsewhere: what is done for a tet depends on what is within reach + 3 edges of its first
/// vertex, and that is asked for before. @param inside  empty; receives what has been asked for, with the changes
RepairReport repair(const BackgroundMesh& background, const VertexLinks& links, ImplicitFunctionRef psi,
                    const ClassificationParams& classification, const RepairParams& params, RemoteLayer& layer,
                    IdSet& inside, const Context& context = {});

}  // namespace umtet
