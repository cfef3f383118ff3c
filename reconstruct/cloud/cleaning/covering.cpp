#include "reconstruct/cloud/cleaning/covering.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <numeric>
#include <span>
#include <utility>

#include "reconstruct/cloud/cleaning/merged_samples.h"
#include "reconstruct/cloud/cloud_arrays.h"
#include "reconstruct/cloud/neighbours/neighbour_tree.h"

namespace umtet {
namespace {

// A square lattice has .25, lines five times denser along than across .2, six times 0; the real clouds that are sampled
// evenly have at least .09 in all but a thousandth of their places. Where there are lines their noise may hide some of
// them; of white noise one sample in 60 is below the second bound.
constexpr double kLineLike = .05, kLineLikeBesideLines = .12;
// Of white noise one sample in 10^4 looks like a line, and hardly ever half of its neighbours as well.
constexpr double kShareOfNeighbours = .5;
// Beside lines a third of the neighbours decide, whatever the sample itself looks like.
constexpr double kShareBesideLines = 1. / 3;
// Of the cloud: what does not move a median.
constexpr double kFewOnLines = .01;
// On a line the twelve reach six spacings to either side: one of three to six is left, at most one a gap of the six
// spacings that the least line-like of lines are apart.
constexpr double kReach = .5;
// Noise of a spacing and more makes a line look like none: of every 4th and 16th point it is a quarter and a sixteenth
// of a spacing.
constexpr std::array<std::size_t, 2> kStrides = {4, 16};
constexpr std::size_t kLookedAt = 8;  // every 8th of these is enough to see that there are no lines
// Fewer have no noise that could be measured (kFewestSurveyed), or are neighbours all of each other.
constexpr std::size_t kFewestRepresentatives = 60;
// Each leaves a third of a line.
constexpr int kMostRounds = 24;
constexpr std::uint32_t kNone = 0xffffffffU;

/// See covering.h.
template <class Near, class PointOf>
bool is_line_like(const std::vector<Vec3>& points, const Vec3& x, const Near& near, PointOf&& point_of, double bound) {
  Mat3 M = Mat3::Zero();
  for (const auto& other : near) {
    const Vec3 d = points[point_of(other)] - x;
    M.noalias() += d * d.transpose();
  }
  const double trace2 = M.trace() * M.trace();
  return trace2 - M.squaredNorm() < 2 * bound * trace2;
}

/// Which points are on lines; none if these are few.
std::vector<std::uint8_t> on_lines(const std::vector<Vec3>& points, const Neighbourhoods& near, bool beside_lines) {
  const std::size_t n = points.size();
  if (near.k() < Neighbourhoods::kDefault) return {};
  const double bound = beside_lines ? kLineLikeBesideLines : kLineLike;
  std::vector<std::uint8_t> line_like(n), found(n, 0);
  tbb::parallel_for(std::size_t{0}, n, [&](std::size_t i) {
    line_like[i] = is_line_like(
                       points, points[i], near.points(i), [](std::uint32_t j) { return j; }, bound)
                       ? 1
                       : 0;
  });
  const double most = (beside_lines ? kShareBesideLines : kShareOfNeighbours) * static_cast<double>(near.k());
  std::size_t n_found = 0;
  for (std::size_t i = 0; i < n; ++i) {
    if (line_like[i] == 0 && !beside_lines) continue;
    std::size_t n_near = 0;
    for (const std::uint32_t j : near.points(i)) n_near += line_like[j];
    found[i] = static_cast<double>(n_near) >= most ? 1 : 0;
    n_found += found[i];
  }
  if (static_cast<double>(n_found) < kFewOnLines * static_cast<double>(n)) return {};
  return found;
}

/// Of every point the one that is left for it, which may be itself.
std::vector<std::uint32_t> thinned(const std::vector<Vec3>& points, const Neighbourhoods& near,
                                   const std::vector<std::uint8_t>& on_line) {
  std::vector<std::uint32_t> left(near.size(), kNone);
  for (std::uint32_t i = 0; i < left.size(); ++i) {
    if (left[i] != kNone) continue;
    left[i] = i;
    if (on_line[i] == 0) continue;
    const double reach2 = kReach * kReach * near.last_distance2(points, i);
    for (std::size_t m = 0; m < near.k() && near.distance2(points, i, m) <= reach2; ++m) {
      const std::uint32_t j = near.points(i)[m];
      if (left[j] == kNone && on_line[j] != 0) left[j] = i;
    }
  }
  return left;
}

/// Whether as many of the points as an uneven cloud has look like lines; some of them are looked at.
bool seem_on_lines(const std::vector<Vec3>& points, const NeighbourTree& tree) {
  std::atomic<std::size_t> n_line_like = 0;
  const std::size_t n_looked_at = (points.size() + kLookedAt - 1) / kLookedAt;
  tbb::parallel_for(std::size_t{0}, n_looked_at, [&](std::size_t row) {
    const Vec3& x = points[row * kLookedAt];
    std::array<Neighbour, Neighbourhoods::kDefault + 1> room;  // itself among them does not count: d = 0
    const auto near = tree.k_nearest(x, room);
    if (is_line_like(
            points, x, near, [](const Neighbour& other) { return other.point; }, kLineLike))
      ++n_line_like;
  });
  return static_cast<double>(n_line_like) >= kFewOnLines * static_cast<double>(n_looked_at);
}

/// The same of noisy lines, which only some of the points show: these are left for the others beside them.
/// @return empty: none
std::vector<std::uint32_t> thinned_noisy(const std::vector<Vec3>& points, bool beside_lines) {
  for (const std::size_t stride : kStrides) {
    std::vector<Vec3> some;
    for (std::size_t i = 0; i < points.size(); i += stride) some.push_back(points[i]);
    if (some.size() < kFewestRepresentatives) return {};
    const NeighbourTree tree(some);
    if (!beside_lines && !seem_on_lines(some, tree)) continue;
    const Neighbourhoods near(tree, Neighbourhoods::kDefault);
    if (!beside_lines && on_lines(some, near, false).empty()) continue;
    const std::vector<std::uint8_t> lines = on_lines(some, near, true);
    if (lines.empty()) continue;
    std::vector<std::uint32_t> left(points.size());
    tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
      std::array<Neighbour, 1> room;
      const std::uint32_t nearest = tree.k_nearest(points[i], room).front().point;
      left[i] = static_cast<std::uint32_t>(lines[nearest] != 0 ? nearest * stride : i);
    });
    return left;
  }
  return {};
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
    std::vector<std::uint8_t> lines = on_lines(now, around, !is_first);
    if (is_first && !lines.empty()) lines = on_lines(now, around, true);
    const std::vector<std::uint32_t> left = lines.empty() ? thinned_noisy(now, !is_first) : thinned(now, around, lines);

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
  OrientedPointCloud some = cloud;
  keep_samples(some, points);
  return some;
}

NeighbourDistances neighbour_distances(const std::vector<Vec3>& points, const Neighbourhoods& near,
                                       const Covering& covering, const std::vector<int>& counts) {
  NeighbourDistances result = neighbour_distances(points, near);
  if (!counts.empty()) result.weights = relative_counts(counts, near);
  if (covering.is_even()) return result;
  const NeighbourDistances few = neighbour_distances(picked(points, covering.chosen), covering.near);
  for (std::size_t i = 0; i < near.size(); ++i) {
    const std::uint32_t r = covering.representative[i];
    result.mean_square[i] = few.mean_square[r];
    result.multiplicity[i] = covering.n_represented[r];
  }
  result.k = few.k;
  result.representatives = covering.chosen;
  return result;
}

NeighbourDistances covered_distances(const std::vector<Vec3>& points, const std::vector<int>& counts) {
  if (points.size() < 2) return neighbour_distances(points, kAreaNeighbours);  // throws
  const Neighbourhoods near(points, kAreaNeighbours);
  for (std::size_t i = 0; i < near.size(); ++i)
    if (near.distance2(points, i, 0) == 0) return neighbour_distances(points, kAreaNeighbours);
  return neighbour_distances(points, near, covering(points, near), counts);
}

}  // namespace umtet
