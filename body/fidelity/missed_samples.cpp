#include "body/fidelity/missed_samples.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "body/pieces/zero_set_choice.h"
#include "common/disjoint_sets.h"
#include "mesh/certify/quality_report.h"
#include "reconstruct/cloud/cloud_arrays.h"
#include "reconstruct/cloud/neighbours/neighbour_tree.h"

namespace umtet {
namespace {

double rms(const std::vector<double>& d) {
  return std::sqrt(std::transform_reduce(d.begin(), d.end(), 0., std::plus<>(), [](double v) { return v * v; }) /
                   static_cast<double>(d.size()));
}

/// Each value as often as it counts.
double rms(const std::vector<double>& d, const std::vector<int>& counts) {
  double sum = 0, n = 0;
  for (std::size_t i = 0; i < d.size(); ++i) {
    sum += counts[i] * d[i] * d[i];
    n += counts[i];
  }
  return std::sqrt(sum / n);
}

double counted_quantile(const std::vector<double>& d, const std::vector<int>& counts, double p) {
  std::vector<std::pair<double, int>> rows(d.size());
  for (std::size_t i = 0; i < d.size(); ++i) rows[i] = {d[i], counts[i]};
  std::sort(rows.begin(), rows.end());
  const double wanted = p * std::accumulate(counts.begin(), counts.end(), 0.);
  double below = 0;
  for (const auto& [value, count] : rows) {
    if ((below += count) >= wanted) return value;
  }
  return rows.back().first;
}

/// Of the samples farther than `beyond` of each, in working coordinates; the farthest first.
std::vector<MissedPlace> missed_places(const Domain& domain, const std::vector<double>& d,
                                       const std::vector<double>& beyond) {
  std::vector<Vec3> points;
  std::vector<double> distance;
  for (std::size_t i = 0; i < d.size(); ++i) {
    if (d[i] <= beyond[i]) continue;
    points.push_back(domain.cloud.points[i]);
    distance.push_back(d[i]);
  }
  if (points.size() < kFewestMissed) return {};
  const NeighbourTree tree(points);
  const double reach = support_radius(domain);
  DisjointSets sets(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    tree.within(points[i], reach * reach,
                [&](std::uint32_t j, double) { sets.unite(static_cast<int>(i), static_cast<int>(j)); });
  }
  std::map<int, MissedPlace> found;
  for (std::size_t i = 0; i < points.size(); ++i) {
    MissedPlace& place = found[sets.find(static_cast<int>(i))];
    ++place.n_samples;
    if (distance[i] <= place.distance) continue;
    place.distance = distance[i];
    place.farthest = points[i];
  }
  std::vector<MissedPlace> places;
  for (const auto& [set, place] : found) {
    if (place.n_samples >= kFewestMissed) places.push_back(place);
  }
  std::stable_sort(places.begin(), places.end(),
                   [](const MissedPlace& a, const MissedPlace& b) { return a.distance > b.distance; });
  return places;
}

}  // namespace

std::vector<double> before_merging(const OrientedPointCloud& cloud, std::vector<double> d) {
  for (std::size_t i = 0; i < cloud.spreads.size(); ++i) d[i] = std::hypot(d[i], cloud.spreads[i]);
  return d;
}

SampleDistances sample_distances(const Domain& domain, const std::vector<double>& d, const MeshEdge& h,
                                 double flatness_over_h) {
  SampleDistances s;
  std::vector<double> sorted = d;
  std::sort(sorted.begin(), sorted.end());
  s.noise = domain.noise;
  const std::vector<int>& counts = domain.cloud.counts;
  if (!counts.empty()) s.n_merged = std::accumulate(counts.begin(), counts.end(), std::size_t{0});
  s.rms = counts.empty() ? rms(sorted) : rms(d, counts);
  s.max = sorted.back();
  s.p99 = counts.empty() ? quantile(sorted, .99) : counted_quantile(d, counts, .99);
  const double of_noise = kNoisesMissed * domain.noise.value_or(0);
  std::vector<double> beyond = h.at(domain.cloud.points), over_h = std::move(sorted);
  double explained2 = 0;
  for (std::size_t i = 0; i < d.size(); ++i) {
    const double h_at = beyond[i], explained = std::max(of_noise, flatness_over_h * h_at);
    beyond[i] = std::min(explained, h_at);
    over_h[i] = d[i] / h_at;
    const bool is_noise = d[i] <= kNoisesFar * domain.noise.value_or(0);
    if (over_h[i] > 1 && !is_noise) s.n_beyond_h += static_cast<std::size_t>(count_of(counts, i));
    if (over_h[i] > s.most_over_h) s.most_over_h = over_h[i], s.most_at = domain.cloud.points[i] + domain.shift;
    explained2 += explained * explained;
  }
  std::sort(over_h.begin(), over_h.end());
  s.missed_beyond = std::min(std::max(of_noise, flatness_over_h * h.least()), h.least());
  s.missed = missed_places(domain, d, beyond);
  const double explained_rms = h.is_uniform() ? std::max(of_noise, flatness_over_h * h.least())
                                              : std::sqrt(explained2 / static_cast<double>(d.size()));
  if (s.missed.empty() && (s.rms > explained_rms || quantile(over_h, .99) > 1)) {
    const auto farthest = std::max_element(d.begin(), d.end()) - d.begin();
    std::size_t n = 0;
    for (std::size_t i = 0; i < d.size(); ++i) n += d[i] > beyond[i];
    s.missed = {{domain.cloud.points[farthest], d[farthest], n}};
  }
  s.n_missed_places = s.missed.size();
  if (s.missed.size() > kListedMisses) s.missed.resize(kListedMisses);
  for (MissedPlace& place : s.missed) place.farthest += domain.shift;
  return s;
}

}  // namespace umtet
