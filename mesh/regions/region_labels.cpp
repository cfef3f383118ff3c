#include "mesh/regions/region_labels.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "common/polled_loops.h"
#include "mesh/base/id_blocks.h"
#include "mesh/base/id_set.h"
#include "mesh/regions/detail/label_band.h"
#include "mesh/submesh/assemble_submesh.h"

namespace umtet {
namespace {

constexpr double kLeastGain = 1e-6;  // less is rounding
constexpr std::size_t kVerticesPerPoll = 1 << 10;

/// Iterated conditional modes on the labels of a band.
class LabelSearch {
 public:
  LabelSearch(detail::LabelBand& band, const RegionLabelParams& params) : band_(band), params_(params) {
    const std::size_t n = band_.size();
    regions_.resize(n);
    for (std::size_t v = 0; v < n; ++v) regions_[v] = regions_around(static_cast<int>(v));
    cost_.resize(n);
    for (std::size_t v = 0; v < n; ++v) cost_[v] = cost_of(static_cast<int>(v));
    seen_.assign(n, 0);
    open_.assign(n, 0);
  }

  void operator()(const Context& context, RegionLabels& report) {
    report.n_invalid_at_start = count_invalid();
    open_around_invalid(1);
    change_singles(context, report);
    for (int round = 0; round < params_.pair_rounds && count_invalid() > 0; ++round) {
      const std::size_t before = report.n_changes;
      open_around_invalid(2);
      change_pairs(context, report);
      change_singles(context, report);
      if (report.n_changes == before) break;
    }
    for (std::size_t v = 0; v < band_.size(); ++v) {
      if (std::popcount(regions_[v]) < 2) continue;
      ++report.n_interface;
      if (!is_valid(static_cast<int>(v))) report.invalid.push_back({band_.id(v), regions_[v]});
    }
  }

 private:
  RegionSet regions_at(int code) const {
    return code >= 0 ? regions_[code] : RegionSet{1} << detail::LabelBand::label_beyond(code);
  }

  /// M(v).
  RegionSet regions_around(int v) const {
    const LinkTopology& link = band_.topology(v);
    std::array<std::uint8_t, kMaxLink> label;
    const std::uint8_t own = band_.label[v];
    bool is_uniform = true;
    for (int k = 0; k < link.n; ++k) {
      label[k] = std::max(own, band_.label_at(band_.link(v)[k]));
      is_uniform = is_uniform && label[k] == label[0];
    }
    if (is_uniform) return RegionSet{1} << (link.n > 0 ? label[0] : own);
    RegionSet regions = 0;
    for (const auto& t : link.triangles) regions |= RegionSet{1} << std::max({label[t[0]], label[t[1]], label[t[2]]});
    return regions;
  }

  bool is_valid(int v) const {
    const LinkTopology& link = band_.topology(v);
    const int n = std::popcount(regions_[v]);
    std::array<LinkMask, kMostRegions> of_region;  // the link vertices at a region, for each member of M(v)
    LinkMask once = 0, twice = 0, junctions = 0;   // at one, two, three regions or more
    int m = 0;
    for (RegionSet rest = regions_[v]; rest != 0; rest &= rest - 1, ++m) {
      LinkMask mask = 0;
      for (int k = 0; k < link.n; ++k) mask |= (regions_at(band_.link(v)[k]) >> std::countr_zero(rest) & 1) << k;
      of_region[m] = mask;
      junctions |= twice & mask;
      twice |= once & mask;
      once |= mask;
    }
    if (n == 3 && std::popcount(junctions) != 2) return false;
    for (int a = 1; a < n; ++a)
      for (int b = 0; b < a; ++b)
        if (!is_line(link, of_region[a] & of_region[b], junctions, n)) return false;
    return true;
  }

  /// Whether these vertices of a link are those of one sheet around a vertex of n regions: a cycle without chords, or a
  /// path without chords between two junctions.
  static bool is_line(const LinkTopology& link, LinkMask line, LinkMask junctions, int n) {
    if (line == 0) return n > 3;  // not every two regions at a corner meet
    if (n == 2 && std::popcount(line) < 4) return false;
    for (LinkMask bits = line; bits != 0; bits &= bits - 1) {
      const int k = std::countr_zero(bits);
      if (std::popcount(link.adjacent[k] & line) != ((junctions >> k & 1) != 0 ? 1 : 2)) return false;
    }
    return n > 3 || link.is_connected(line);
  }

  double cost_of(int v) const {
    const RegionSet own = regions_[v];
    if (std::popcount(own) < 2) return 0;
    double cost = is_valid(v) ? 0 : 1;
    const int lowest = std::countr_zero(own);
    for (RegionSet rest = own & (own - 1); rest != 0; rest &= rest - 1) {
      const double d = band_.distance(v, std::countr_zero(rest), lowest);
      cost += params_.distance_weight * d * d;
    }
    return cost;
  }

  std::size_t count_invalid() const {
    return static_cast<std::size_t>(std::count_if(cost_.begin(), cost_.end(), [](double c) { return c >= 1; }));
  }

  /// Opens the vertices within some rings of one that is not valid.
  void open_around_invalid(int rings) {
    std::vector<int> front;
    for (std::size_t v = 0; v < band_.size(); ++v)
      if (cost_[v] >= 1) front.push_back(static_cast<int>(v));
    for (const int v : front) open_[v] = 1;
    for (int ring = 0; ring < rings; ++ring) {
      std::vector<int> next;
      for (const int v : front)
        for (const int w : band_.link(v))
          if (w >= 0 && open_[w] == 0) open_[w] = 1, next.push_back(w);
      front = std::move(next);
    }
  }

  /// Whether {label >= k} keeps its topology for each k, if v gets another label.
  bool is_simple(int v, std::uint8_t label) const {
    const std::uint8_t low = std::min(label, band_.label[v]), high = std::max(label, band_.label[v]);
    const LinkTopology& link = band_.topology(v);
    LinkMask last = 0;
    for (int k = low + 1; k <= high; ++k) {
      LinkMask mask = 0;
      for (int i = 0; i < link.n; ++i)
        mask |= static_cast<LinkMask>(band_.label_at(band_.link(v)[i]) >= k ? 1 : 0) << i;
      if (k > low + 1 && mask == last) continue;
      if (!link.state(mask).simple) return false;
      last = mask;
    }
    return true;
  }

  /// Sets a label, and what follows from it. @return the change of the cost
  double set(int v, std::uint8_t label) {
    band_.label[v] = label;
    changed_.clear();
    const auto renew = [&](int u) {
      const RegionSet now = regions_around(u);
      if (now == regions_[u]) return;
      regions_[u] = now;
      changed_.push_back(u);
    };
    renew(v);
    for (const int u : band_.link(v))
      if (u >= 0) renew(u);
    ++stamp_;
    double change = 0;
    const auto measure = [&](int u) {
      if (u < 0 || seen_[u] == stamp_) return;
      seen_[u] = stamp_;
      const double now = cost_of(u);
      change += now - cost_[u];
      cost_[u] = now;
    };
    for (const int c : changed_) {
      measure(c);
      for (const int u : band_.link(c)) measure(u);
    }
    return change;
  }

  /// The labels of the neighbours, without the own one.
  RegionSet other_labels(int v) const {
    RegionSet labels = 0;
    for (const int u : band_.link(v)) labels |= RegionSet{1} << band_.label_at(u);
    return labels & ~(RegionSet{1} << band_.label[v]);
  }

  struct Change {
    int vertex = -1;
    std::uint8_t label = 0;
    double gain = 0;
  };
  /// Replaces `best` by a change of v that gains more.
  void improve(int v, double before, Change& best) {
    const std::uint8_t own = band_.label[v];
    for (RegionSet labels = other_labels(v); labels != 0; labels &= labels - 1) {
      const auto label = static_cast<std::uint8_t>(std::countr_zero(labels));
      if (!is_simple(v, label)) continue;
      const double gain = before - set(v, label);
      if (gain > best.gain) best = {v, label, gain};
      set(v, own);
    }
  }

  void keep(int v, std::uint8_t label) {
    set(v, label);
    for (const int c : std::vector<int>(changed_))
      for (const int u : band_.link(c))
        if (u >= 0 && cost_[u] >= 1) {
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
      for (RegionSet labels = other_labels(v); labels != 0; labels &= labels - 1) {
        const auto label = static_cast<std::uint8_t>(std::countr_zero(labels));
        if (!is_simple(v, label)) continue;
        const double gain = -set(v, label);
        for (const int w : band_.link(v)) {
          if (w < 0 || !band_.is_movable[w]) continue;
          const double least = best.gain;
          improve(w, gain, best);
          if (best.gain > least) first = label;
        }
        set(v, own);
      }
      if (best.vertex < 0) continue;
      keep(v, first);
      keep(best.vertex, best.label);
      report.n_changes += 2;
    }
  }

  detail::LabelBand& band_;
  const RegionLabelParams& params_;
  std::vector<RegionSet> regions_;  ///< M(v)
  std::vector<double> cost_;
  std::vector<std::uint8_t> open_;  ///< a change may lower the cost
  std::vector<int> changed_;        ///< by the last set()
  std::vector<int> seen_;
  int stamp_ = 0;
};

}  // namespace

std::vector<std::string> problems(const RegionLabelParams& params) {
  std::vector<std::string> list;
  if (!(params.shift >= 0 && params.shift <= 1)) list.emplace_back("shift must be in 0 .. 1");
  if (!(params.reach > 0)) list.emplace_back("reach must be > 0");
  if (!(params.distance_weight >= 0)) list.emplace_back("distance_weight must be >= 0");
  if (params.max_sweeps < 0) list.emplace_back("max_sweeps must be >= 0");
  if (params.pair_rounds < 0) list.emplace_back("pair_rounds must be >= 0");
  return list;
}

RegionLabels choose_labels(const RegionDomain& domain, const BackgroundMesh& background, const VertexLinks& links,
                           const RegionLabelParams& params, const Context& context) {
  std::string all;
  for (const std::string& problem : problems(params)) all += (all.empty() ? "" : "; ") + problem;
  if (!all.empty()) throw std::invalid_argument(all);
  RegionLabels chosen;
  chosen.of_vertex = detail::regions_of_vertices(domain, background, chosen.n_psi_evaluations, context);
  detail::LabelBand band(domain, background, links, chosen.of_vertex, params.reach, context);
  chosen.leaves_background = band.leaves_background();
  if (chosen.leaves_background) return chosen;
  chosen.n_psi_evaluations += band.n_psi_evaluations();
  band.shrink(params.shift);
  LabelSearch search(band, params);
  search(context, chosen);
  for (std::size_t v = 0; v < band.size(); ++v) chosen.of_vertex[static_cast<std::size_t>(band.id(v))] = band.label[v];
  return chosen;
}

}  // namespace umtet
