#include "mesh/repair.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <set>
#include <span>
#include <stdexcept>

#include "mesh/detail/id_list.h"
#include "mesh/detail/label_candidates.h"
#include "mesh/patch_state.h"
#include "mesh/tet_quality.h"

namespace umtet {
namespace {

using detail::IdSet;

// Pairs are tried from this many of the most promising labels, with this many second ones each.
constexpr std::size_t kFirstOfPair = 6, kSecondOfPair = 8;
// Besides max_patches: so many, and one for so many tets of the shell. A coarse perforated plate of 5092 tets is mended
// by its 1724th patch, and until then looks no better than lenses that never are: one of 1600 tets took 3000.
constexpr std::size_t kFewPatches = 600, kTetsPerPatch = 4;
// After sweep k of smoothing, how much below what it was the least Q of a patch may be, times k^2, and how many more
// poor tets it may have, times k. Of the 617 patches that ended better among 3900 (T6 and T8 of 100k and 500k tets,
// eqs. (9) and (13) of 500k), one had lacked more; the others are given up after two fifths of the visits.
constexpr double kMostLack = .7, kMostMorePoor = 280;

// Where a label has been found that helps, those whose flip costs so much more are not tried: of 245 (T6, T8, a plate
// with 18 holes, eqs. (9) and (13) at 500k tets) three would have been better, and none much; half of the tries went
// there.
constexpr float kMostMoreEnergy = 30;

class Repair {
 public:
  Repair(const BackgroundMesh& background, const std::vector<LinkTopology>& links, ImplicitFunctionRef psi,
         const LabelParams& labels, const RepairParams& params, const LatticeShell& shell, IdSet& inside)
      : background_(background),
        links_(links),
        psi_(psi),
        params_(params),
        shell_(shell),
        inside_(inside),
        most_patches_(std::min(params.max_patches, kFewPatches + shell.shell.C.size() / kTetsPerPatch)),
        candidates_(background, links, psi, labels, params, inside) {}

  RepairReport operator()(const KeepGoing& keep_going);

 private:
  using Ids = std::array<std::int64_t, 4>;
  struct Best {
    LatticeShell shell;
    PatchState state;
    std::vector<std::int64_t> flips;
    bool found = false;  ///< something betters the patch
    bool is_perfect() const { return found && state.is_perfect(); }
  };
  struct Bad {
    double badness;  ///< the cosine of its face if that is turned, else Q: folded ones are the worst
    Ids tet;
  };
  /// Where a patch's vertices start from: where they are, or (a fold stays a fold under small steps) the lattice.
  enum class Start { Here, Lattice };

  Vec3 place(std::int64_t v, std::size_t& from) const;
  Vec3 place(std::int64_t v) const {
    std::size_t from = 0;
    return place(v, from);
  }
  bool is_turned(const Ids& tet);
  bool still_bad(const Ids& tet);
  void flip(std::int64_t v) { inside_.test(v) ? inside_.erase(v) : inside_.insert(v); }
  LatticeShell patch(const std::vector<std::int64_t>& centres, Start start) const;
  std::vector<std::uint8_t> inside_of(const LatticeShell& cut) const;
  PatchState state(const Shell& shell, const std::vector<std::uint8_t>& inside);
  void attempt(const Ids& tet, std::span<const std::int64_t> flips, Start start, Best& best);
  bool smooth_while_promising(PNormSmoother& smoother, const PatchState& before);
  void try_labels(const Ids& tet, Start start, Best& best);
  bool mend(const Ids& tet);
  void look(const LatticeShell& cut);

  const BackgroundMesh& background_;
  const std::vector<LinkTopology>& links_;
  ImplicitFunctionRef psi_;
  const RepairParams& params_;
  const LatticeShell& shell_;
  IdSet& inside_;
  const std::size_t most_patches_;
  detail::LabelCandidates candidates_;
  detail::IdList moved_;
  std::vector<Vec3> moved_to_;
  std::set<std::int64_t> hopeless_;  ///< vertices of tets that nothing helped
  std::vector<Bad> todo_;
  RepairReport report_;
};

/// Where v is. @param from  where in the shell to look; receives where it was found, for the next greater one
Vec3 Repair::place(std::int64_t v, std::size_t& from) const {
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

bool Repair::is_turned(const Ids& tet) {
  std::vector<std::uint8_t> inside;
  for (const std::int64_t v : tet) inside.push_back(inside_.test(v));
  Triangle f;
  if (!positive_face({0, 1, 2, 3}, inside, f)) return false;
  return normal_cosine(psi_, place(tet[f[0]]), place(tet[f[1]]), place(tet[f[2]]), background_.h(),
                       report_.psi_evaluations) < kTurnedCosine;
}

bool Repair::still_bad(const Ids& tet) {
  bool in_omega_h = false;
  for (const std::int64_t v : tet) in_omega_h |= inside_.test(v);
  if (!in_omega_h) return false;
  return mean_ratio(place(tet[0]), place(tet[1]), place(tet[2]), place(tet[3])) < params_.target || is_turned(tet);
}

LatticeShell Repair::patch(const std::vector<std::int64_t>& centres, Start start) const {
  LatticeShell cut = lattice_patch(background_, links_, inside_, centres, params_.reach);
  for (std::size_t v = 0, from = 0; v < cut.shell.V.size(); ++v) {
    if (start == Start::Here || cut.shell.role[v] == Shell::Role::Fixed)
      cut.shell.V[v] = place(cut.background_vertex[v], from);
  }
  return cut;
}

std::vector<std::uint8_t> Repair::inside_of(const LatticeShell& cut) const {
  std::vector<std::uint8_t> inside;
  for (const std::int64_t v : cut.background_vertex) inside.push_back(inside_.test(v));
  return inside;
}

PatchState Repair::state(const Shell& shell, const std::vector<std::uint8_t>& inside) {
  return patch_state(shell, inside, psi_, params_.target, report_.psi_evaluations);
}

/// Returns whether the patch may still become better than it was; what it lacks is looked at after every sweep.
bool Repair::smooth_while_promising(PNormSmoother& smoother, const PatchState& before) {
  SmoothParams one_sweep = params_.smoothing;
  one_sweep.max_sweeps = 1;
  for (int sweep = 1; sweep <= params_.smoothing.max_sweeps; ++sweep) {
    const SmoothReport report = smoother.run(psi_, one_sweep);
    report_.psi_evaluations += report.psi_evaluations;
    if (report.settled) break;
    const PatchState now = tet_state(smoother.shell(), params_.target);
    const double lack = std::min(before.least, params_.target) - now.least;
    const double more_poor = static_cast<double>(now.poor) - static_cast<double>(before.poor);
    if (lack * sweep * sweep > kMostLack || more_poor * sweep > kMostMorePoor) return false;
  }
  return true;
}

/// Flips these labels on a copy, shapes the patch around them and the tet, and keeps it as the best one if it is.
void Repair::attempt(const Ids& tet, std::span<const std::int64_t> flips, Start start, Best& best) {
  if (report_.tries >= most_patches_) return;
  ++report_.tries;
  std::vector<std::int64_t> centres(tet.begin(), tet.end());
  centres.insert(centres.end(), flips.begin(), flips.end());
  for (const std::int64_t v : flips) flip(v);
  LatticeShell trial = patch(centres, start);
  const std::vector<std::uint8_t> inside = inside_of(trial);
  for (const std::int64_t v : flips) flip(v);
  PNormSmoother smoother(trial.shell);
  const ProjectionReport projection = project(smoother, psi_, params_.projection);
  report_.psi_evaluations += projection.psi_evaluations;
  if (!projection.not_arrived.empty()) return;
  const LatticeShell now = patch(centres, Start::Here);
  const PatchState before = state(now.shell, inside_of(now));
  smoother.wake_all();
  if (!smooth_while_promising(smoother, before)) return;
  const PatchState after = state(trial.shell, inside);
  if (!after.is_no_worse_than(before) || !after.is_better_than(before)) return;
  if (!best.found || after.is_better_than(best.state))
    best = {std::move(trial), after, {flips.begin(), flips.end()}, true};
}

void Repair::try_labels(const Ids& tet, Start start, Best& best) {
  const std::vector<detail::LabelCandidates::Candidate> singles = candidates_(tet, report_.psi_evaluations);
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
    const std::vector<detail::LabelCandidates::Candidate> seconds = candidates_(tet, report_.psi_evaluations);
    flip(singles[a].vertex);
    for (std::size_t b = 0; b < std::min(seconds.size(), kSecondOfPair) && !best.is_perfect(); ++b) {
      if (seconds[b].vertex != singles[a].vertex)
        attempt(tet, std::array{singles[a].vertex, seconds[b].vertex}, start, best);
    }
  }
}

bool Repair::mend(const Ids& tet) {
  Best best;
  if (is_turned(tet)) {
    attempt(tet, {}, Start::Lattice, best);
    if (!best.is_perfect()) try_labels(tet, Start::Lattice, best);
  }
  if (!best.found) try_labels(tet, Start::Here, best);
  if (!best.found) return false;
  for (const std::int64_t v : best.flips) flip(v);
  const Shell& shell = best.shell.shell;
  for (std::size_t v = 0; v < shell.V.size(); ++v) {
    if (shell.role[v] == Shell::Role::Fixed) continue;
    const auto at = static_cast<std::size_t>(moved_.add(best.shell.background_vertex[v]));
    moved_to_.resize(moved_.ids().size());
    moved_to_[at] = shell.V[v];
  }
  report_.flips += best.flips.size();
  look(best.shell);  // the patch may have bad tets that were not bad before; max_patches ends this
  return true;
}

/// Puts the tets of a shell that are below the target, or have a turned face, on the list, the worst first.
void Repair::look(const LatticeShell& cut) {
  const std::vector<Vec3>& V = cut.shell.V;
  const std::vector<Tet>& C = cut.shell.C;
  const std::vector<std::uint8_t> inside = inside_of(cut);
  std::vector<double> badness(C.size(), 1);
  std::atomic<std::size_t> evaluations = 0;
  // Nearly all tets are above the target, which takes no root to see.
  const double root = params_.target / kMeanRatioFactor, enough = (1 + 1e-12) * root * root * root;
  tbb::parallel_for(std::size_t{0}, C.size(), [&](std::size_t k) {
    const Tet& t = C[k];
    const Vec3 &p = V[t[0]], &q = V[t[1]], &r = V[t[2]], &s = V[t[3]];
    const double six = volume6(p, q, r, s), L = sum_of_squared_edges(p, q, r, s);
    if (!(six * std::abs(six) >= enough * (L * L * L))) badness[k] = mean_ratio(p, q, r, s);
    Triangle f;
    if (!positive_face(t, inside, f)) return;
    std::size_t n = 0;
    const double cosine = normal_cosine(psi_, V[f[0]], V[f[1]], V[f[2]], cut.shell.h, n);
    evaluations.fetch_add(n, std::memory_order_relaxed);
    if (cosine < kTurnedCosine) badness[k] = std::min(badness[k], cosine);
  });
  report_.psi_evaluations += evaluations;
  const std::size_t first = todo_.size();
  const auto& id = cut.background_vertex;
  for (std::size_t k = 0; k < C.size(); ++k) {
    const Tet& t = C[k];
    if (badness[k] < params_.target) todo_.push_back({badness[k], {id[t[0]], id[t[1]], id[t[2]], id[t[3]]}});
  }
  std::stable_sort(todo_.begin() + static_cast<std::ptrdiff_t>(first), todo_.end(),
                   [](const Bad& a, const Bad& b) { return a.badness < b.badness; });
}

RepairReport Repair::operator()(const KeepGoing& keep_going) {
  if (params_.max_tries > 0) look(shell_);
  report_.bad_before = todo_.size();
  for (std::size_t next = 0; next < todo_.size(); ++next) {
    poll(keep_going);
    const Ids tet = todo_[next].tet;
    // Where nothing helped, it would not help the tets that share a vertex either: they see the same labels.
    const bool hopeless = std::any_of(tet.begin(), tet.end(), [&](std::int64_t v) { return hopeless_.count(v) != 0; });
    while (!hopeless && still_bad(tet) && mend(tet)) {
    }
    if (!still_bad(tet)) continue;
    ++report_.given_up;
    if (!hopeless) hopeless_.insert(tet.begin(), tet.end());
  }
  for (std::size_t k = 0; k < moved_to_.size(); ++k) report_.moved.emplace_back(moved_.ids()[k], moved_to_[k]);
  std::sort(report_.moved.begin(), report_.moved.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  return std::move(report_);
}

}  // namespace

std::vector<std::string> problems(const RepairParams& params) {
  std::vector<std::string> list;
  const auto add = [&](const char* name, const std::string& value, const char* range) {
    list.push_back(std::string(name) + " = " + value + ": must be " + range);
  };
  if (!(params.target > 0 && params.target < 1)) add("target", std::to_string(params.target), "in (0, 1)");
  if (params.reach < 1) add("reach", std::to_string(params.reach), ">= 1");
  if (params.max_tries < 0) add("max_tries", std::to_string(params.max_tries), ">= 0");
  for (const std::string& problem : problems(params.projection)) list.push_back("projection." + problem);
  for (const std::string& problem : problems(params.smoothing)) list.push_back("smoothing." + problem);
  return list;
}

RepairReport repair(const BackgroundMesh& background, const std::vector<LinkTopology>& links, ImplicitFunctionRef psi,
                    const LabelParams& labels, const RepairParams& params, const LatticeShell& shell, IdSet& inside,
                    const KeepGoing& keep_going) {
  std::string all;
  for (const auto& list : {problems(labels), problems(params)}) {
    for (const std::string& problem : list) all += (all.empty() ? "" : "; ") + problem;
  }
  if (!all.empty()) throw std::invalid_argument(all);
  return Repair(background, links, psi, labels, params, shell, inside)(keep_going);
}

}  // namespace umtet
