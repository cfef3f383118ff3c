#include "reconstruct/cloud_neighbours.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <flann/flann.hpp>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <string>

namespace umtet {
namespace {

// Queries per call of FLANN, which allocates its result set once per call: 256 amortise that, and leave blocks enough
// for many threads.
constexpr std::size_t kQueriesPerBlock = 256;
// 8 to 32 cost the same with k = 12 on a surface, 4 costs a tenth more.
constexpr int kLeafSize = 10;

/// The distinct coordinates of a cloud, and where each point sits among them.
struct Places {
  std::vector<Vec3> position;
  std::vector<int> multiplicity;  // points at a place
  std::vector<std::size_t> of;    // point -> place
};

bool lexicographically_less(const Vec3& a, const Vec3& b) {
  return std::lexicographical_compare(a.data(), a.data() + 3, b.data(), b.data() + 3);
}

Places distinct_places(const std::vector<Vec3>& points) {
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  tbb::parallel_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return lexicographically_less(points[a], points[b]); });

  Places places;
  places.of.resize(points.size());
  places.position.reserve(points.size());
  for (const std::size_t i : order) {
    if (places.position.empty() || places.position.back() != points[i]) {
      places.position.push_back(points[i]);
      places.multiplicity.push_back(0);
    }
    ++places.multiplicity.back();
    places.of[i] = places.position.size() - 1;
  }
  return places;
}

void require_finite(const std::vector<Vec3>& points) {
  for (std::size_t i = 0; i < points.size(); ++i)
    if (!points[i].allFinite()) throw std::invalid_argument("points[" + std::to_string(i) + "] is not finite");
}

}  // namespace

NeighbourDistances neighbour_distances(const std::vector<Vec3>& points, int k) {
  if (k < 1) throw std::invalid_argument("k = " + std::to_string(k) + ": must be >= 1");
  require_finite(points);
  Places places = distinct_places(points);
  const std::size_t n = places.position.size();
  if (n < 2) throw std::invalid_argument("the cloud has fewer than two distinct places: it has no spacing");
  k = static_cast<int>(std::min<std::size_t>(k, n - 1));

  const flann::Matrix<double> rows(places.position.front().data(), n, 3);
  flann::Index<flann::L2_3D<double>> tree(rows, flann::KDTreeSingleIndexParams(kLeafSize));
  tree.buildIndex();
  const flann::SearchParams exact(flann::FLANN_CHECKS_UNLIMITED, 0.0F);

  const std::size_t n_found = static_cast<std::size_t>(k) + 1;  // a place finds itself first
  std::vector<double> nearest(n), mean_square(n);
  const std::size_t n_blocks = (n + kQueriesPerBlock - 1) / kQueriesPerBlock;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, n_blocks), [&](const tbb::blocked_range<std::size_t>& blocks) {
    std::vector<std::size_t> ids(kQueriesPerBlock * n_found);
    std::vector<double> distances2(kQueriesPerBlock * n_found);
    for (std::size_t block = blocks.begin(); block != blocks.end(); ++block) {
      const std::size_t first = block * kQueriesPerBlock, count = std::min(kQueriesPerBlock, n - first);
      const flann::Matrix<double> queries(places.position[first].data(), count, 3);
      flann::Matrix<std::size_t> id_rows(ids.data(), count, n_found);
      flann::Matrix<double> distance_rows(distances2.data(), count, n_found);
      tree.knnSearch(queries, id_rows, distance_rows, n_found, exact);
      for (std::size_t q = 0; q < count; ++q) {
        const double* d2 = distance_rows[q];
        nearest[first + q] = std::sqrt(d2[1]);
        mean_square[first + q] = std::accumulate(d2 + 1, d2 + n_found, 0.0) / k;
      }
    }
  });

  NeighbourDistances result;
  result.k = k;
  result.nearest.reserve(points.size());
  result.mean_square.reserve(points.size());
  result.multiplicity.reserve(points.size());
  for (const std::size_t place : places.of) {
    result.nearest.push_back(nearest[place]);
    result.mean_square.push_back(mean_square[place]);
    result.multiplicity.push_back(places.multiplicity[place]);
  }
  return result;
}

double median_spacing(const std::vector<Vec3>& points) { return median_spacing(neighbour_distances(points, 1)); }

double median_spacing(const NeighbourDistances& near) {
  std::vector<double> nearest = near.nearest;
  const auto middle = nearest.begin() + static_cast<std::ptrdiff_t>(nearest.size() / 2);
  std::nth_element(nearest.begin(), middle, nearest.end());
  return *middle;
}

std::vector<double> sample_areas(const std::vector<Vec3>& points, int k) {
  return sample_areas(neighbour_distances(points, k));
}

std::vector<double> sample_areas(const NeighbourDistances& near) {
  const double area_per_mean_square = 2 * std::numbers::pi / (near.k + 2);
  std::vector<double> areas(near.nearest.size());
  for (std::size_t i = 0; i < areas.size(); ++i)
    areas[i] = area_per_mean_square * near.mean_square[i] / near.multiplicity[i];
  return areas;
}

Vec3 far_origin_shift(const OrientedPointCloud& cloud) {
  if (cloud.points.empty()) return Vec3::Zero();
  Vec3 low = cloud.points.front(), high = low;
  for (const Vec3& x : cloud.points) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  const double diagonal = (high - low).norm();
  const double farthest = low.cwiseAbs().cwiseMax(high.cwiseAbs()).maxCoeff();
  if (!(diagonal > 0) || !(farthest > 1e3 * diagonal)) return Vec3::Zero();

  // s is a multiple of g, g <= diagonal < 2 g, so |s - centre| <= diagonal / 2 and |x - s| <= diagonal. With
  // |centre| > 2 diagonal also |x - s| <= |x|: a multiple of ulp(x) below 2^53 of them, hence a double.
  const double g = std::exp2(std::floor(std::log2(diagonal)));
  const Vec3 centre = low + 0.5 * (high - low);
  Vec3 shift = Vec3::Zero();
  for (int axis = 0; axis < 3; ++axis)
    if (std::abs(centre[axis]) > 2 * diagonal) shift[axis] = g * std::round(centre[axis] / g);
  return shift;
}

}  // namespace umtet
