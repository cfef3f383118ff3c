#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "common/context.h"
#include "mesh/classification/classification.h"
#include "mesh/core/quality_target.h"
#include "mesh/fast/backtracking_projection.h"
#include "mesh/submesh/lattice_active_layer.h"

namespace umtet {

struct RepairParams {
  double target = kQualityTarget;  ///< tets below are mended, and misaligned faces; in (0, 1)
  int reach = 3;       ///< a patch moves the vertices within this many edges of the flip and the tet; >= 1. With 2
                       ///< some tets of two scans stay below .8
  int max_tries = 24;  ///< vertices reclassified on trial for one tet; >= 0. 0: no repair
  /// Patches for the worst tets first, a millisecond each (fewer of small meshes; what is begun is ended): more means
  /// that h is wrong, which no classification mends. With 600 a scan keeps 93 tets below .81 at 1.4 M tets, with 3000
  /// none.
  std::size_t max_patches = 3000;
  /// What nothing mends is tried again with SmoothingParams::sharper: of four meshes of a scan (h in steps of .1
  /// %) 7 places stay below .82 in place of 22, all of them thinner than 2 h.
  bool sharper = true;
  /// What nothing mends then is tried once more against a target so much lower; >= 0, 0: it is not. Where a body is
  /// thinner than h, a tet above .82 may cost a fold next to it: of nine meshes of two scans (h in steps
  /// of .04 to .5 %) two had a folded over face with 0, and none has with .01.
  double target_step = .01;
  bool slides = true;     ///< patches relax_tangentially() when all is mended: their smoothing has undone that
  double reach_out = .5;  ///< as ClassificationParams::reach_out: no cost for distance is needed here, where the
                          ///< mesh itself is measured; >= 0
  ProjectionParams projection;
  SmoothingParams smoothing = patch_smoothing();

  /// A patch settles in a dozen sweeps or not at all, and checks at all that moves: with least_step and fine_gain as
  /// elsewhere one mesh in twenty of a scan keeps a tet below the target that it does not keep so.
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
  std::size_t bad_before = 0;  ///< tets below the target or with a misaligned face
  std::size_t tries = 0;       ///< patches shaped on a copy
  std::size_t flips = 0;       ///< states changed
  std::size_t given_up = 0;    ///< tets for which nothing helped
  std::size_t psi_evaluations = 0;
  std::vector<std::pair<std::int64_t, Vec3>> moved;  ///< background vertices with a new place, ascending
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
/// What nothing helps is tried with a sharper norm, at first with the states it has; then against a target lower by
/// target_step.
///
/// Tets far from each other are mended at once, two at most, with the bytes of one after the other.
/// @param layer   smoothed; its coordinates stay as they are, `moved` says what has changed since
/// @param inside  receives the changes
/// \throw std::invalid_argument naming every broken constraint, Cancelled
RepairReport repair(const BackgroundMesh& background, const std::vector<LinkTopology>& links, ImplicitFunctionRef psi,
                    const ClassificationParams& classification, const RepairParams& params,
                    const LatticeActiveLayer& layer, IdSet& inside, const Context& context = {});

}  // namespace umtet
