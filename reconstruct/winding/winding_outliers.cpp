#include "reconstruct/winding/winding_outliers.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "reconstruct/cloud/neighbours/cloud_neighbours.h"
#include "reconstruct/winding/fast_winding_number.h"

namespace umtet {
namespace {

// w is 0 outside, 1/2 at samples of a smooth surface, between .1 and .9 at edges and corners of boxes and at rims.
constexpr double kOutlierOff = .4;
// Of the distance to the fourth: in white noise on a surface it is 2.5 times the median at one sample in 10^7.
constexpr std::size_t kFourth = 3;
constexpr double kApart = 2.5, kApartFromAll = 4;
// Of merged samples those of cells that noise reaches with its tails have their fourth neighbour 1.2 to 1.7 medians
// away.
constexpr double kApartFromCells = 2;
// Of which the winding number is taken: its error is that of areas of single samples, and falls with their number.
constexpr std::size_t kMostSources = 30000;
constexpr double kSoftening = .5;

double median_of(std::vector<double> v) {
  const auto middle = v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2);
  std::nth_element(v.begin(), middle, v.end());
  return *middle;
}

/// @param counts  of merged samples: before, n of them were at distances 1 / sqrt n of those between their means
std::vector<std::uint32_t> samples_apart(const std::vector<Vec3>& points, const Neighbourhoods& near,
                                         const std::vector<int>& counts) {
  if (near.k() <= kFourth) return {};
  std::vector<double> d2(near.size());
  for (std::size_t i = 0; i < d2.size(); ++i) d2[i] = near.distance2(points, i, kFourth);
  const double of_cells = counts.empty() ? 0 : kApartFromCells * kApartFromCells * median_of(d2);
  for (std::size_t i = 0; i < counts.size(); ++i) d2[i] /= counts[i];
  const double of_all = kApartFromAll * kApartFromAll * median_of(d2);
  std::vector<std::uint8_t> is_apart(d2.size());
  tbb::parallel_for(std::size_t{0}, d2.size(), [&](std::size_t i) {
    std::vector<double> around;
    for (const std::uint32_t j : near.points(i)) around.push_back(d2[j]);
    const bool is_sparse = d2[i] > of_all || d2[i] > kApart * kApart * median_of(std::move(around));
    is_apart[i] = is_sparse && near.distance2(points, i, kFourth) > of_cells ? 1 : 0;
  });
  std::vector<std::uint32_t> apart;
  for (std::uint32_t i = 0; i < is_apart.size(); ++i)
    if (is_apart[i] != 0) apart.push_back(i);
  return apart;
}

/// Of every m-th sample but those.
FastWindingNumber winding_number_without(const OrientedPointCloud& cloud, const std::vector<std::uint32_t>& apart) {
  const std::size_t n = cloud.points.size(), m = (n + kMostSources - 1) / kMostSources;
  OrientedPointCloud part;
  for (std::size_t i = 0; i < n; i += m) {
    if (std::binary_search(apart.begin(), apart.end(), static_cast<std::uint32_t>(i))) continue;
    part.points.push_back(cloud.points[i]);
    part.normals.push_back(cloud.normals[i]);
  }
  return {part.points, part.normals, sample_areas(part.points), {.softening = kSoftening}};
}

}  // namespace

std::vector<std::uint8_t> winding_outliers(const OrientedPointCloud& cloud, const Neighbourhoods& near) {
  std::vector<std::uint8_t> is_outlier(cloud.points.size(), 0);
  const std::vector<std::uint32_t> apart = samples_apart(cloud.points, near, cloud.counts);
  if (apart.empty() || 2 * apart.size() > cloud.points.size()) return is_outlier;
  const FastWindingNumber w = winding_number_without(cloud, apart);
  tbb::parallel_for(std::size_t{0}, apart.size(), [&](std::size_t k) {
    is_outlier[apart[k]] = std::abs(w(cloud.points[apart[k]]) - .5) > kOutlierOff ? 1 : 0;
  });
  return is_outlier;
}

}  // namespace umtet
