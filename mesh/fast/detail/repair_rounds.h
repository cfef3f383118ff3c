#pragma once

#include <cstddef>
#include <cstdint>
#include <set>
#include <vector>

#include "common/context.h"
#include "mesh/fast/detail/flip_trials.h"
#include "mesh/fast/detail/patch_ranges.h"
#include "mesh/fast/detail/trial_pool.h"
#include "mesh/fast/repair.h"

namespace umtet::detail {

/// How many patches may be tried from now on.
struct PatchBudget {
  std::size_t most;
  std::size_t few, per_success;  ///< in `few` of them, and `per_success` more for each that helped
};

/// The tets that repair() works on, and the mesh that it makes of them. They are mended round by round: in each round
/// those far from each other, by all threads. The same bytes for any number of threads.
class RepairRounds {
 public:
  /// Lists nothing yet. Keeps what it is given by reference.
  /// @param remote      in place of the layer, which is empty then; or null
  /// @param more_reach  the greatest FlipEffort::more_reach that is coming
  RepairRounds(const BackgroundMesh& background, const VertexLinks& links, ImplicitFunctionRef psi,
               const ClassificationParams& classification, const RepairParams& params, const BackgroundLayer& layer,
               RemoteLayer* remote, IdSet& inside, const std::vector<KeptVertex>& kept, int more_reach);

  /// All bad tets of the layer wait.
  void look_at_all();
  void allow(const PatchBudget& budget);
  bool may_try() const { return tries_ < most_patches(); }
  void aim_at(double target, const FlipEffort& effort);
  std::size_t n_waiting() const { return later_.size(); }
  /// Whether a tet that waits is below the target; not counting those with a misaligned face.
  bool is_some_tet_below() const;
  /// Tets that were given up wait again. Of all that wait those go on that are still bad, with what they are like now.
  void judge_again();
  /// Mends tets that wait and are below the target or have a misaligned face, the worst first, and what becomes bad
  /// near them. What nothing helps is given up. \throw Cancelled
  void mend(const Context& context);
  /// relax_tangentially() in the patches that were kept, in their order but for those near one that comes before them.
  /// \throw Cancelled
  void slide(const Context& context);
  /// What has been done so far.
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
  std::size_t tries_before_ = 0, kept_before_ = 0;  ///< when the budget was given
  double target_;
  std::size_t most_for_a_tet_;  ///< patches
  Positions positions_;
  TrialPool trials_;
  PatchRanges ranges_;         ///< of first vertices
  std::vector<BadTet> later_;  ///< they wait: for the next call of mend(), or for another target
  std::vector<BadTet> todo_;   ///< from next_ on
  std::size_t next_ = 0;
  std::vector<TetIds> waiting_;  ///< before todo_: they were near one of the last round
  std::vector<TetIds> round_;    ///< far from each other: what is done for one does not touch the others
  std::vector<TetIds> given_up_;
  std::set<std::int64_t> hopeless_;              ///< vertices of tets that nothing helped
  std::vector<std::vector<std::int64_t>> kept_;  ///< centres of the patches
  IdList moved_;                                 ///< vertices that patches have moved
  std::set<std::int64_t> flipped_;               ///< vertices with another state
  std::ptrdiff_t more_below_target_ = 0;         ///< tets below RepairParams::target, than at first: never above 0
  std::size_t tries_ = 0, psi_evaluations_ = 0;  ///< of the last, those of trials_ come to it
};

}  // namespace umtet::detail
