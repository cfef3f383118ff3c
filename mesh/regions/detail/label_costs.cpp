#include "mesh/regions/detail/label_costs.h"

#include <algorithm>
#include <bit>

#include "mesh/core/tet_quality.h"

namespace umtet::detail {
namespace {

/// Whether these vertices of a link are those of one sheet around a vertex of n regions: a cycle without chords, or a
/// path without chords between two junctions.
bool is_line(const LinkTopology& link, LinkMask line, LinkMask junctions, int n) {
  if (line == 0) return n > 3;  // not every two regions at a corner meet
  if (n == 2 && std::popcount(line) < 4) return false;
  for (LinkMask bits = line; bits != 0; bits &= bits - 1) {
    const int k = std::countr_zero(bits);
    if (std::popcount(link.adjacent[k] & line) != ((junctions >> k & 1) != 0 ? 1 : 2)) return false;
  }
  return n > 3 || link.is_connected(line);
}

}  // namespace

LabelCosts::LabelCosts(const RegionDomain& domain, LabelBand& band, const RegionLabelParams& params)
    : band_(band),
      params_(params),
      places_(domain, band.size()),
      regions_(band.size()),
      cost_(band.size()),
      seen_(band.size(), 0) {
  for (std::size_t v = 0; v < size(); ++v) regions_[v] = regions_around(static_cast<int>(v));
  for (std::size_t v = 0; v < size(); ++v) cost_[v] = cost_of(static_cast<int>(v));
}

RegionSet LabelCosts::regions_at(int code) const {
  return code >= 0 ? regions_[code] : RegionSet{1} << LabelBand::label_beyond(code);
}

RegionSet LabelCosts::regions_around(int v) const {
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

bool LabelCosts::is_valid(int v) const {
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

Vec3 LabelCosts::place(int v) { return places_.at(v, regions_[v], band_.position(v), band_.h(v)); }

/// Of the tets around a vertex on a curve or at a corner, with each vertex on its stratum.
double LabelCosts::cost_of_tets(int v) {
  const LinkTopology& link = band_.topology(v);
  std::array<Vec3, kMaxLink> corner;
  for (int k = 0; k < link.n; ++k) {
    const int w = band_.link(v)[k];
    if (w < 0) return 0;
    corner[k] = place(w) + band_.to_copy(v, k);
  }
  const Vec3 centre = place(v);
  double cost = 0;
  // Q < poor where volume6^2 < (poor sum / factor)^3: the root is left for those few.
  const double of_sum = params_.poor_quality / kMeanRatioFactor;
  for (const auto& t : link.triangles) {
    const Vec3 &a = corner[t[0]], &b = corner[t[1]], &c = corner[t[2]];
    const double volume = volume6(centre, a, b, c), bound = of_sum * sum_of_squared_edges(centre, a, b, c);
    if (volume > 0 && volume * volume >= bound * bound * bound) continue;
    const double lack = 1 - mean_ratio(centre, a, b, c) / params_.poor_quality;
    cost += lack * lack;
  }
  return cost;
}

double LabelCosts::cost_of(int v) {
  const RegionSet own = regions_[v];
  if (std::popcount(own) < 2) return 0;
  double cost = is_valid(v) ? 0 : 1;
  const int lowest = std::countr_zero(own);
  for (RegionSet rest = own & (own - 1); rest != 0; rest &= rest - 1) {
    const double d = band_.distance(v, std::countr_zero(rest), lowest);
    cost += params_.distance_weight * d * d;
  }
  if (std::popcount(own) > 2 && params_.poor_quality > 0) cost += cost_of_tets(v);
  return cost;
}

RegionSet LabelCosts::other_labels(int v) const {
  RegionSet labels = 0;
  for (const int u : band_.link(v)) labels |= RegionSet{1} << band_.label_at(u);
  return labels & ~(RegionSet{1} << band_.label[v]);
}

bool LabelCosts::is_simple(int v, std::uint8_t label) const {
  const std::uint8_t low = std::min(label, band_.label[v]), high = std::max(label, band_.label[v]);
  const LinkTopology& link = band_.topology(v);
  LinkMask last = 0;
  for (int k = low + 1; k <= high; ++k) {
    LinkMask mask = 0;
    for (int i = 0; i < link.n; ++i) mask |= static_cast<LinkMask>(band_.label_at(band_.link(v)[i]) >= k ? 1 : 0) << i;
    if (k > low + 1 && mask == last) continue;
    if (!link.state(mask).simple) return false;
    last = mask;
  }
  return true;
}

double LabelCosts::set(int v, std::uint8_t label) {
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

}  // namespace umtet::detail
