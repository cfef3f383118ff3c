#include "body/fidelity/lost_surface.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <set>

#include "common/polled_loops.h"
#include "mesh/core/asking_psi.h"
#include "mesh/implicit/foot_point.h"

namespace umtet {
namespace {

// Directions of steps, and how long they and the edges of cubes are, in h.
constexpr int kSteps = 8;
constexpr double kAroundStep = .5;

/// Of a cube: the power of two below its edge length, and its place.
using Cube = std::array<std::int64_t, 4>;

Cube cube_of(const Vec3& x, double h) {
  const int level = std::ilogb(h);
  const Eigen::Array3d q = (x / std::ldexp(kAroundStep, level)).array().floor();
  return {level, static_cast<std::int64_t>(q[0]), static_cast<std::int64_t>(q[1]), static_cast<std::int64_t>(q[2])};
}

}  // namespace

std::vector<LostPoint> lost_surface(const Domain& domain, std::vector<LostPoint> seeds, const SurfaceDistance& boundary,
                                    const MeshEdge& h, double beyond, const Context& context) {
  const ImplicitFunctionRef psi = domain.body();
  std::set<Cube> met;
  for (const LostPoint& seed : seeds) met.insert(cube_of(seed.where, h.at(seed.where)));
  std::vector<LostPoint> lost = std::move(seeds);
  // Round by round: what a round finds is taken in the order of the points that it started from.
  for (std::size_t first = 0; first < lost.size();) {
    const std::size_t last = lost.size();
    std::vector<std::vector<LostPoint>> of_point(last - first);
    for_each_asking(psi, last - first, kValuesPerPoll / (8 * kSteps), context, [&](std::size_t k) {
      const Vec3& x = lost[first + k].where;
      const double h_at = h.at(x);
      const Vec3 n = psi.gradient(x).normalized();
      if (!n.allFinite()) return;
      const Vec3 u = n.unitOrthogonal(), v = n.cross(u);
      for (int s = 0; s < kSteps; ++s) {
        const double angle = 2 * std::numbers::pi * s / kSteps;
        const Vec3 step = kAroundStep * h_at * (std::cos(angle) * u + std::sin(angle) * v);
        if (met.count(cube_of(x + step, h_at)) != 0) continue;
        const Foot foot = foot_point(psi, x + step, h_at);
        if (!foot.found || foot.distance > step.norm() || met.count(cube_of(foot.point, h_at)) != 0) continue;
        const double distance = boundary.distance(foot.point);
        if (distance > beyond * h.at(foot.point)) of_point[k].push_back({foot.point, distance});
      }
    });
    first = last;
    for (const std::vector<LostPoint>& points : of_point) {
      for (const LostPoint& point : points) {
        if (met.insert(cube_of(point.where, h.at(point.where))).second) lost.push_back(point);
      }
    }
  }
  return lost;
}

}  // namespace umtet
