#include "mesh/repair.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <map>
#include <set>
#include <span>
#include <stdexcept>

#include "mesh/detail/label_candidates.h"
#include "mesh/patch_state.h"
#include "mesh/tet_quality.h"

namespace umtet {
namespace {

using detail::IdSet;

// Pairs are tried from this many of the most promising labels, with this many second ones each.
constexpr std::size_t kFirstOfPair = 6, kSecondOfPair = 8;
// Besides max_patches: so many, and one for so many tets of the shell. A coarse perforated plate of 5092
// tets is mended by its 1724th patch, and no sooner known to be than lenses that never are: 1600 tets took 3000.
constexpr std::size_t kFewPatches = 600, kTetsPerPatch = 4;

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

  Vec3 place(std::int64_t v) const;
  bool is_turned(const Ids& tet);
  bool still_bad(const Ids& tet);
  void flip(std::int64_t v) { inside_.test(v) ? inside_.erase(v) : inside_.insert(v); }
  LatticeShell patch(const std::vector<std::int64_t>& centres, Start start) const;
  std::vector<std::uint8_t> inside_of(const LatticeShell& cut) const;
  PatchState state(const LatticeShell& cut);
  void attempt(const Ids& tet, std::span<const std::int64_t> flips, Start start, Best& best);
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
  std::map<std::int64_t, Vec3> moved_;
  std::set<std::int64_t> hopeless_;  ///< vertices of tets that nothing helped
  std::vector<Bad> todo_;
  RepairReport report_;
};

Vec3 Repair::place(std::int64_t v) const {
  if (const auto at = moved_.find(v); at != moved_.end()) return at->second;
  const auto& ids = shell_.background_vertex;
  const auto at = std::lower_bound(ids.begin(), ids.end(), v);
  return at != ids.end() && *at == v ? shell_.shell.V[at - ids.begin()] : background_.position(v);
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
  for (std::size_t v = 0; v < cut.shell.V.size(); ++v) {
    if (start == Start::Here || cut.shell.role[v] == Shell::Role::Fixed)
      cut.shell.V[v] = place(cut.background_vertex[v]);
  }
  return cut;
}

std::vector<std::uint8_t> Repair::inside_of(const LatticeShell& cut) const {
  std::vector<std::uint8_t> inside;
  for (const std::int64_t v : cut.background_vertex) inside.push_back(inside_.test(v));
  return inside;
}

PatchState Repair::state(const LatticeShell& cut) {
  return patch_state(cut.shell, inside_of(cut), psi_, params_.target, report_.psi_evaluations);
}

/// Flips these labels on a copy, shapes the patch around them and the tet, and keeps it as the best one if it is.
void Repair::attempt(const Ids& tet, std::span<const std::int64_t> flips, Start start, Best& best) {
  if (report_.tries >= most_patches_) return;
  ++report_.tries;
  std::vector<std::int64_t> centres(tet.begin(), tet.end());
  centres.insert(centres.end(), flips.begin(), flips.end());
  const PatchState before = state(patch(centres, Start::Here));
  for (const std::int64_t v : flips) flip(v);
  LatticeShell trial = patch(centres, start);
  const ProjectionReport projection = project(trial.shell, psi_, params_.projection);
  report_.psi_evaluations += projection.psi_evaluations;
  PatchState after;
  const bool arrived = projection.not_arrived.empty();
  if (arrived) {
    report_.psi_evaluations += smooth(trial.shell, psi_, params_.smoothing).psi_evaluations;
    after = state(trial);
  }
  for (const std::int64_t v : flips) flip(v);
  if (!arrived || !after.is_no_worse_than(before) || !after.is_better_than(before)) return;
  if (!best.found || after.is_better_than(best.state))
    best = {std::move(trial), after, {flips.begin(), flips.end()}, true};
}

void Repair::try_labels(const Ids& tet, Start start, Best& best) {
  const std::vector<detail::LabelCandidates::Candidate> singles = candidates_(tet, report_.psi_evaluations);
  for (const auto& c : singles) {
    attempt(tet, std::array{c.vertex}, start, best);
    if (best.is_perfect()) return;
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
    if (shell.role[v] != Shell::Role::Fixed) moved_[best.shell.background_vertex[v]] = shell.V[v];
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
  std::vector<double> badness(C.size());
  std::atomic<std::size_t> evaluations = 0;
  tbb::parallel_for(std::size_t{0}, C.size(), [&](std::size_t k) {
    const Tet& t = C[k];
    badness[k] = mean_ratio(V[t[0]], V[t[1]], V[t[2]], V[t[3]]);
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
  report_.moved.assign(moved_.begin(), moved_.end());
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
