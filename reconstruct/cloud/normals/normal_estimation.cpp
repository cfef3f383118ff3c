#include "reconstruct/cloud/normals/normal_estimation.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "common/formatted.h"
#include "reconstruct/cloud/neighbours/local_quadric.h"

namespace umtet {
namespace {

struct ThinnedCloud {
  std::vector<Vec3> points;
  NeighbourTree tree;
  explicit ThinnedCloud(std::vector<Vec3> some) : points(std::move(some)), tree(points) {}
};

/// Neighbours that a step looks at, at most: three times the first neighbourhood, and more where the density varies.
constexpr std::size_t kMostInStep = 256;
constexpr double kGrowth2 = 3;
// Where the nearest few lie on a quadric so much better than all of them, they are one side of a fin or an edge. Noise
// does that to one point in a thousand: chi^2 / dof of 6 and 3 degrees of freedom is below these at p = 1e-3; and the
// few must look clean themselves.
struct Closer {
  std::size_t neighbours;
  double variance_drop;
};
constexpr std::array<Closer, 2> kCloser = {Closer{12, 1.0 / 16}, Closer{9, 1.0 / 125}};  // of Closer

/// The angle that noise leaves on a normal, from n neighbours within radius.
double noise_angle(const LocalQuadric& quadric, double radius, std::size_t n) {
  return 2 * std::sqrt(quadric.variance / static_cast<double>(n)) / radius;
}

/// The cloud, every third point, every ninth, ...: thinned along the tree's curve, so evenly in space.
std::vector<ThinnedCloud> thinned(const std::vector<Vec3>& points, const NeighbourTree& tree, double largest_growth) {
  std::vector<ThinnedCloud> levels;
  const std::vector<std::uint32_t>& order = tree.order();
  for (std::size_t stride = 3; kGrowth2 * static_cast<double>(stride) <= largest_growth * largest_growth; stride *= 3) {
    std::vector<Vec3> some;
    some.reserve(order.size() / stride + 1);
    for (std::size_t row = 0; row < order.size(); row += stride) some.push_back(points[order[row]]);
    levels.emplace_back(std::move(some));
  }
  return levels;
}

struct Estimate {
  Vec3 normal;
  bool widened;
};

Estimate estimate(const std::vector<Vec3>& points, const NeighbourTree& tree, const std::vector<ThinnedCloud>& levels,
                  const NormalEstimationParams& params, const Vec3& x, std::span<const Neighbour> near) {
  const double radius = std::sqrt(near.back().distance2);
  const double goal = params.noise_angle * std::numbers::pi / 180;
  LocalQuadric best = local_quadric(points, x, near);
  if (!(radius > 0)) return {best.normal, false};
  double angle = noise_angle(best, radius, near.size());
  for (const auto& [few, least_drop] : kCloser) {
    if (angle <= goal || few >= near.size()) break;
    const LocalQuadric closer = local_quadric(points, x, near.first(few));
    const bool is_clean = noise_angle(closer, std::sqrt(near[few - 1].distance2), few) <= goal;
    if (is_clean && closer.variance < best.variance * least_drop) return {closer.normal, false};
  }
  bool widened = false;
  std::array<Neighbour, kMostInStep> buffer;
  // Three times the neighbours divide the angle by three; more is left to the thinned clouds from the start.
  std::size_t level = angle <= kGrowth2 * goal ? 0 : std::min<std::size_t>(1, levels.size());
  for (double growth = std::pow(kGrowth2, 0.5 * static_cast<double>(level + 1));
       angle > goal && growth <= params.largest_growth; growth *= std::sqrt(kGrowth2)) {
    const double wider = growth * radius;
    std::size_t n = 0;
    const auto look_up = [&](const NeighbourTree& in) {
      n = 0;
      in.within(x, wider * wider, [&](std::uint32_t j, double distance2) {
        if (n < buffer.size()) buffer[n] = {distance2, j};
        ++n;
      });
    };
    // Noise fills a ball and not a disc: thin further until what is found fits.
    for (look_up(level == 0 ? tree : levels[level - 1].tree); n > buffer.size() && level < levels.size();)
      look_up(levels[level++].tree);
    n = std::min(n, buffer.size());
    const std::vector<Vec3>& cloud = level == 0 ? points : levels[level - 1].points;
    level = std::min(level + 1, levels.size());
    const LocalQuadric next = local_quadric(cloud, x, {buffer.data(), n});
    const double now = noise_angle(next, wider, std::max<std::size_t>(n, 1));
    // Noise falls like 1 / r. Where it does not, the wider neighbourhood holds something else: the other side of a
    // sheet, an edge, a bend.
    if (n < near.size() || next.normal.isZero(0) || now > 0.75 * angle) break;
    best = next;
    angle = now;
    widened = true;
  }
  return {best.normal, widened};
}

}  // namespace

std::vector<std::string> problems(const NormalEstimationParams& params) {
  std::vector<std::string> found;
  if (params.neighbours < 8 || params.neighbours > 64)
    found.push_back(formatted("neighbours = %d: must be in 8..64, a quadric has six coefficients", params.neighbours));
  if (!(params.noise_angle > 0)) found.push_back(formatted("noise_angle = %g: must be > 0", params.noise_angle));
  if (!(params.largest_growth >= 1))
    found.push_back(formatted("largest_growth = %g: must be >= 1", params.largest_growth));
  return found;
}

EstimatedNormals estimate_normals(const std::vector<Vec3>& points, const NormalEstimationParams& params,
                                  const Covering* covering) {
  if (const auto found = problems(params); !found.empty()) throw std::invalid_argument(found.front());
  if (points.size() < 3) throw std::invalid_argument(formatted("%zu points have no normals", points.size()));
  const bool is_even = !covering || covering->is_even();
  std::vector<Vec3> few;
  if (!is_even)
    for (const std::uint32_t i : covering->chosen) few.push_back(points[i]);
  const std::vector<Vec3>& cloud = is_even ? points : few;
  const NeighbourTree tree(cloud);
  const std::vector<ThinnedCloud> levels = thinned(cloud, tree, params.largest_growth);
  EstimatedNormals result;
  result.normals.resize(points.size());
  std::vector<std::uint8_t> widened(points.size());
  const auto k = static_cast<std::size_t>(params.neighbours);
  const auto visit = [&](std::uint32_t i, std::span<const Neighbour> near) {
    const Estimate found = estimate(cloud, tree, levels, params, points[i], near);
    result.normals[i] = found.normal;
    widened[i] = found.widened ? 1 : 0;
  };
  if (is_even) {
    tree.for_each_neighbourhood(k, visit);
  } else {
    tbb::parallel_for(std::uint32_t{0}, static_cast<std::uint32_t>(points.size()), [&](std::uint32_t i) {
      std::array<Neighbour, kMostInStep> room;
      visit(i, tree.k_nearest(points[i], std::span(room).first(k)));
    });
  }
  result.n_widened = static_cast<std::size_t>(std::count(widened.begin(), widened.end(), std::uint8_t{1}));
  for (const Vec3& n : result.normals) result.n_undefined += n.isZero(0) ? 1 : 0;
  return result;
}

}  // namespace umtet
