#include "pipeline/domain/missed_samples.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "common/disjoint_sets.h"
#include "mesh/certify/quality_report.h"
#include "pipeline/domain/zero_set_choice.h"
#include "reconstruct/cloud/neighbour_tree.h"

namespace umtet {
namespace {

double rms(const std::vector<double>& d) {
  return std::sqrt(std::transform_reduce(d.begin(), d.end(), 0., std::plus<>(), [](double v) { return v * v; }) /
                   static_cast<double>(d.size()));
}

/// Of the samples farther than `beyond`, in working coordinates; the farthest first.
std::vector<MissedPlace> missed_places(const Domain& domain, const std::vector<double>& d, double beyond) {
  std::vector<Vec3> points;
  std::vector<double> distance;
  for (std::size_t i = 0; i < d.size(); ++i) {
    if (d[i] <= beyond) continue;
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

SampleDistances sample_distances(const Domain& domain, const std::vector<double>& d, double h, double flatness) {
  SampleDistances s;
  std::vector<double> sorted = d;
  std::sort(sorted.begin(), sorted.end());
  s.noise = domain.noise;
  s.rms = rms(sorted);
  s.max = sorted.back();
  s.p99 = quantile(sorted, .99);
  const double explained = std::max(kNoisesMissed * domain.noise.value_or(0), flatness);
  s.missed_beyond = std::min(explained, h);
  s.missed = missed_places(domain, d, s.missed_beyond);
  if (s.missed.empty() && (s.rms > explained || s.p99 > h)) {
    const auto farthest = std::max_element(d.begin(), d.end()) - d.begin();
    const auto n = std::count_if(d.begin(), d.end(), [&](double v) { return v > s.missed_beyond; });
    s.missed = {{domain.cloud.points[farthest], d[farthest], static_cast<std::size_t>(n)}};
  }
  s.n_missed_places = s.missed.size();
  if (s.missed.size() > kListedMisses) s.missed.resize(kListedMisses);
  for (MissedPlace& place : s.missed) place.farthest += domain.shift;
  return s;
}

}  // namespace umtet
