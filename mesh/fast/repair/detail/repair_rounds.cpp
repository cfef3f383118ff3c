#include "mesh/fast/repair/detail/repair_rounds.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <numeric>
#include <thread>
#include <utility>

#include "mesh/core/tet_quality.h"

namespace umtet::detail {
namespace {

// Tets that are mended at once, while at most kMostWaiting wait for one near them: two for each of sixteen cores. The
// same for any number of threads, as the result depends on it. Where few patches may still be tried they are fewer, so
// that not many more are.
constexpr std::size_t kAtOnce = 32, kMostWaiting = 256;

bool is_worse(const BadTet& a, const BadTet& b) { return a.badness < b.badness; }

/// f(k) for each k < n, by all threads. The context is polled before each that the calling thread does: a tet may take
/// a tenth of a second.
template <class F>
void at_once(std::size_t n, const Context& context, const F& f) {
  const std::thread::id caller = std::this_thread::get_id();
  tbb::parallel_for(
      std::size_t{0}, n,
      [&](std::size_t k) {
        if (std::this_thread::get_id() == caller) context.poll();
        f(k);
      },
      tbb::simple_partitioner());
}

}  // namespace

RepairRounds::RepairRounds(const BackgroundMesh& background, const VertexLinks& links, ImplicitFunctionRef psi,
                           const ClassificationParams& classification, const RepairParams& params,
                           const BackgroundLayer& layer, RemoteLayer* remote, IdSet& inside,
                           const std::vector<KeptVertex>& kept, int more_reach)
    : psi_(psi),
      params_(params),
      layer_(layer),
      remote_(remote),
      inside_(inside),
      target_(params.target),
      most_for_a_tet_(most_patches_of({}, params.max_tries)),
      positions_(background, layer, kept),
      trials_(background, links, psi, classification, params, positions_, inside),
      ranges_(background, links, params.reach + more_reach) {}

std::size_t RepairRounds::most_patches() const {
  const std::size_t worth_it = budget_.few + budget_.per_success * (kept_.size() - kept_before_);
  return tries_before_ + std::min(budget_.most, worth_it);
}

void RepairRounds::allow(const PatchBudget& budget) {
  budget_ = budget;
  tries_before_ = tries_;
  kept_before_ = kept_.size();
}

void RepairRounds::aim_at(double target, const FlipEffort& effort) {
  target_ = target;
  most_for_a_tet_ = most_patches_of(effort, params_.max_tries);
  trials_.retry_with(target, effort);
}

/// Misaligned ones before all others.
BadTet RepairRounds::judged(const TetIds& tet) {
  if (trials_.first().is_misaligned(tet)) return {-1, tet};
  return {mean_ratio(positions_.of(tet[0]), positions_.of(tet[1]), positions_.of(tet[2]), positions_.of(tet[3])), tet};
}

/// Puts the tets of a layer that are bad against a target to come with those that wait, or on the list, the worst
/// first.
void RepairRounds::look(const std::vector<BadTet>& bad) {
  const auto first = static_cast<std::ptrdiff_t>(todo_.size());
  for (const BadTet& b : bad) (b.badness < target_ ? todo_ : later_).push_back(b);
  std::stable_sort(todo_.begin() + first, todo_.end(), is_worse);
}

void RepairRounds::look_at_all() {
  if (remote_) {
    know(remote_->corners());
    later_ = remote_->bad();
  } else {
    later_ = bad_tets(layer_, inside_, psi_, params_.target + params_.lift, psi_evaluations_);
  }
}

bool RepairRounds::is_some_tet_below() const {
  const auto is_below = [&](const BadTet& b) { return b.badness < target_ && b.badness >= 0; };
  return std::any_of(later_.begin(), later_.end(), is_below);
}

void RepairRounds::judge_again() {
  for (const BadTet& bad : later_) given_up_.push_back(bad.tet);
  std::sort(given_up_.begin(), given_up_.end());
  given_up_.erase(std::unique(given_up_.begin(), given_up_.end()), given_up_.end());
  later_.clear();
  for (const TetIds& tet : given_up_) {
    if (trials_.first().is_bad(tet)) later_.push_back(judged(tet));
  }
  given_up_.clear();
  hopeless_.clear();
}

/// False for one that is all right, or given up.
bool RepairRounds::is_worth_trying(const TetIds& tet) {
  if (!trials_.first().is_bad(tet)) return false;
  // Where no flip helped, none would help the tets that share a vertex either: their candidates are the same.
  const bool hopeless = std::any_of(tet.begin(), tet.end(), [&](std::int64_t v) { return hopeless_.count(v) != 0; });
  if (!hopeless && tries_ < most_patches()) return true;
  given_up_.push_back(tet);
  return false;
}

/// Of the tets that the next round may look at. Outside of lattices that is worth several threads.
void RepairRounds::find_ranges() {
  std::vector<std::int64_t> vertices;
  for (const TetIds& tet : waiting_) vertices.push_back(tet[0]);
  for (std::size_t k = next_; k < std::min(todo_.size(), next_ + kAtOnce + kMostWaiting); ++k) {
    vertices.push_back(todo_[k].tet[0]);
  }
  ranges_.find(vertices);
}

/// The next tets in their order, but for those near one that comes before them: these wait.
bool RepairRounds::choose_round() {
  find_ranges();
  round_.clear();
  std::vector<TetIds> held;
  std::vector<PatchRanges::Range> before;
  const std::size_t left = most_patches() - std::min(tries_, most_patches());
  const std::size_t most = std::clamp<std::size_t>(left / most_for_a_tet_, 2, kAtOnce);
  std::size_t w = 0;
  while (round_.size() < most && held.size() < kMostWaiting && (w < waiting_.size() || next_ < todo_.size())) {
    const TetIds tet = w < waiting_.size() ? waiting_[w++] : todo_[next_++].tet;
    const PatchRanges::Range range = ranges_.of(tet[0]);
    if (range.meets_any(before)) {
      held.push_back(tet);
    } else if (is_worth_trying(tet)) {
      if (remote_) know(remote_->around(tet[0]));
      round_.push_back(tet);
    } else {
      continue;
    }
    before.push_back(range);
  }
  held.insert(held.end(), waiting_.begin() + static_cast<std::ptrdiff_t>(w), waiting_.end());
  waiting_ = std::move(held);
  return !round_.empty();
}

void RepairRounds::move(const BackgroundLayer& patch) {
  for (std::size_t v = 0; v < patch.layer.V.size(); ++v) {
    if (patch.layer.role[v] == ActiveLayer::Role::Fixed) continue;
    positions_.move(patch.background_vertex[v], patch.layer.V[v]);
    moved_.add(patch.background_vertex[v]);
  }
}

/// Vertices of a layer elsewhere, none of which has been changed here.
void RepairRounds::know(const std::vector<LayerVertex>& vertices) {
  for (const LayerVertex& v : vertices) {
    if (!positions_.has_moved(v.vertex)) positions_.move(v.vertex, v.place);
    if (!v.is_inside || inside_.test(v.vertex)) continue;
    inside_.insert(v.vertex);
    trials_.flip(v.vertex);
  }
}

void RepairRounds::keep(const TetIds& tet, const FlipTrials::Best& best) {
  for (const std::int64_t v : best.flips) {
    inside_.test(v) ? inside_.erase(v) : inside_.insert(v);
    trials_.flip(v);
    if (!flipped_.insert(v).second) flipped_.erase(v);
  }
  move(best.layer);
  more_below_target_ += best.more_below_target;
  kept_.emplace_back(tet.begin(), tet.end());
  kept_.back().insert(kept_.back().end(), best.flips.begin(), best.flips.end());
  // It may have tets that were not bad before; the budget ends this.
  look(bad_tets(best.layer, inside_, psi_, params_.target + params_.lift, psi_evaluations_));
}

void RepairRounds::mend(const Context& context) {
  std::stable_sort(later_.begin(), later_.end(), is_worse);
  const auto end =
      std::partition_point(later_.begin(), later_.end(), [&](const BadTet& b) { return b.badness < target_; });
  todo_.assign(later_.begin(), end);
  later_.erase(later_.begin(), end);
  next_ = 0;
  std::vector<FlipTrials::Best> best(kAtOnce);
  while (choose_round()) {
    const std::size_t most_tries = most_patches() - tries_;
    at_once(round_.size(), context, [&](std::size_t k) {
      best[k] = trials_.with_one([&](FlipTrials& trials) { return trials(round_[k], most_tries); });
    });
    tries_ = trials_.tries();
    std::vector<TetIds> again;
    for (std::size_t k = 0; k < round_.size(); ++k) {
      // Where targets rise, a patch that raises the worst tet may leave more of them below the last target. It may do
      // so as long as others have left fewer.
      if (best[k].found && more_below_target_ + best[k].more_below_target <= 0) {
        keep(round_[k], best[k]);
        again.push_back(round_[k]);  // it may have become better and be bad
      } else {
        given_up_.push_back(round_[k]);
        hopeless_.insert(round_[k].begin(), round_[k].end());
      }
    }
    waiting_.insert(waiting_.begin(), again.begin(), again.end());
  }
}

void RepairRounds::slide(const Context& context) {
  std::vector<std::size_t> left(kept_.size());
  std::iota(left.begin(), left.end(), std::size_t{0});
  std::vector<BackgroundLayer> slid(kAtOnce);
  while (!left.empty()) {
    std::vector<std::size_t> round, held;
    std::vector<PatchRanges::Range> before;
    std::size_t next = 0;
    for (; next < left.size() && round.size() < kAtOnce && held.size() < kMostWaiting; ++next) {
      const PatchRanges::Range range = ranges_.of(kept_[left[next]].front());
      (range.meets_any(before) ? held : round).push_back(left[next]);
      before.push_back(range);
    }
    at_once(round.size(), context, [&](std::size_t k) {
      slid[k] = trials_.with_one([&](FlipTrials& trials) { return trials.slid(kept_[round[k]]); });
    });
    for (std::size_t k = 0; k < round.size(); ++k) move(slid[k]);
    held.insert(held.end(), left.begin() + static_cast<std::ptrdiff_t>(next), left.end());
    left = std::move(held);
  }
}

RepairReport RepairRounds::report() {
  RepairReport all;
  all.tries = tries_;
  all.psi_evaluations = psi_evaluations_ + trials_.psi_evaluations();
  for (const std::int64_t v : moved_.ids()) all.moved.emplace_back(v, positions_.of(v));
  all.flipped.assign(flipped_.begin(), flipped_.end());
  std::sort(all.moved.begin(), all.moved.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  return all;
}

}  // namespace umtet::detail
