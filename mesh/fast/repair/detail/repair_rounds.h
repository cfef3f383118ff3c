#pragma once

#include <cstddef>
#include <cstdint>
#include <set>
#include <vector>

#include "common/context.h"
#include "mesh/fast/repair/detail/flip_trials.h"
#include "mesh/fast/repair/detail/patch_ranges.h"
#include "mesh/fast/repair/detail/trial_pool.h"
#include "mesh/fast/repair/repair.h"

namespace umtet::detail {

/// Limits on the number of patches that may be tried from now on.
struct PatchBudget {
  std::size_t most;
  std::size_t few, per_success;  ///< `few` patches, and `per_success` more for each that helped
};

/// The tets that repair() works on, and the repaired mesh. Tets are repaired in rounds: each round repairs tets far
/// from each other, by all threads. The bytes are the same for any number of threads.
class RepairRounds {
 public:
  /// The list of tets is empty at first. Keeps references to its arguments.
  /// @param remote      replaces the layer, which is then empty; or null
  /// @param more_reach  the greatest FlipEffort::more_reach to come
  RepairRounds(const BackgroundMesh& background, const VertexLinks& links, ImplicitFunctionRef psi,
               const ClassificationParams& classification, const RepairParams& params, const BackgroundLayer& layer,
               RemoteLayer* remote, IdSet& inside, const std::vector<KeptVertex>& kept, int more_reach);

  /// Enqueues all bad tets of the layer.
  void look_at_all();
  void allow(const PatchBudget& budget);
  bool may_try() const { return tries_ < most_patches(); }
  void aim_at(double target, const FlipEffort& effort);
  std::size_t n_waiting() const { return later_.size(); }
  /// True if a waiting tet is below the target; tets with a misaligned face do not count.
  bool is_some_tet_below() const;
  /// Enqueues tets that were given up again. All waiting tets are then judged by their present state, and only those
  /// still bad remain.
  void judge_again();
  /// Repairs waiting tets that are below the target or have a misaligned face, the worst first, and tets near them that
  /// become bad. Tets that no trial improves are given up. \throw Cancelled
  void mend(const Context& context);
  /// Applies relax_tangentially() to the patches that were kept, in their order, except for patches near an earlier
  /// one.
  /// \throw Cancelled
  void slide(const Context& context);
  /// Report of all work so far.
  RepairReport report();

 private:
  BadTet judged(const TetIds& tet);
  bool is_worth_trying(const TetIds& tet);
  void find_ranges();
  bool choose_round();
  void know(const std::vector<LayerVertex>& vertices);
  void keep(const TetIds& tet, const FlipTrials::Best& best);
  void move(const BackgroundLayer& patch);
  void look(const std::vector<BadTet>& bad);
  std::size_t most_patches() const;

  ImplicitFunctionRef psi_;
  const RepairParams& params_;
  const BackgroundLayer& layer_;
  RemoteLayer* remote_;
  IdSet& inside_;
  PatchBudget budget_{};
  std::size_t tries_before_ = 0, kept_before_ = 0;  ///< counts at the time the budget was given
  double target_;
  std::size_t most_for_a_tet_;  ///< number of patches
  Positions positions_;
  TrialPool trials_;
  PatchRanges ranges_;         ///< ranges of first vertices
  std::vector<BadTet> later_;  ///< tets that wait for the next call of mend(), or for another target
  std::vector<BadTet> todo_;   ///< tets to repair, from next_ on
  std::size_t next_ = 0;
  std::vector<TetIds> waiting_;  ///< tets before todo_ that were near a tet of the last round
  std::vector<TetIds> round_;    ///< tets far from each other: repairing one does not affect the others
  std::vector<TetIds> given_up_;
  std::set<std::int64_t> hopeless_;              ///< vertices of tets that no trial improved
  std::vector<std::vector<std::int64_t>> kept_;  ///< centres of the patches
  IdList moved_;                                 ///< vertices that patches have moved
  std::set<std::int64_t> flipped_;               ///< vertices with another state
  std::ptrdiff_t more_below_target_ = 0;  ///< increase of the number of tets below RepairParams::target since the
                                          ///< start: never above 0
  std::size_t tries_ = 0, psi_evaluations_ = 0;  ///< the evaluations of trials_ are added to the latter
};

}  // namespace umtet::detail
