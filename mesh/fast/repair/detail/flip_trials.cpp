#include "mesh/fast/repair/detail/flip_trials.h"

#include <algorithm>
#include <limits>

#include "mesh/core/tet_quality.h"
#include "mesh/fast/smoothing/all_vertex_smoothing.h"
#include "mesh/fast/smoothing/tangential_relaxation.h"

namespace umtet::detail {
namespace {

// Pairs are tried from this many of the most promising flips, with this many second ones each: 48 trials, twice as many
// as of single flips (RepairParams::max_tries).
constexpr std::size_t kFirstOfPair = 6, kSecondOfPair = 8;
// A trial is given up when, after sweep k of smoothing, the least Q of its patch is lower than it was by more than
// kMostLack / k^2, or it has kMostMoreBelowTarget / k more tets below the target. Smoothing gains most in its first
// sweeps, so a patch that is that far behind does not catch up. Less loses patches that would end better; more smooths
// hopeless ones to the end.
constexpr double kMostLack = .7, kMostMoreBelowTarget = 280;
// Where a flip has been found that helps, those whose star costs are so much higher are not tried. With less, the best
// flip is missed where star costs are wrong about a patch; with more, time goes into flips that are worse.
constexpr float kMostMoreCost = 60;
// Sweeps before all vertices are moved at once, which then goes on. That the patch is promising is judged after so many
// only: what one vertex at a time cannot raise all of them together may.
constexpr int kSweepsBefore = 6;
// All vertices are moved until the least Q is so far above the target: a patch that just gets there falls below it when
// the next one is smoothed.
constexpr double kRoom = .004;

/// Puts these vertices and those around them in the queue.
/// @param centres  in the background
void enqueue_around(PNormSmoother& smoother, const BackgroundLayer& cut, const std::vector<std::int64_t>& centres) {
  for (std::size_t v = 0; v < cut.layer.V.size(); ++v) {
    const bool is_centre = std::find(centres.begin(), centres.end(), cut.background_vertex[v]) != centres.end();
    if (is_centre && cut.layer.role[v] != ActiveLayer::Role::Fixed) smoother.enqueue(static_cast<int>(v));
  }
}

}  // namespace

std::size_t most_patches_of(const FlipEffort& effort, int max_tries) {
  const std::size_t singles = std::min(effort.most_singles, static_cast<std::size_t>(max_tries));
  return std::max<std::size_t>(1, effort.all_vertices + singles + (effort.pairs ? kFirstOfPair * kSecondOfPair : 0));
}

Vec3 Positions::of(std::int64_t v, std::size_t& from) const {
  if (const int moved = moved_.find(v); moved >= 0) return moved_to_[moved];
  // The vertices of a patch are near each other in the layer: steps that double.
  const auto& ids = layer_.background_vertex;
  std::size_t step = 1;
  for (; from + step < ids.size() && ids[from + step] < v; step *= 2) from += step;
  const auto begin = ids.begin() + static_cast<std::ptrdiff_t>(from),
             end = ids.begin() + static_cast<std::ptrdiff_t>(std::min(from + step, ids.size()));
  from = static_cast<std::size_t>(std::lower_bound(begin, end, v) - ids.begin());
  if (from < ids.size() && ids[from] == v) return layer_.layer.V[from];
  const auto is_before = [](const KeptVertex& k, std::int64_t id) { return k.vertex < id; };
  const auto kept = std::lower_bound(kept_.begin(), kept_.end(), v, is_before);
  return kept != kept_.end() && kept->vertex == v ? kept->final : background_.position(v);
}

void Positions::move(std::int64_t v, const Vec3& x) {
  const auto at = static_cast<std::size_t>(moved_.add(v));
  moved_to_.resize(moved_.ids().size());
  moved_to_[at] = x;
}

bool FlipTrials::is_misaligned(const TetIds& tet) {
  std::vector<std::uint8_t> inside;
  for (const std::int64_t v : tet) inside.push_back(inside_.test(v));
  Triangle f;
  if (!positive_face({0, 1, 2, 3}, inside, f)) return false;
  return normal_cosine(psi_, positions_.of(tet[f[0]]), positions_.of(tet[f[1]]), positions_.of(tet[f[2]]),
                       background_.h(tet[f[0]]), psi_evaluations) < kMisalignedCosine;
}

bool FlipTrials::is_bad(const TetIds& tet) {
  bool in_omega_h = false;
  for (const std::int64_t v : tet) in_omega_h |= inside_.test(v);
  if (!in_omega_h) return false;
  return mean_ratio(positions_.of(tet[0]), positions_.of(tet[1]), positions_.of(tet[2]), positions_.of(tet[3])) <
             target_ ||
         is_misaligned(tet);
}

BackgroundLayer FlipTrials::patch(const std::vector<std::int64_t>& centres, Start start) const {
  BackgroundLayer cut = active_patch(background_, links_, inside_, centres, params_.reach + effort_.more_reach);
  for (std::size_t v = 0, from = 0; v < cut.layer.V.size(); ++v) {
    if (start == Start::Here || cut.layer.role[v] == ActiveLayer::Role::Fixed)
      cut.layer.V[v] = positions_.of(cut.background_vertex[v], from);
  }
  return cut;
}

PatchState FlipTrials::state(const ActiveLayer& layer, const std::vector<std::uint8_t>& inside) {
  return patch_state(layer, inside, psi_, target_, psi_evaluations);
}

/// Returns whether the patch may still become better than it was; what it lacks is looked at after every sweep.
bool FlipTrials::smooth_while_promising(PNormSmoother& smoother, const PatchState& before) {
  SmoothingParams one_sweep = params_.smoothing;
  one_sweep.max_sweeps = 1;
  const int most =
      effort_.all_vertices ? std::min(kSweepsBefore, params_.smoothing.max_sweeps) : params_.smoothing.max_sweeps;
  for (int sweep = 1; sweep <= most; ++sweep) {
    const SmoothingReport report = smoother.run(psi_, one_sweep);
    psi_evaluations += report.psi_evaluations;
    if (report.settled) break;
    const PatchState now = tet_state(smoother.layer(), target_);
    const double lack = std::min(before.least, target_) - now.least;
    const double more_below_target = static_cast<double>(now.below_target) - static_cast<double>(before.below_target);
    if (lack * sweep * sweep > kMostLack || more_below_target * sweep > kMostMoreBelowTarget) return false;
  }
  return true;
}

/// Tets below params.target, which may not be the target now.
std::ptrdiff_t FlipTrials::more_below_target(const ActiveLayer& after, const ActiveLayer& before) const {
  const auto n = [&](const ActiveLayer& layer) {
    return static_cast<std::ptrdiff_t>(tet_state(layer, params_.target).below_target);
  };
  return n(after) - n(before);
}

/// Flips these vertices on a copy, shapes the patch around them and the tet, and keeps it if it is the best one so far.
void FlipTrials::attempt(const TetIds& tet, std::span<const std::int64_t> flips, Start start, Best& best) {
  if (tries >= end_of_tries_) return;
  ++tries;
  std::vector<std::int64_t> centres(tet.begin(), tet.end());
  centres.insert(centres.end(), flips.begin(), flips.end());
  for (const std::int64_t v : flips) flip(v);
  BackgroundLayer trial = patch(centres, start);
  const std::vector<std::uint8_t> inside = inside_of(trial, inside_);
  for (const std::int64_t v : flips) flip(v);
  PNormSmoother smoother(trial.layer);
  // What is far from the flips is where smoothing has left it: moves there begin next to those near by. In a lattice,
  // whose bad tets are few and just below the target, there is something to move everywhere.
  const bool moves_all = start == Start::Lattice || background_.is_lattice();
  if (!moves_all) smoother.dequeue_all(), enqueue_around(smoother, trial, centres);
  const ProjectionReport projection = project(smoother, psi_, params_.projection);
  psi_evaluations += projection.psi_evaluations;
  if (!projection.not_arrived.empty()) return;
  const BackgroundLayer now = patch(centres, Start::Here);
  const PatchState before = state(now.layer, inside_of(now, inside_));
  moves_all ? smoother.enqueue_all() : enqueue_around(smoother, trial, centres);
  if (!smooth_while_promising(smoother, before)) return;
  PatchState after = state(trial.layer, inside);
  if (effort_.all_vertices && after.misaligned == 0 && after.below_target > 0) {
    psi_evaluations += smooth_all_vertices(trial.layer, psi_, target_ + kRoom).psi_evaluations;
    after = state(trial.layer, inside);
  }
  if (!after.is_no_worse_than(before) || !after.is_better_than(before)) return;
  if (best.found && !after.is_better_than(best.state)) return;
  const std::ptrdiff_t more = more_below_target(trial.layer, now.layer);
  best = {std::move(trial), after, {flips.begin(), flips.end()}, more, true};
}

void FlipTrials::try_flips(const TetIds& tet, Start start, Best& best) {
  if (effort_.most_singles == 0) return;
  std::vector<FlipCandidates::Candidate> singles = candidates_(tet, psi_evaluations);
  if (singles.size() > effort_.most_singles) singles.resize(effort_.most_singles);
  float most_cost = std::numeric_limits<float>::infinity();
  for (const auto& c : singles) {
    if (c.cost > most_cost) break;
    attempt(tet, std::array{c.vertex}, start, best);
    if (best.is_perfect()) return;
    if (best.found) most_cost = std::min(most_cost, c.cost + kMostMoreCost);
  }
  if (!effort_.pairs) return;
  // Pairs cost as many patches as all singles do, and are for where none of these helps.
  for (std::size_t a = 0; a < std::min(singles.size(), kFirstOfPair) && !best.found; ++a) {
    flip(singles[a].vertex);
    const std::vector<FlipCandidates::Candidate> seconds = candidates_(tet, psi_evaluations);
    flip(singles[a].vertex);
    for (std::size_t b = 0; b < std::min(seconds.size(), kSecondOfPair) && !best.is_perfect(); ++b) {
      if (seconds[b].vertex != singles[a].vertex)
        attempt(tet, std::array{singles[a].vertex, seconds[b].vertex}, start, best);
    }
  }
}

BackgroundLayer FlipTrials::slid(const std::vector<std::int64_t>& centres) {
  BackgroundLayer now = patch(centres, Start::Here);
  const std::vector<std::uint8_t> inside = inside_of(now, inside_);
  const PatchState before = state(now.layer, inside);
  TangentialRelaxationParams chords{.least_quality = target_};
  // Smoothing behind the boundary makes room, but it lowers sums over rings, so that a tet may fall below the target.
  // Then the patch is relaxed without it, which keeps every tet above.
  for (const int inner_sweeps : {chords.inner_sweeps, 0}) {
    chords.inner_sweeps = inner_sweeps;
    BackgroundLayer cut = now;
    PNormSmoother smoother(cut.layer);
    psi_evaluations += relax_tangentially(smoother, inside, psi_, chords, params_.smoothing).psi_evaluations;
    if (state(cut.layer, inside).is_no_worse_than(before) && more_below_target(cut.layer, now.layer) <= 0) return cut;
  }
  return now;
}

FlipTrials::Best FlipTrials::operator()(const TetIds& tet, std::size_t most_tries) {
  end_of_tries_ = tries + most_tries;
  Best best;
  if (is_misaligned(tet)) {
    attempt(tet, {}, Start::Lattice, best);
    if (!best.is_perfect()) try_flips(tet, Start::Lattice, best);
  }
  if (!best.found && effort_.all_vertices) attempt(tet, {}, Start::Here, best);
  if (!best.found) try_flips(tet, Start::Here, best);
  return best;
}

}  // namespace umtet::detail
