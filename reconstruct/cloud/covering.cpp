#include "reconstruct/cloud/covering.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <span>
#include <utility>

namespace umtet {
namespace {

// A square lattice has .25, lines five times denser along than across .2, six times 0; the real clouds that are sampled
// evenly have at least .09 in all but a thousandth of their places.
constexpr double kLineLike = .05;
// Of white noise one sample in 10^4 looks like a line, and hardly ever half of its neighbours as well.
constexpr double kShareOfNeighbours = .5;
// Of the cloud: what does not move a median.
constexpr double kFewOnLines = .01;
// On a line the twelve reach six spacings to either side: one of three to six is left, at most one a gap of the six
// spacings that the least line-like of lines are apart.
constexpr double kReach = .5;
// Fewer have no noise that could be measured (kFewestSurveyed), or are neighbours all of each other.
constexpr std::size_t kFewestRepresentatives = 60;
// Each leaves a third of a line.
constexpr int kMostRounds = 24;

bool is_line_like(const std::vector<Vec3>& points, const Vec3& x, std::span<const std::uint32_t> near) {
  Mat3 M = Mat3::Zero();
  for (const std::uint32_t j : near) {
    const Vec3 d = points[j] - x;
    M.noalias() += d * d.transpose();
  }
  const double trace = M.trace();
  return trace * trace - M.squaredNorm() < 2 * kLineLike * trace * trace;
}

std::vector<std::uint8_t> on_lines(const std::vector<Vec3>& points, const Neighbourhoods& near, std::size_t& n_found) {
  std::vector<std::uint8_t> line_like(points.size()), found(points.size(), 0);
  tbb::parallel_for(std::size_t{0}, points.size(),
                    [&](std::size_t i) { line_like[i] = is_line_like(points, points[i], near.points(i)) ? 1 : 0; });
  const auto most = static_cast<std::size_t>(std::ceil(kShareOfNeighbours * static_cast<double>(near.k())));
  n_found = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (line_like[i] == 0) continue;
    std::size_t n = 0;
    for (const std::uint32_t j : near.points(i)) n += line_like[j];
    found[i] = n >= most ? 1 : 0;
    n_found += found[i];
  }
  return found;
}

/// Of every point the one that is left for it, which may be itself.
std::vector<std::uint32_t> thinned(const Neighbourhoods& near, const std::vector<std::uint8_t>& on_line) {
  constexpr std::uint32_t kNone = 0xffffffffU;
  std::vector<std::uint32_t> left(near.size(), kNone);
  for (std::uint32_t i = 0; i < left.size(); ++i) {
    if (left[i] != kNone) continue;
    left[i] = i;
    if (on_line[i] == 0) continue;
    const double reach2 = kReach * kReach * near.distances2(i).back();
    for (std::size_t m = 0; m < near.k() && near.distances2(i)[m] <= reach2; ++m) {
      const std::uint32_t j = near.points(i)[m];
      if (left[j] == kNone && on_line[j] != 0) left[j] = i;
    }
  }
  return left;
}

template <class T>
std::vector<T> picked(const std::vector<T>& all, const std::vector<std::uint32_t>& rows) {
  std::vector<T> some;
  some.reserve(rows.size());
  for (const std::uint32_t row : rows) some.push_back(all[row]);
  return some;
}

}  // namespace

Covering covering(const std::vector<Vec3>& points, const Neighbourhoods& near) {
  Covering result;
  std::vector<Vec3> few;
  for (int round = 0; round < kMostRounds; ++round) {
    const bool is_first = result.is_even();
    const std::vector<Vec3>& now = is_first ? points : few;
    const Neighbourhoods& around = is_first ? near : result.near;
    if (around.k() < Neighbourhoods::kDefault) break;
    std::size_t n_on_lines = 0;
    const std::vector<std::uint8_t> lines = on_lines(now, around, n_on_lines);
    if (static_cast<double>(n_on_lines) < kFewOnLines * static_cast<double>(now.size())) break;

    const std::vector<std::uint32_t> left = thinned(around, lines);
    std::vector<std::uint32_t> rows, row_of(now.size());
    for (std::uint32_t i = 0; i < left.size(); ++i) {
      if (left[i] != i) continue;
      row_of[i] = static_cast<std::uint32_t>(rows.size());
      rows.push_back(i);
    }
    if (rows.size() < kFewestRepresentatives || rows.size() == now.size()) break;
    if (is_first) {
      result.representative.resize(points.size());
      std::iota(result.representative.begin(), result.representative.end(), 0U);
    }
    for (std::uint32_t& r : result.representative) r = row_of[left[r]];
    few = picked(now, rows);
    result.chosen = is_first ? std::move(rows) : picked(result.chosen, rows);
    result.near = Neighbourhoods(few, Neighbourhoods::kDefault);
  }
  result.n_represented.assign(result.chosen.size(), 0);
  for (const std::uint32_t r : result.representative) ++result.n_represented[r];
  return result;
}

OrientedPointCloud picked(const OrientedPointCloud& cloud, const std::vector<std::uint32_t>& points) {
  OrientedPointCloud some{picked<Vec3>(cloud.points, points), {}};
  if (!cloud.normals.empty()) some.normals = picked<Vec3>(cloud.normals, points);
  if (!cloud.labels.empty()) some.labels = picked<int>(cloud.labels, points);
  return some;
}

NeighbourDistances neighbour_distances(const Neighbourhoods& near, const Covering& covering) {
  NeighbourDistances result = neighbour_distances(near);
  if (covering.is_even()) return result;
  const NeighbourDistances few = neighbour_distances(covering.near);
  for (std::size_t i = 0; i < near.size(); ++i) {
    const std::uint32_t r = covering.representative[i];
    result.mean_square[i] = few.mean_square[r];
    result.multiplicity[i] = covering.n_represented[r];
  }
  result.k = few.k;
  result.representatives = covering.chosen;
  return result;
}

NeighbourDistances covered_distances(const std::vector<Vec3>& points) {
  if (points.size() < 2) return neighbour_distances(points, kAreaNeighbours);  // throws
  const Neighbourhoods near(points, kAreaNeighbours);
  for (std::size_t i = 0; i < near.size(); ++i)
    if (near.distances2(i).front() == 0) return neighbour_distances(points, kAreaNeighbours);
  return neighbour_distances(near, covering(points, near));
}

}  // namespace umtet
