#include "mesh/fast/detail/flip_trials.h"

#include <algorithm>
#include <limits>

#include "mesh/fast/tangential_relaxation.h"
#include "mesh/core/tet_quality.h"

namespace umtet::detail {
namespace {

// Pairs are tried from this many of the most promising labels, with this many second ones each.
constexpr std::size_t kFirstOfPair = 6, kSecondOfPair = 8;
// After sweep k of smoothing, how much below what it was the least Q of a patch may be, times k^2, and how many more
// poor tets it may have, times k. Of the 617 patches that ended better among 3900 (T6 and T8 of 100k and 500k tets,
// eqs. (9) and (13) of 500k), one had lacked more; the others are given up after two fifths of the visits.
constexpr double kMostLack = .7, kMostMorePoor = 280;
// Where a label has been found that helps, those whose flip costs so much more are not tried: of 245 (T6, T8, a plate
// with 18 holes, eqs. (9) and (13) at 500k tets) three would have been better than with 30, half of the tries went
// there. With 30 the armadillo keeps a tet of Q = .8075, with 60 or without a bound its worst is .8129.
constexpr float kMostMoreEnergy = 60;

}  // namespace

Vec3 Places::of(std::int64_t v, std::size_t& from) const {
  if (const int moved = moved_.find(v); moved >= 0) return moved_to_[moved];
  // The vertices of a patch are near each other in the shell: steps that double.
  const auto& ids = shell_.background_vertex;
  std::size_t step = 1;
  for (; from + step < ids.size() && ids[from + step] < v; step *= 2) from += step;
  const auto begin = ids.begin() + static_cast<std::ptrdiff_t>(from),
             end = ids.begin() + static_cast<std::ptrdiff_t>(std::min(from + step, ids.size()));
  from = static_cast<std::size_t>(std::lower_bound(begin, end, v) - ids.begin());
  return from < ids.size() && ids[from] == v ? shell_.shell.V[from] : background_.position(v);
}

void Places::move(std::int64_t v, const Vec3& x) {
  const auto at = static_cast<std::size_t>(moved_.add(v));
  moved_to_.resize(moved_.ids().size());
  moved_to_[at] = x;
}

bool LabelTrials::is_turned(const TetIds& tet) {
  std::vector<std::uint8_t> inside;
  for (const std::int64_t v : tet) inside.push_back(inside_.test(v));
  Triangle f;
  if (!positive_face({0, 1, 2, 3}, inside, f)) return false;
  return normal_cosine(psi_, places_.of(tet[f[0]]), places_.of(tet[f[1]]), places_.of(tet[f[2]]), background_.h(),
                       psi_evaluations) < kTurnedCosine;
}

bool LabelTrials::is_bad(const TetIds& tet) {
  bool in_omega_h = false;
  for (const std::int64_t v : tet) in_omega_h |= inside_.test(v);
  if (!in_omega_h) return false;
  return mean_ratio(places_.of(tet[0]), places_.of(tet[1]), places_.of(tet[2]), places_.of(tet[3])) < target_ ||
         is_turned(tet);
}

LatticeShell LabelTrials::patch(const std::vector<std::int64_t>& centres, Start start) const {
  LatticeShell cut = lattice_patch(background_, links_, inside_, centres, params_.reach);
  for (std::size_t v = 0, from = 0; v < cut.shell.V.size(); ++v) {
    if (start == Start::Here || cut.shell.role[v] == Shell::Role::Fixed)
      cut.shell.V[v] = places_.of(cut.background_vertex[v], from);
  }
  return cut;
}

PatchState LabelTrials::state(const Shell& shell, const std::vector<std::uint8_t>& inside) {
  return patch_state(shell, inside, psi_, target_, psi_evaluations);
}

/// Returns whether the patch may still become better than it was; what it lacks is looked at after every sweep.
bool LabelTrials::smooth_while_promising(PNormSmoother& smoother, const PatchState& before) {
  SmoothParams one_sweep = smoothing_;
  one_sweep.max_sweeps = 1;
  for (int sweep = 1; sweep <= smoothing_.max_sweeps; ++sweep) {
    const SmoothReport report = smoother.run(psi_, one_sweep);
    psi_evaluations += report.psi_evaluations;
    if (report.settled) break;
    const PatchState now = tet_state(smoother.shell(), target_);
    const double lack = std::min(before.least, target_) - now.least;
    const double more_poor = static_cast<double>(now.poor) - static_cast<double>(before.poor);
    if (lack * sweep * sweep > kMostLack || more_poor * sweep > kMostMorePoor) return false;
  }
  return true;
}

/// Flips these labels on a copy, shapes the patch around them and the tet, and keeps it as the best one if it is.
void LabelTrials::attempt(const TetIds& tet, std::span<const std::int64_t> flips, Start start, Best& best) {
  if (tries >= end_of_tries_) return;
  ++tries;
  std::vector<std::int64_t> centres(tet.begin(), tet.end());
  centres.insert(centres.end(), flips.begin(), flips.end());
  for (const std::int64_t v : flips) flip(v);
  LatticeShell trial = patch(centres, start);
  const std::vector<std::uint8_t> inside = inside_of(trial, inside_);
  for (const std::int64_t v : flips) flip(v);
  PNormSmoother smoother(trial.shell);
  const ProjectionReport projection = project(smoother, psi_, params_.projection);
  psi_evaluations += projection.psi_evaluations;
  if (!projection.not_arrived.empty()) return;
  const LatticeShell now = patch(centres, Start::Here);
  const PatchState before = state(now.shell, inside_of(now, inside_));
  smoother.wake_all();
  if (!smooth_while_promising(smoother, before)) return;
  const PatchState after = state(trial.shell, inside);
  if (!after.is_no_worse_than(before) || !after.is_better_than(before)) return;
  if (!best.found || after.is_better_than(best.state))
    best = {std::move(trial), after, {flips.begin(), flips.end()}, true};
}

void LabelTrials::try_labels(const TetIds& tet, Start start, Best& best) {
  const std::vector<LabelCandidates::Candidate> singles = candidates_(tet, psi_evaluations);
  float most_energy = std::numeric_limits<float>::infinity();
  for (const auto& c : singles) {
    if (c.energy > most_energy) break;
    attempt(tet, std::array{c.vertex}, start, best);
    if (best.is_perfect()) return;
    if (best.found) most_energy = std::min(most_energy, c.energy + kMostMoreEnergy);
  }
  // Pairs cost as many patches as all singles do, and are for where none of these helps.
  for (std::size_t a = 0; a < std::min(singles.size(), kFirstOfPair) && !best.found; ++a) {
    flip(singles[a].vertex);
    const std::vector<LabelCandidates::Candidate> seconds = candidates_(tet, psi_evaluations);
    flip(singles[a].vertex);
    for (std::size_t b = 0; b < std::min(seconds.size(), kSecondOfPair) && !best.is_perfect(); ++b) {
      if (seconds[b].vertex != singles[a].vertex)
        attempt(tet, std::array{singles[a].vertex, seconds[b].vertex}, start, best);
    }
  }
}

LatticeShell LabelTrials::slid(const std::vector<std::int64_t>& centres) {
  LatticeShell now = patch(centres, Start::Here);
  const std::vector<std::uint8_t> inside = inside_of(now, inside_);
  const PatchState before = state(now.shell, inside);
  ChordParams chords{.least_quality = target_};
  // Smoothing what is behind the boundary makes room, but looks at sums: without it nothing falls below the target.
  for (const int inner_sweeps : {chords.inner_sweeps, 0}) {
    chords.inner_sweeps = inner_sweeps;
    LatticeShell cut = now;
    PNormSmoother smoother(cut.shell);
    psi_evaluations += slide_to_chords(smoother, inside, psi_, chords, params_.smoothing).psi_evaluations;
    if (state(cut.shell, inside).is_no_worse_than(before)) return cut;
  }
  return now;
}

LabelTrials::Best LabelTrials::operator()(const TetIds& tet, std::size_t most_tries) {
  end_of_tries_ = tries + most_tries;
  Best best;
  if (is_turned(tet)) {
    attempt(tet, {}, Start::Lattice, best);
    if (!best.is_perfect()) try_labels(tet, Start::Lattice, best);
  }
  if (!best.found && smoothing_.sharper) attempt(tet, {}, Start::Here, best);
  if (!best.found) try_labels(tet, Start::Here, best);
  return best;
}

}  // namespace umtet::detail
