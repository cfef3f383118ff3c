#include "mesh/fast/repair.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <numeric>
#include <set>
#include <stdexcept>
#include <thread>
#include <utility>

#include "mesh/core/tet_quality.h"
#include "mesh/fast/detail/flip_trials.h"
#include "mesh/fast/detail/patch_ranges.h"
#include "mesh/fast/detail/trial_pool.h"

namespace umtet {
namespace {

using detail::FlipEffort;
using detail::FlipTrials;
using detail::PatchRanges;
using detail::TetIds;
using detail::TrialPool;

// At most kFewPatches patches are tried, and one more for every kTetsPerPatch tets of the layer (and never more than
// max_patches). In a small mesh where h is too large for the body, most tets are bad and no flip mends them: without
// this bound repair would take longer than all other steps.
constexpr std::size_t kFewPatches = 600, kTetsPerPatch = 4;
// Where h shows the body a tet is mended by three to eight patches. Where it does not, fifty to a hundred are tried for
// one that helps: kFewPatches and this many for each that did are enough to tell.
constexpr std::size_t kPatchesPerSuccess = 16;

/// What a pass tries for a tet, and in how many patches at most: in `few`, and `per_success` for each that helped.
struct Effort {
  FlipEffort flips;
  std::size_t most, few = kFewPatches, per_success = kPatchesPerSuccess;
};

// Outside of lattices one tet in forty may be below the target, and a patch never without one. So targets rise from the
// worst tet on in the first pass there, which tries few candidates a tet: four of five flips that help are among the
// first six. `graded_bodies.py` and `graded_bench` show what others give.
constexpr Effort kFewFlips{{.most_singles = 6, .pairs = false}, 1500};
// What the first pass leaves is raised without a flip where all vertices of a patch move at once, and then with any.
// Fewer patches leave lower least Q in thin bodies; more take longer than all other steps. Outside of lattices patches
// without flips are an edge larger, which halves what they leave.
constexpr Effort kNoFlips{{.all_vertices = true, .most_singles = 0, .pairs = false}, 700, 100, 6};
constexpr Effort kAllFlips{{.all_vertices = true}, 500, 100, 6};
constexpr Effort kNoFlipsInListed{{.all_vertices = true, .most_singles = 0, .pairs = false, .more_reach = 1}, 1000};
constexpr Effort kAllFlipsInListed{{.all_vertices = true}, 1500};
// These two come twice: what was raised around a tet may let it be raised. And by smaller steps: a flip that raises the
// worst tet often leaves more of them a little higher.
constexpr int kRounds = 2;
constexpr double kSmallerSteps = .25;  // of RepairParams::target_step
// Tets that are mended at once, while at most kMostWaiting wait for one near them: two for each of sixteen cores. The
// same for any number of threads, as the result depends on it. Where few patches may still be tried they are fewer: a
// tet takes up to kPatchesPerTet.
constexpr std::size_t kAtOnce = 32, kMostWaiting = 256, kPatchesPerTet = 72;

class Repair {
 public:
  Repair(const BackgroundMesh& background, const VertexLinks& links, ImplicitFunctionRef psi,
         const ClassificationParams& classification, const RepairParams& params, const BackgroundLayer& layer,
         RemoteLayer* remote, IdSet& inside, const std::vector<KeptVertex>& kept)
      : background_(background),
        psi_(psi),
        params_(params),
        layer_(layer),
        remote_(remote),
        inside_(inside),
        most_in_a_pass_(std::min(params.max_patches,
                                 kFewPatches + (remote ? remote->n_tets() : layer.layer.C.size()) / kTetsPerPatch)),
        target_(params.target),
        positions_(background, layer, kept),
        trials_(background, links, psi, classification, params, positions_, inside),
        ranges_(background, links, params.reach + (background.is_lattice() ? 0 : kNoFlipsInListed.flips.more_reach)) {}

  RepairReport operator()(const Context& context);

 private:
  using Bad = BadTet;
  static bool is_worse(const Bad& a, const Bad& b) { return a.badness < b.badness; }

  /// What a pass over bad tets may cost, and where it began.
  struct Pass {
    std::size_t most_patches = 0, few = 0, per_success = 0;
    std::size_t tries = 0, kept = 0;  ///< before it
  };

  /// Misaligned ones before all others.
  Bad judged(const TetIds& tet) {
    if (trials_.first().is_misaligned(tet)) return {-1, tet};
    return {mean_ratio(positions_.of(tet[0]), positions_.of(tet[1]), positions_.of(tet[2]), positions_.of(tet[3])),
            tet};
  }
  bool is_worth_trying(const TetIds& tet);
  void find_ranges();
  void mend(const Context& context);
  void slide(const Context& context);
  void raise(const Context& context);
  void begin_pass(const Effort& effort);
  void judge_what_waits();
  bool mend_rising(const Effort& effort, double top, double step, const Context& context);
  void retry_with(double target, const FlipEffort& effort);
  bool choose_round();
  void know(const std::vector<LayerVertex>& vertices);
  void keep(const TetIds& tet, const FlipTrials::Best& best);
  void move(const BackgroundLayer& patch);
  void look(const BackgroundLayer& cut);
  void begin();

  const BackgroundMesh& background_;
  ImplicitFunctionRef psi_;
  const RepairParams& params_;
  const BackgroundLayer& layer_;
  RemoteLayer* remote_;  ///< in place of layer_, which is empty then; or null
  IdSet& inside_;
  std::size_t most_patches() const {
    const std::size_t worth_it = pass_.few + pass_.per_success * (kept_.size() - pass_.kept);
    return pass_.tries + std::min(pass_.most_patches, worth_it);
  }
  const std::size_t most_in_a_pass_;
  Pass pass_;
  double target_;
  detail::Positions positions_;
  TrialPool trials_;
  std::vector<TetIds> given_up_;
  std::set<std::int64_t> hopeless_;  ///< vertices of tets that nothing helped
  std::vector<Bad> todo_;            ///< from next_ on
  std::size_t next_ = 0;
  std::vector<Bad> later_;                       ///< not below target_, but below another that comes
  std::vector<TetIds> waiting_;                  ///< before todo_
  std::vector<std::vector<std::int64_t>> kept_;  ///< centres of the patches
  IdList moved_;                                 ///< vertices that patches have moved
  std::set<std::int64_t> flipped_;               ///< vertices with another state
  std::vector<TetIds> round_;  ///< far from each other: what is done for one does not touch the others
  PatchRanges ranges_;         ///< of first vertices
  RepairReport report_;
};

/// False for one that is all right, or given up.
bool Repair::is_worth_trying(const TetIds& tet) {
  if (!trials_.first().is_bad(tet)) return false;
  // Where no flip helped, none would help the tets that share a vertex either: their candidates are the same.
  const bool hopeless = std::any_of(tet.begin(), tet.end(), [&](std::int64_t v) { return hopeless_.count(v) != 0; });
  if (!hopeless && report_.tries < most_patches()) return true;
  given_up_.push_back(tet);
  return false;
}

/// Of the tets that the next round may look at. Outside of lattices that is worth several threads.
void Repair::find_ranges() {
  std::vector<std::int64_t> vertices;
  for (const TetIds& tet : waiting_) vertices.push_back(tet[0]);
  for (std::size_t k = next_; k < std::min(todo_.size(), next_ + kAtOnce + kMostWaiting); ++k) {
    vertices.push_back(todo_[k].tet[0]);
  }
  ranges_.find(vertices);
}

/// The next tets in their order, but for those near one that comes before them: these wait.
bool Repair::choose_round() {
  find_ranges();
  round_.clear();
  std::vector<TetIds> held;
  std::vector<PatchRanges::Range> before;
  const std::size_t left = most_patches() - std::min(report_.tries, most_patches());
  const std::size_t most = std::clamp<std::size_t>(left / kPatchesPerTet, 2, kAtOnce);
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

void Repair::move(const BackgroundLayer& patch) {
  for (std::size_t v = 0; v < patch.layer.V.size(); ++v) {
    if (patch.layer.role[v] == ActiveLayer::Role::Fixed) continue;
    positions_.move(patch.background_vertex[v], patch.layer.V[v]);
    moved_.add(patch.background_vertex[v]);
  }
}

/// Vertices of a layer elsewhere, none of which has been changed here.
void Repair::know(const std::vector<LayerVertex>& vertices) {
  for (const LayerVertex& v : vertices) {
    if (!positions_.has_moved(v.vertex)) positions_.move(v.vertex, v.place);
    if (!v.is_inside || inside_.test(v.vertex)) continue;
    inside_.insert(v.vertex);
    trials_.flip(v.vertex);
  }
}

void Repair::keep(const TetIds& tet, const FlipTrials::Best& best) {
  for (const std::int64_t v : best.flips) {
    inside_.test(v) ? inside_.erase(v) : inside_.insert(v);
    trials_.flip(v);
    if (!flipped_.insert(v).second) flipped_.erase(v);
  }
  move(best.layer);
  kept_.emplace_back(tet.begin(), tet.end());
  kept_.back().insert(kept_.back().end(), best.flips.begin(), best.flips.end());
  report_.flips += best.flips.size();
  look(best.layer);  // the patch may have bad tets that were not bad before; max_patches ends this
}

/// Puts the tets of a layer that are below the target, or have a misaligned face, on the list, the worst first.
void Repair::look(const BackgroundLayer& cut) {
  const std::size_t first = todo_.size();
  for (const BadTet& bad : bad_tets(cut, inside_, psi_, params_.target + params_.lift, report_.psi_evaluations))
    (bad.badness < target_ ? todo_ : later_).push_back(bad);
  std::stable_sort(todo_.begin() + static_cast<std::ptrdiff_t>(first), todo_.end(), is_worse);
}

void Repair::begin() {
  if (!remote_) return look(layer_);
  know(remote_->corners());
  for (const Bad& bad : remote_->bad()) (bad.badness < target_ ? todo_ : later_).push_back(bad);
  std::stable_sort(todo_.begin(), todo_.end(), is_worse);
}

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

/// What is on the list, round by round.
void Repair::mend(const Context& context) {
  std::vector<FlipTrials::Best> best(kAtOnce);
  while (choose_round()) {
    const std::size_t most_tries = most_patches() - report_.tries;
    at_once(round_.size(), context, [&](std::size_t k) {
      best[k] = trials_.with_one([&](FlipTrials& trials) { return trials(round_[k], most_tries); });
    });
    report_.tries = trials_.tries();
    std::vector<TetIds> again;
    for (std::size_t k = 0; k < round_.size(); ++k) {
      if (best[k].found) {
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

/// The patches that were kept, in their order but for those near one that comes before them.
void Repair::slide(const Context& context) {
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

void Repair::retry_with(double target, const FlipEffort& effort) {
  target_ = target;
  trials_.retry_with(target, effort);
}

void Repair::begin_pass(const Effort& effort) {
  pass_ = {std::min(most_in_a_pass_, effort.most), effort.few, effort.per_success, report_.tries, kept_.size()};
}

/// Tets that were given up wait again, those that are still bad, with what they are like now.
void Repair::judge_what_waits() {
  for (const Bad& bad : later_) given_up_.push_back(bad.tet);
  std::sort(given_up_.begin(), given_up_.end());
  given_up_.erase(std::unique(given_up_.begin(), given_up_.end()), given_up_.end());
  later_.clear();
  for (const TetIds& tet : given_up_) {
    if (trials_.first().is_bad(tet)) later_.push_back(judged(tet));
  }
  given_up_.clear();
  hopeless_.clear();
}

/// What waits, and is below a target that rises from the worst tet on.
/// @param top  the last target
/// @return whether it got there
bool Repair::mend_rising(const Effort& effort, double top, double step, const Context& context) {
  begin_pass(effort);
  retry_with(top, effort.flips);
  judge_what_waits();
  if (!(step > 0)) step = top;
  for (auto k = static_cast<int>(top / step) - 1; k >= 0; --k) {
    if (report_.tries >= most_patches()) return false;
    retry_with(top - k * step, effort.flips);
    const auto is_below = [&](const Bad& b) { return b.badness < target_; };
    // The badness of misaligned ones is a cosine, which does not say where to begin.
    const auto counts = [&](const Bad& b) { return is_below(b) && (k == 0 || b.badness >= kMisalignedCosine); };
    if (std::none_of(later_.begin(), later_.end(), counts)) continue;
    std::stable_sort(later_.begin(), later_.end(), is_worse);
    const auto end = std::partition_point(later_.begin(), later_.end(), is_below);
    todo_.assign(later_.begin(), end);
    later_.erase(later_.begin(), end);
    next_ = 0;
    mend(context);
  }
  return true;
}

/// What is left, and what is above the target by less than params_.lift.
void Repair::raise(const Context& context) {
  const bool is_lattice = background_.is_lattice();
  const double top = params_.target + params_.lift, step = kSmallerSteps * params_.target_step;
  for (int round = 0; round < kRounds; ++round) {
    const bool was_raised = mend_rising(is_lattice ? kNoFlips : kNoFlipsInListed, top, step, context);
    // Where h is too large for the body there is no end to it.
    if (!mend_rising(is_lattice ? kAllFlips : kAllFlipsInListed, top, step, context) || !was_raised) break;
  }
  report_.given_up = given_up_.size();
}

RepairReport Repair::operator()(const Context& context) {
  if (params_.max_tries > 0) begin();
  report_.bad_before = todo_.size();
  if (todo_.empty() && later_.empty()) return std::move(report_);
  if (background_.is_lattice()) {
    begin_pass({.flips = {}, .most = params_.max_patches});
    mend(context);
  } else {
    later_ = std::exchange(todo_, {});
    mend_rising(kFewFlips, params_.target, params_.target_step, context);
  }
  if (params_.all_vertices) raise(context);
  if (params_.slides) {
    retry_with(params_.target + params_.lift, {});
    slide(context);
  }
  report_.psi_evaluations += trials_.psi_evaluations();
  for (const std::int64_t v : moved_.ids()) report_.moved.emplace_back(v, positions_.of(v));
  report_.flipped.assign(flipped_.begin(), flipped_.end());
  std::sort(report_.moved.begin(), report_.moved.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  return std::move(report_);
}

/// \throw std::invalid_argument
void check(const ClassificationParams& classification, const RepairParams& params) {
  std::string all;
  for (const auto& list : {problems(classification), problems(params)}) {
    for (const std::string& problem : list) all += (all.empty() ? "" : "; ") + problem;
  }
  if (!all.empty()) throw std::invalid_argument(all);
}

}  // namespace

RepairReport repair(const BackgroundMesh& background, const VertexLinks& links, ImplicitFunctionRef psi,
                    const ClassificationParams& classification, const RepairParams& params,
                    const BackgroundLayer& layer, IdSet& inside, const Context& context,
                    const std::vector<KeptVertex>& kept) {
  check(classification, params);
  return Repair(background, links, psi, classification, params, layer, nullptr, inside, kept)(context);
}

RepairReport repair(const BackgroundMesh& background, const VertexLinks& links, ImplicitFunctionRef psi,
                    const ClassificationParams& classification, const RepairParams& params, RemoteLayer& layer,
                    IdSet& inside, const Context& context) {
  check(classification, params);
  const BackgroundLayer none;
  return Repair(background, links, psi, classification, params, none, &layer, inside, {})(context);
}

}  // namespace umtet
