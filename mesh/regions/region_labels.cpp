#include "mesh/regions/region_labels.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <random>
#include <stdexcept>

#include "common/polled_loops.h"
#include "mesh/base/id_blocks.h"
#include "mesh/base/id_set.h"
#include "mesh/regions/detail/label_band.h"
#include "mesh/regions/detail/label_costs.h"
#include "mesh/submesh/assemble_submesh.h"

namespace umtet {
namespace {

constexpr double kLeastGain = 1e-6;  // less is rounding
constexpr std::size_t kVerticesPerPoll = 1 << 10;
constexpr double kLastTemperature = .02;  // the cost of a distance of .45 edges
constexpr std::uint32_t kSeed = 1;
// With a greater share of bad vertices a body is too coarse as a whole, and no search helps.
constexpr double kMostBad = .05;
constexpr std::size_t kFewBad = 200;
constexpr int kFewestSweeps = 30;
constexpr int kMostFailures = 2;   // of annealing around a vertex: it is random
constexpr int kAnnealedRings = 2;  // three find no more, in twice the time

/// The search for labels of low cost in a band.
class LabelSearch {
 public:
  LabelSearch(detail::LabelCosts& costs, const RegionLabelParams& params)
      : costs_(costs),
        band_(costs.band()),
        params_(params),
        open_(costs.size(), 0),
        n_failures_(costs.size(), 0),
        random_(kSeed) {}

  void operator()(const Context& context, RegionLabels& report) {
    report.n_invalid_at_start = count_invalid();
    open_around_bad(1);
    change_singles(context, report);
    for (int round = 0; round < params_.pair_rounds && !bad_vertices().empty(); ++round) {
      const std::size_t before = report.n_changes;
      open_around_bad(2);
      change_pairs(context, report);
      change_singles(context, report);
      if (report.n_changes == before) break;
    }
    for (int round = 0; round < params_.annealing_rounds; ++round) {
      const std::size_t before = report.n_changes;
      const std::vector<int> bad = bad_vertices();
      if (static_cast<double>(bad.size()) > kMostBad * static_cast<double>(count_interface())) break;
      const int sweeps = sweeps_for(bad.size());
      for (const int v : bad)
        if (is_bad(v) && n_failures_[v] < kMostFailures && !anneal_around(v, sweeps, context, report)) ++n_failures_[v];
      if (report.n_changes == before) break;
      open_around_bad(1);
      change_singles(context, report);
    }
    report.n_interface = count_interface();
    for (std::size_t v = 0; v < costs_.size(); ++v) {
      const RegionSet regions = costs_.regions(static_cast<int>(v));
      if (std::popcount(regions) < 2) continue;
      if (!costs_.is_valid(static_cast<int>(v))) report.invalid.push_back({band_.id(v), regions});
    }
  }

 private:
  bool is_bad(std::size_t v) const { return costs_.cost(static_cast<int>(v)) >= params_.bad_cost; }

  /// Many bad vertices share the sweeps of kFewBad.
  int sweeps_for(std::size_t n_bad) const {
    const std::size_t share = static_cast<std::size_t>(params_.annealing_sweeps) * kFewBad / std::max(n_bad, kFewBad);
    return std::max(static_cast<int>(share), std::min(kFewestSweeps, params_.annealing_sweeps));
  }

  std::size_t count_interface() const {
    std::size_t n = 0;
    for (std::size_t v = 0; v < costs_.size(); ++v) n += std::popcount(costs_.regions(static_cast<int>(v))) > 1 ? 1 : 0;
    return n;
  }

  std::size_t count_invalid() const {
    std::size_t n = 0;
    for (std::size_t v = 0; v < costs_.size(); ++v)
      n += std::popcount(costs_.regions(static_cast<int>(v))) > 1 && !costs_.is_valid(static_cast<int>(v)) ? 1 : 0;
    return n;
  }

  std::vector<int> bad_vertices() const {
    std::vector<int> bad;
    for (std::size_t v = 0; v < costs_.size(); ++v)
      if (is_bad(v)) bad.push_back(static_cast<int>(v));
    return bad;
  }

  /// Opens the vertices within some rings of a bad one.
  void open_around_bad(int rings) {
    std::vector<int> front = bad_vertices();
    for (const int v : front) open_[v] = 1;
    for (int ring = 0; ring < rings; ++ring) {
      std::vector<int> next;
      for (const int v : front)
        for (const int w : band_.link(v))
          if (w >= 0 && open_[w] == 0) open_[w] = 1, next.push_back(w);
      front = std::move(next);
    }
  }

  struct Change {
    int vertex = -1;
    std::uint8_t label = 0;
    double gain = 0;
  };
  /// Replaces `best` by a change of v that gains more.
  void improve(int v, double before, Change& best) {
    const std::uint8_t own = band_.label[v];
    for (RegionSet labels = costs_.other_labels(v); labels != 0; labels &= labels - 1) {
      const auto label = static_cast<std::uint8_t>(std::countr_zero(labels));
      if (!costs_.is_simple(v, label)) continue;
      const double gain = before - costs_.set(v, label);
      if (gain > best.gain) best = {v, label, gain};
      costs_.set(v, own);
    }
  }

  void keep(int v, std::uint8_t label) {
    costs_.set(v, label);
    for (const int c : std::vector<int>(costs_.changed()))
      for (const int u : band_.link(c))
        if (u >= 0 && is_bad(u)) {
          open_[u] = 1;
          for (const int w : band_.link(u))
            if (w >= 0) open_[w] = 1;
        }
  }

  void change_singles(const Context& context, RegionLabels& report) {
    for (int sweep = 0; sweep < params_.max_sweeps; ++sweep) {
      std::size_t n = 0;
      for (std::size_t v = 0; v < band_.size(); ++v) {
        if (v % kVerticesPerPoll == 0) context.poll();
        if (open_[v] == 0) continue;
        open_[v] = 0;
        if (!band_.is_movable[v]) continue;
        Change best{.gain = kLeastGain};
        improve(static_cast<int>(v), 0, best);
        if (best.vertex < 0) continue;
        keep(best.vertex, best.label);
        ++n;
      }
      report.n_changes += n;
      if (n == 0) return;
    }
  }

  void change_pairs(const Context& context, RegionLabels& report) {
    for (std::size_t at = 0; at < band_.size(); ++at) {
      if (at % kVerticesPerPoll == 0) context.poll();
      if (open_[at] == 0) continue;
      open_[at] = 0;
      const auto v = static_cast<int>(at);
      if (!band_.is_movable[v]) continue;
      const std::uint8_t own = band_.label[v];
      Change best{.gain = kLeastGain};
      std::uint8_t first = own;
      for (RegionSet labels = costs_.other_labels(v); labels != 0; labels &= labels - 1) {
        const auto label = static_cast<std::uint8_t>(std::countr_zero(labels));
        if (!costs_.is_simple(v, label)) continue;
        const double gain = -costs_.set(v, label);
        for (const int w : band_.link(v)) {
          if (w < 0 || !band_.is_movable[w]) continue;
          const double least = best.gain;
          improve(w, gain, best);
          if (best.gain > least) first = label;
        }
        costs_.set(v, own);
      }
      if (best.vertex < 0) continue;
      keep(v, first);
      keep(best.vertex, best.label);
      report.n_changes += 2;
    }
  }

  /// The vertices within two rings whose labels may change.
  std::vector<int> movable_around(int centre) const {
    std::vector<int> ball = {centre};
    std::size_t first = 0;
    for (int ring = 0; ring < kAnnealedRings; ++ring) {
      const std::size_t end = ball.size();
      for (; first < end; ++first)
        for (const int w : band_.link(ball[first]))
          if (w >= 0 && std::find(ball.begin(), ball.end(), w) == ball.end()) ball.push_back(w);
    }
    std::erase_if(ball, [&](int v) { return band_.is_movable[v] == 0; });
    return ball;
  }

  /// A random label of the neighbours of v, as Metropolis's rule takes it. @return the change of the cost
  double try_random_label(int v, double temperature) {
    RegionSet labels = costs_.other_labels(v);
    if (labels == 0) return 0;
    for (auto skip = random_() % static_cast<unsigned>(std::popcount(labels)); skip > 0; --skip) labels &= labels - 1;
    const auto label = static_cast<std::uint8_t>(std::countr_zero(labels));
    if (!costs_.is_simple(v, label)) return 0;
    const std::uint8_t own = band_.label[v];
    const double change = costs_.set(v, label);
    const double uniform = static_cast<double>(random_()) / std::mt19937::max();
    if (change <= 0 || uniform < std::exp(-change / temperature)) return change;
    costs_.set(v, own);
    return 0;
  }

  /// Simulated annealing of the labels around a bad vertex. The best labels that it meets are kept.
  /// @return whether they cost less than before
  bool anneal_around(int centre, int sweeps, const Context& context, RegionLabels& report) {
    context.poll();
    const std::vector<int> ball = movable_around(centre);
    if (ball.empty()) return false;
    std::vector<std::uint8_t> start(ball.size());
    const auto read = [&](std::vector<std::uint8_t>& labels) {
      for (std::size_t k = 0; k < ball.size(); ++k) labels[k] = band_.label[ball[k]];
    };
    read(start);
    std::vector<std::uint8_t> best = start;
    double now = 0, least = -kLeastGain;
    const double cooling = std::pow(kLastTemperature / params_.temperature, 1. / sweeps);
    double temperature = params_.temperature;
    for (int sweep = 0; sweep < sweeps; ++sweep, temperature *= cooling)
      for (std::size_t k = 0; k < ball.size(); ++k) {
        const double change = try_random_label(ball[random_() % ball.size()], temperature);
        now += change;
        if (now >= least || change >= 0) continue;
        least = now;
        read(best);
      }
    for (std::size_t k = 0; k < ball.size(); ++k) {
      if (best[k] != band_.label[ball[k]]) costs_.set(ball[k], best[k]);
      report.n_changes += best[k] != start[k] ? 1 : 0;
    }
    return least < -kLeastGain;
  }

  detail::LabelCosts& costs_;
  const detail::LabelBand& band_;
  const RegionLabelParams& params_;
  std::vector<std::uint8_t> open_;        ///< a change may lower the cost
  std::vector<std::uint8_t> n_failures_;  ///< of annealing around each vertex
  std::mt19937 random_;
};

}  // namespace

std::vector<std::string> problems(const RegionLabelParams& params) {
  std::vector<std::string> list;
  if (!(params.shift >= 0 && params.shift <= 1)) list.emplace_back("shift must be in 0 .. 1");
  if (!(params.reach > 0)) list.emplace_back("reach must be > 0");
  if (!(params.distance_weight >= 0)) list.emplace_back("distance_weight must be >= 0");
  if (params.max_sweeps < 0) list.emplace_back("max_sweeps must be >= 0");
  if (params.pair_rounds < 0) list.emplace_back("pair_rounds must be >= 0");
  if (!(params.poor_quality >= 0 && params.poor_quality < 1)) list.emplace_back("poor_quality must be in 0 .. 1");
  if (!(params.bad_cost > 0)) list.emplace_back("bad_cost must be > 0");
  if (params.annealing_rounds < 0) list.emplace_back("annealing_rounds must be >= 0");
  if (params.annealing_sweeps < 1) list.emplace_back("annealing_sweeps must be >= 1");
  if (!(params.temperature > 0)) list.emplace_back("temperature must be > 0");
  return list;
}

RegionLabels choose_labels(const RegionDomain& domain, const BackgroundMesh& background, const VertexLinks& links,
                           const RegionLabelParams& params, const Context& context,
                           const detail::PeriodicCells* cells) {
  std::string all;
  for (const std::string& problem : problems(params)) all += (all.empty() ? "" : "; ") + problem;
  if (!all.empty()) throw std::invalid_argument(all);
  RegionLabels chosen;
  chosen.of_vertex = detail::regions_of_vertices(domain, background, chosen.n_psi_evaluations, context);
  detail::LabelBand band(domain, background, links, chosen.of_vertex, params.reach, cells, context);
  chosen.leaves_background = band.leaves_background();
  if (chosen.leaves_background) return chosen;
  chosen.n_psi_evaluations += band.n_psi_evaluations();
  band.shrink(params.shift);
  detail::LabelCosts costs(domain, band, params);
  LabelSearch search(costs, params);
  search(context, chosen);
  for (std::size_t v = 0; v < band.size(); ++v) chosen.of_vertex[static_cast<std::size_t>(band.id(v))] = band.label[v];
  return chosen;
}

}  // namespace umtet
