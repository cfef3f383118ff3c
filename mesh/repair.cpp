#include "mesh/repair.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>
#include <span>
#include <stdexcept>

#include "mesh/tet_quality.h"

namespace umtet {
namespace {

using detail::IdSet;

// A flip that makes the labels around this much worse has never been kept: the price of one labelling not met in the
// fit and some more.
constexpr float kMostEnergy = 150;

// Pairs are tried from this many of the most promising labels, with this many second ones each.
constexpr std::size_t kFirstOfPair = 6, kSecondOfPair = 8;

struct State {
  double least = 1;
  std::size_t bad = 0;
};

class Repair {
 public:
  Repair(const BackgroundMesh& background, const std::vector<LinkTopology>& links, ImplicitFunctionRef psi,
         const LabelParams& labels, const RepairParams& params, const LatticeShell& shell, IdSet& inside)
      : background_(background),
        links_(links),
        psi_(psi),
        labels_(labels),
        params_(params),
        energies_(labels.energies ? *labels.energies : a15_label_energies()),
        shell_(shell),
        inside_(inside),
        steps_(background.n_types()) {
    for (int type = 0; type < background.n_types(); ++type) {
      for (const Tiling::Corner& c : background.tiling_tables().link[type])
        steps_[type].push_back(background.id_step(type, c));
    }
  }

  RepairReport operator()(const KeepGoing& keep_going);

 private:
  using Ids = std::array<std::int64_t, 4>;
  struct Best {
    LatticeShell shell;
    State state;
    std::vector<std::int64_t> flips;  ///< empty: nothing betters the patch
    bool is_perfect() const { return !flips.empty() && state.bad == 0; }
  };
  struct Bad {
    double quality;
    Ids tet;
  };
  struct Candidate {
    std::int64_t vertex;
    float energy;  ///< by which the flip changes the price of the labels around
  };

  std::uint16_t mask(std::int64_t v) const {
    unsigned mask = 0, k = 0;
    for (const std::int64_t step : steps_[background_.type(v)])
      mask |= static_cast<unsigned>(inside_.test_any(v + step)) << k++;
    return static_cast<std::uint16_t>(mask);
  }
  Vec3 place(std::int64_t v) const;
  bool still_bad(const Ids& tet) const;
  bool is_thin(const Vec3& foot, const Vec3& normal);
  bool in_reach(std::int64_t v);
  std::vector<Candidate> candidates(const Ids& tet);
  void flip(std::int64_t v) { inside_.test(v) ? inside_.erase(v) : inside_.insert(v); }
  LatticeShell patch(const std::vector<std::int64_t>& centres) const;
  State state(const Shell& shell) const;
  void attempt(const Ids& tet, std::span<const std::int64_t> flips, Best& best);
  bool mend(const Ids& tet);
  void look(const LatticeShell& cut);

  const BackgroundMesh& background_;
  const std::vector<LinkTopology>& links_;
  ImplicitFunctionRef psi_;
  const LabelParams& labels_;
  const RepairParams& params_;
  const LabelEnergies& energies_;
  const LatticeShell& shell_;
  IdSet& inside_;
  std::vector<std::vector<std::int64_t>> steps_;
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

bool Repair::still_bad(const Ids& tet) const {
  bool in_omega_h = false;
  for (const std::int64_t v : tet) in_omega_h |= inside_.test(v);
  return in_omega_h && mean_ratio(place(tet[0]), place(tet[1]), place(tet[2]), place(tet[3])) < params_.target;
}

/// As in choose_labels().
bool Repair::is_thin(const Vec3& foot, const Vec3& normal) {
  const int n_steps = static_cast<int>(std::ceil(2 * labels_.least_thickness));
  for (int side = -1; side <= 1; side += 2) {
    for (int s = 1; s <= n_steps; ++s) {
      const double t = labels_.least_thickness * s / n_steps * background_.h();
      ++report_.psi_evaluations;
      if ((psi_.value(foot + side * t * normal) < 0) != (side < 0)) return true;
    }
  }
  return false;
}

bool Repair::in_reach(std::int64_t v) {
  const Vec3 x = background_.position(v);
  const double h = background_.h();
  Vec3 g;
  const double value = psi_.value(x, g), norm = g.norm();
  ++report_.psi_evaluations;
  if (!(norm > 0)) return false;
  const double d = value / norm;
  if (!(d >= -labels_.reach_in * h && d <= params_.reach_out * h)) return false;
  return !(labels_.least_thickness > 0 && is_thin(x - d / norm * g, g / norm));
}

/// The labels around a tet that may change, the most promising first.
std::vector<Repair::Candidate> Repair::candidates(const Ids& tet) {
  std::vector<std::int64_t> near(tet.begin(), tet.end());
  for (const std::int64_t v : tet) {
    for (const std::int64_t step : steps_[background_.type(v)]) near.push_back(v + step);
  }
  std::sort(near.begin(), near.end());
  near.erase(std::unique(near.begin(), near.end()), near.end());
  std::vector<Candidate> list;
  for (const std::int64_t v : near) {
    if (v < 0 || v >= background_.n_vertices()) continue;  // beside a tet at the rim
    const int type = background_.type(v);
    const LinkTopology& link = links_[type];
    const std::uint16_t m = mask(v);
    if (!link.states[m].simple || background_.on_rim(v) || !in_reach(v)) continue;
    const auto price = [&](int t, std::uint16_t labels) { return labels == 0 ? 0.F : energies_[t][labels]; };
    const auto bad = [&](int t, std::uint16_t labels) { return labels != 0 && !links_[t].states[labels].manifold; };
    const bool is_inside = inside_.test(v);
    float energy = is_inside ? price(type, m) : -price(type, m);
    int spots = is_inside ? bad(type, m) : -bad(type, m);
    for (int k = 0; k < link.n; ++k) {
      const std::int64_t w = v + steps_[type][k];
      if (inside_.test(w)) continue;
      const int t = background_.type(w);
      const std::uint16_t now = mask(w), then = static_cast<std::uint16_t>(now ^ 1u << link.back[k]);
      energy += price(t, then) - price(t, now);
      spots += bad(t, then) - bad(t, now);
    }
    if (spots <= 0 && energy < kMostEnergy) list.push_back({v, energy});
  }
  std::stable_sort(list.begin(), list.end(), [](const auto& a, const auto& b) { return a.energy < b.energy; });
  if (list.size() > static_cast<std::size_t>(params_.max_tries)) list.resize(params_.max_tries);
  return list;
}

LatticeShell Repair::patch(const std::vector<std::int64_t>& centres) const {
  LatticeShell cut = lattice_patch(background_, links_, inside_, centres, params_.reach);
  for (std::size_t v = 0; v < cut.shell.V.size(); ++v) cut.shell.V[v] = place(cut.background_vertex[v]);
  return cut;
}

State Repair::state(const Shell& shell) const {
  State s;
  for (const Tet& t : shell.C) {
    const double q = mean_ratio(shell.V[t[0]], shell.V[t[1]], shell.V[t[2]], shell.V[t[3]]);
    s.least = std::min(s.least, q);
    s.bad += q < params_.target;
  }
  return s;
}

/// Flips these labels on a copy, shapes the patch around them and the tet, and keeps it as the best one if it is.
void Repair::attempt(const Ids& tet, std::span<const std::int64_t> flips, Best& best) {
  if (report_.tries >= params_.max_patches) return;
  ++report_.tries;
  std::vector<std::int64_t> centres(tet.begin(), tet.end());
  centres.insert(centres.end(), flips.begin(), flips.end());
  const State before = state(patch(centres).shell);
  for (const std::int64_t v : flips) flip(v);
  LatticeShell trial = patch(centres);
  const ProjectionReport projection = project(trial.shell, psi_, params_.projection);
  report_.psi_evaluations += projection.psi_evaluations;
  State after{-1, 0};
  if (projection.not_arrived.empty()) {
    report_.psi_evaluations += smooth(trial.shell, psi_, params_.smoothing).psi_evaluations;
    after = state(trial.shell);
  }
  for (const std::int64_t v : flips) flip(v);
  const bool no_worse = after.least >= before.least && after.bad <= before.bad;
  if (!no_worse || (after.least == before.least && after.bad == before.bad)) return;
  const bool better = best.flips.empty() || after.bad < best.state.bad ||
                      (after.bad == best.state.bad && after.least > best.state.least);
  if (better) best = {std::move(trial), after, {flips.begin(), flips.end()}};
}

bool Repair::mend(const Ids& tet) {
  Best best;
  const std::vector<Candidate> singles = candidates(tet);
  for (const Candidate& c : singles) {
    attempt(tet, std::array{c.vertex}, best);
    if (best.is_perfect()) break;
  }
  // Pairs cost as many patches as all singles do, and are for where none of these helps.
  for (std::size_t a = 0; a < std::min(singles.size(), kFirstOfPair) && best.flips.empty(); ++a) {
    flip(singles[a].vertex);
    const std::vector<Candidate> seconds = candidates(tet);
    flip(singles[a].vertex);
    for (std::size_t b = 0; b < std::min(seconds.size(), kSecondOfPair) && !best.is_perfect(); ++b) {
      if (seconds[b].vertex != singles[a].vertex) attempt(tet, std::array{singles[a].vertex, seconds[b].vertex}, best);
    }
  }
  if (best.flips.empty()) return false;
  for (const std::int64_t v : best.flips) flip(v);
  const Shell& shell = best.shell.shell;
  for (std::size_t v = 0; v < shell.V.size(); ++v) {
    if (shell.role[v] != Shell::Role::Fixed) moved_[best.shell.background_vertex[v]] = shell.V[v];
  }
  report_.flips += best.flips.size();
  look(best.shell);  // the patch may have bad tets that were not bad before; max_patches ends this
  return true;
}

/// Puts the tets of a shell that are below the target on the list, the worst first.
void Repair::look(const LatticeShell& cut) {
  const std::size_t first = todo_.size();
  for (const Tet& t : cut.shell.C) {
    const auto& V = cut.shell.V;
    const double q = mean_ratio(V[t[0]], V[t[1]], V[t[2]], V[t[3]]);
    if (q >= params_.target) continue;
    const auto& id = cut.background_vertex;
    todo_.push_back({q, {id[t[0]], id[t[1]], id[t[2]], id[t[3]]}});
  }
  std::stable_sort(todo_.begin() + static_cast<std::ptrdiff_t>(first), todo_.end(),
                   [](const Bad& a, const Bad& b) { return a.quality < b.quality; });
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
