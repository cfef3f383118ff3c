#include "reconstruct/cloud/cleaning/cleaning.h"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_sort.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <optional>
#include <stdexcept>

#include "common/first_touch.h"
#include "common/formatted.h"
#include "common/shared_disjoint_sets.h"
#include "reconstruct/cloud/cloud_arrays.h"
#include "reconstruct/cloud/neighbours/neighbour_tree.h"

namespace umtet {
namespace {

constexpr std::size_t kNeighbours = Neighbourhoods::kDefault;  // the neighbours that all steps share
// The plane is that of the points within 1.2 times the 12th neighbour: above an outlier four spacings off its surface
// there are some 30.
constexpr double kPlaneReach2 = 1.44;
constexpr std::size_t kMostInPlane = 128;
// Two points are linked, in the graph whose components are the pieces, if they are nearer than kLink times the distance
// to their 4th neighbour: one step on a square lattice. Wider gaps part pieces.
constexpr std::size_t kSpacingNeighbour = 4;
constexpr double kLink = 3;
// A crowd is first looked for among every 6th point, 54 of them where it is suspicious and 18 on a surface. What has
// fewer than 32 there is none: that would be three deviations of points picked at random, and these are picked evenly.
constexpr std::size_t kThinning = 6;
constexpr double kThinnedShare = 0.6;

bool is_usable(const Vec3& x) { return x.allFinite() && x.cwiseAbs().maxCoeff() <= 1e50; }

/// Keeps rows where drop is 0; returns how many went.
std::size_t keep_only(const std::vector<std::uint8_t>& drop, std::vector<std::uint32_t>& kept) {
  std::size_t n = 0;
  for (std::size_t row = 0; row < kept.size(); ++row)
    if (drop[row] == 0) kept[n++] = kept[row];
  const std::size_t n_dropped = kept.size() - n;
  kept.resize(n);
  return n_dropped;
}

std::vector<Vec3> positions(const OrientedPointCloud& cloud, const std::vector<std::uint32_t>& kept) {
  std::vector<Vec3> points = touched<Vec3>(kept.size());
  tbb::parallel_for(std::size_t{0}, kept.size(), [&](std::size_t row) { points[row] = cloud.points[kept[row]]; });
  return points;
}

std::vector<std::uint8_t> later_duplicates(const std::vector<Vec3>& points) {
  std::vector<std::uint32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0U);
  tbb::parallel_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    const Vec3 &x = points[a], &y = points[b];
    for (int axis = 0; axis < 3; ++axis)
      if (x[axis] != y[axis]) return x[axis] < y[axis];
    return a < b;
  });
  std::vector<std::uint8_t> drop(points.size(), 0);
  for (std::size_t row = 1; row < order.size(); ++row)
    if (points[order[row]] == points[order[row - 1]]) drop[order[row]] = 1;
  return drop;
}

/// Whether x is off the plane of the points around it by kDeviations standard deviations of these points from it and by
/// kSpacings of their spacings. The plane and not a quadric: curvature then counts as deviation, and sharp tips of
/// clean bodies stay.
bool is_off_plane(const std::vector<Vec3>& points, const Vec3& x, std::span<const Neighbour> around) {
  constexpr double kDeviations = 5;  // standard deviations of the points around off their plane
  constexpr double kSpacings = 2.5;  // spacings of the points around, besides kDeviations of their deviations
  const auto n = static_cast<double>(around.size());
  Vec3 mean = Vec3::Zero();
  double scale2 = 0;
  for (const Neighbour& other : around) {
    mean += points[other.point] - x;
    scale2 = std::max(scale2, other.distance2);
  }
  mean /= n;
  Mat3 covariance = Mat3::Zero();
  const double scale = std::sqrt(scale2);
  for (const Neighbour& other : around) {
    const Vec3 d = (points[other.point] - x - mean) / scale;
    covariance.noalias() += d * d.transpose();
  }
  Eigen::SelfAdjointEigenSolver<Mat3> axes;
  axes.computeDirect(covariance);
  const Vec3& spread = axes.eigenvalues();
  const double height = std::abs(mean.dot(axes.eigenvectors().col(0))) / scale;
  const double variance = std::max(0.0, spread[0]) / (n - 3);
  // n neighbours fill a disc of r^2 = 2 (spread of both axes) / n, each a cell of s^2 = pi r^2 / n of it.
  const double spacing2 = 2 * std::numbers::pi * (spread[1] + spread[2]) / (n * n);
  return height * height > std::max(kDeviations * kDeviations * variance, kSpacings * kSpacings * spacing2);
}

/// A cloud, its tree and who is near whom: made again when points have gone.
struct Surroundings {
  std::vector<Vec3> points;
  std::optional<NeighbourTree> tree;  // none for fewer than two points
  Neighbourhoods near;

  explicit Surroundings(std::vector<Vec3> some) : points(std::move(some)) {
    if (points.size() < 2) return;
    tree.emplace(points);
    near = Neighbourhoods(*tree, kNeighbours);
  }
  Surroundings(std::vector<Vec3> some, const Neighbourhoods& theirs)
      : points(std::move(some)), tree(points), near(theirs) {}
  bool has_duplicates() const {
    for (std::size_t i = 0; i < near.size(); ++i)
      if (near.distance2(points, i, 0) == 0) return true;
    return false;
  }
};

/// Every kThinning-th point, along the tree's curve: evenly in space.
NeighbourTree thinned(const Surroundings& cloud) {
  std::vector<Vec3> some;
  some.reserve(cloud.points.size() / kThinning + 1);
  const std::vector<std::uint32_t>& order = cloud.tree->order();
  for (std::size_t row = 0; row < order.size(); row += kThinning) some.push_back(cloud.points[order[row]]);
  return NeighbourTree(some);
}

/// The points, along the curve of the tree, around which there may be `crowd` others within three times their reach.
/// One ball for a few points beside each other, which holds all of theirs, clears most of them.
std::vector<std::uint32_t> maybe_crowded(const Surroundings& cloud, std::size_t crowd) {
  constexpr std::size_t kTogether = 8;  // on a surface their ball holds some 200 points, where 324 are a crowd
  const std::vector<std::uint32_t>& order = cloud.tree->order();
  const std::size_t n_groups = (order.size() + kTogether - 1) / kTogether;
  std::vector<std::uint8_t> is_open(n_groups);
  tbb::parallel_for(std::size_t{0}, n_groups, [&](std::size_t g) {
    const std::span<const std::uint32_t> group =
        std::span(order).subspan(g * kTogether, std::min(kTogether, order.size() - g * kTogether));
    Vec3 centre = Vec3::Zero();
    for (const std::uint32_t i : group) centre += (cloud.points[i] - cloud.points[group[0]]) / group.size();
    centre += cloud.points[group[0]];
    double radius = 0;
    for (const std::uint32_t i : group) {
      radius = std::max(radius,
                        (cloud.points[i] - centre).norm() + 3 * std::sqrt(cloud.near.last_distance2(cloud.points, i)));
    }
    constexpr double kRoundedUp = 1 + 1e-9;
    is_open[g] = cloud.tree->count_within(centre, radius * radius * kRoundedUp, crowd) >= crowd ? 1 : 0;
  });
  std::vector<std::uint32_t> rows;
  for (std::size_t row = 0; row < order.size(); ++row)
    if (is_open[row / kTogether] != 0) rows.push_back(order[row]);
  return rows;
}

/// What `judge` finds of the cloud, or, where it lies on scan lines, of its representatives: all that one stands for go
/// with it.
template <class Judge>
std::vector<std::uint8_t> judged(const Surroundings& cloud, const Covering& covers, Judge&& judge) {
  if (covers.is_even()) return judge(cloud);
  const Surroundings few(picked({cloud.points, {}}, covers.chosen).points, covers.near);
  const std::vector<std::uint8_t> of_few = judge(few);
  std::vector<std::uint8_t> of_all(cloud.points.size());
  for (std::size_t i = 0; i < of_all.size(); ++i) of_all[i] = of_few[covers.representative[i]];
  return of_all;
}

std::vector<std::uint8_t> outliers(const Surroundings& cloud, const CleaningParams& params) {
  const std::vector<Vec3>& points = cloud.points;
  std::vector<std::uint8_t> drop(points.size(), 0);
  if (points.size() <= 9 * kNeighbours) return drop;  // too few for a density
  const NeighbourTree& tree = *cloud.tree;
  const auto suspicious = static_cast<std::size_t>(params.suspicious_crowd * 9 * kNeighbours);
  const std::vector<std::uint32_t> open = maybe_crowded(cloud, suspicious);
  if (open.empty()) return drop;
  const NeighbourTree few = thinned(cloud);
  const auto certain = static_cast<std::size_t>(params.certain_crowd * 9 * kNeighbours);
  const auto worth_counting = static_cast<std::size_t>(kThinnedShare * static_cast<double>(suspicious) / kThinning);
  tbb::parallel_for(std::size_t{0}, open.size(), [&](std::size_t row) {
    const std::uint32_t i = open[row];
    const Vec3& x = points[i];
    const double reach2 = cloud.near.last_distance2(points, i);
    if (few.count_within(x, 9 * reach2, worth_counting) < worth_counting) return;
    if (tree.count_within(x, 9 * reach2, suspicious) < suspicious) return;
    if (tree.count_within(x, 9 * reach2, certain) >= certain) {
      drop[i] = 1;
      return;
    }
    std::array<Neighbour, kMostInPlane> around;
    std::size_t n = 0;
    tree.within(x, kPlaneReach2 * reach2, [&](std::uint32_t j, double distance2) {
      if (j != i && n < around.size()) around[n++] = {distance2, j};
    });
    if (is_off_plane(points, x, {around.data(), n})) drop[i] = 1;
  });
  return drop;
}

std::vector<std::uint8_t> small_components(const Surroundings& cloud, const CleaningParams& params,
                                           std::size_t& n_pieces) {
  const std::size_t n = cloud.points.size();
  std::vector<std::uint8_t> drop(n, 0);
  n_pieces = 0;
  if (n <= kNeighbours) return drop;
  const Neighbourhoods& near = cloud.near;
  const auto spacing2 = [&](std::uint32_t i) { return near.distance2(cloud.points, i, kSpacingNeighbour - 1); };
  SharedDisjointSets pieces(n);
  tbb::parallel_for(std::uint32_t{0}, static_cast<std::uint32_t>(n), [&](std::uint32_t i) {
    for (std::size_t m = 0; m < kNeighbours; ++m) {
      const std::uint32_t j = near.points(i)[m];
      const double reach2 = near.distance2(cloud.points, i, m) / (kLink * kLink);
      if (reach2 <= spacing2(i) || reach2 <= spacing2(j)) pieces.unite(i, j);
    }
  });
  std::vector<std::uint32_t> piece_of(n), size(n, 0);
  tbb::parallel_for(std::uint32_t{0}, static_cast<std::uint32_t>(n),
                    [&](std::uint32_t i) { piece_of[i] = pieces.find(i); });
  for (const std::uint32_t root : piece_of) ++size[root];
  const auto is_small = [&](std::uint32_t root) {
    return size[root] < params.small_component_points && size[root] * 100 < n;
  };
  std::map<std::uint32_t, std::vector<std::uint32_t>> small;  // by roots
  for (std::uint32_t i = 0; i < n; ++i)
    if (is_small(piece_of[i])) small[piece_of[i]].push_back(i);
  for (const auto& [root, members] : small) {
    std::vector<double> spacings;
    for (const std::uint32_t i : members) spacings.push_back(spacing2(i));
    std::nth_element(spacings.begin(), spacings.begin() + static_cast<std::ptrdiff_t>(spacings.size() / 2),
                     spacings.end());
    const double reach2 =
        params.small_component_distance * params.small_component_distance * spacings[spacings.size() / 2];
    // Alone, or with other small components only: does a ball around any member hold a point of something larger?
    bool is_far = true;
    for (std::size_t m = 0; m < members.size() && is_far; ++m)
      cloud.tree->within(cloud.points[members[m]], reach2, [&](std::uint32_t j, double) {
        if (!is_small(piece_of[j])) is_far = false;
      });
    if (!is_far) continue;
    ++n_pieces;
    for (const std::uint32_t i : members) drop[i] = 1;
  }
  return drop;
}

}  // namespace

std::vector<std::string> problems(const CleaningParams& params) {
  std::vector<std::string> found;
  if (!(params.suspicious_crowd > 1))
    found.push_back(formatted("suspicious_crowd = %g: must be > 1", params.suspicious_crowd));
  if (!(params.certain_crowd >= params.suspicious_crowd && params.certain_crowd < 1e6))
    found.push_back(formatted("certain_crowd = %g: must be in suspicious_crowd = %g..1e6", params.certain_crowd,
                              params.suspicious_crowd));
  if (!(params.small_component_distance > 1))
    found.push_back(formatted("small_component_distance = %g: must be > 1", params.small_component_distance));
  return found;
}

CleaningReport clean(OrientedPointCloud& cloud, const CleaningParams& params, Neighbourhoods* neighbours,
                     Covering* covers_left) {
  if (const auto found = problems(params); !found.empty()) throw std::invalid_argument(found.front());
  require_equal_lengths(cloud);
  CleaningReport report;
  std::vector<std::uint32_t>& kept = report.kept;
  for (std::uint32_t i = 0; i < cloud.points.size(); ++i)
    if (is_usable(cloud.points[i])) kept.push_back(i);
  report.n_not_finite = cloud.points.size() - kept.size();

  Surroundings left(positions(cloud, kept));
  Covering covers;
  const auto drop = [&](const std::vector<std::uint8_t>& these, std::vector<Vec3>* where = nullptr) {
    for (std::size_t row = 0; where && row < kept.size(); ++row)
      if (these[row] != 0) where->push_back(cloud.points[kept[row]]);
    const std::size_t n_dropped = keep_only(these, kept);
    if (n_dropped > 0) left = Surroundings(positions(cloud, kept));
    if (n_dropped > 0) covers = covering(left.points, left.near);
    return n_dropped;
  };
  if (!left.has_duplicates() || (report.n_duplicates = drop(later_duplicates(left.points))) == 0)
    covers = covering(left.points, left.near);
  if (params.outliers) {
    // A second pass where the first has dropped something: outliers beside each other hide one another from the first.
    for (int pass = 0; pass < 2; ++pass) {
      const std::size_t n_dropped =
          drop(judged(left, covers, [&](const auto& some) { return outliers(some, params); }), &report.outliers);
      if (n_dropped == 0) break;
      report.n_outliers += n_dropped;
    }
    report.n_small_components =
        drop(judged(left, covers,
                    [&](const auto& some) { return small_components(some, params, report.n_small_component_pieces); }),
             &report.small_components);
  }
  keep_samples(cloud, kept);
  if (neighbours) *neighbours = std::move(left.near);
  if (covers_left) *covers_left = std::move(covers);
  return report;
}

}  // namespace umtet
