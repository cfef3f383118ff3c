#include "body/fidelity/lost_ends.h"

#include <cmath>
#include <numbers>

#include "common/polled_loops.h"
#include "mesh/core/asking_psi.h"
#include "mesh/implicit/foot_point.h"

namespace umtet {
namespace {

// Directions in which walks begin.
constexpr int kWalks = 8;
// Of h: the longest step, and the shortest, at the tip of what is lost.
constexpr double kWalkStep = .25, kLeastWalkStep = 1. / 64;
// A walk leads away from the boundary if its distance grows by this share of a step.
constexpr double kAway = .25;
// A walk turns by so much at a step, to where the boundary is farther: about a cone straight walks miss its tip.
constexpr double kTurn = std::numbers::pi / 6;
// Walks end after so many steps, 100 h: what is longer is known to be lost by then.
constexpr int kMostSteps = 400;

/// Where a step along psi = 0 leads, and how far that is from the boundary.
struct Step {
  Vec3 to;
  double distance = 0;  ///< 0 where psi = 0 is farther from the step than it is long
};

Step step_from(ImplicitFunctionRef psi, const SurfaceDistance& boundary, const Vec3& x, const Vec3& step, double h) {
  const Foot foot = foot_point(psi, x + step, h);
  if (!foot.found || foot.distance > step.norm()) return {x};
  return {foot.point, boundary.distance(foot.point)};
}

/// A walk from x on in this direction.
void walk(ImplicitFunctionRef psi, const SurfaceDistance& boundary, Vec3 x, Vec3 direction, double h, double beyond,
          std::vector<LostPoint>& lost) {
  double distance = boundary.distance(x), length = kWalkStep * h;
  for (int k = 0; k < kMostSteps; ++k) {
    Step best = step_from(psi, boundary, x, length * direction, h);
    // Where psi = 0 has a boundary near it, that shows at the first step.
    if (k == 0 && !(best.distance > distance + kAway * length)) return;
    const Vec3 aside = psi.gradient(x).cross(direction).normalized();
    for (const double turn : {-kTurn, kTurn}) {
      const Vec3 turned = std::cos(turn) * direction + std::sin(turn) * aside;
      const Step other = step_from(psi, boundary, x, length * turned, h);
      if (other.distance > best.distance) best = other;
    }
    if (best.distance > distance + kAway * length) {
      if (best.distance > beyond) lost.push_back({best.to, best.distance});
      direction = (best.to - x).normalized();
      distance = best.distance;
      x = best.to;
    } else if ((length /= 2) < kLeastWalkStep * h) {
      return;
    }
  }
}

}  // namespace

std::vector<LostPoint> lost_ends(const Domain& domain, const std::vector<Vec3>& starts, const SurfaceDistance& boundary,
                                 const MeshEdge& h, double beyond, const Context& context) {
  const ImplicitFunctionRef psi = domain.body();
  std::vector<std::vector<LostPoint>> of_start(starts.size());
  for_each_asking(psi, starts.size(), kValuesPerPoll / (16 * kWalks), context, [&](std::size_t i) {
    const Vec3& x = starts[i];
    const double h_at = h.at(x);
    const Vec3 n = psi.gradient(x).normalized();
    if (!n.allFinite()) return;
    const Vec3 u = n.unitOrthogonal(), v = n.cross(u);
    for (int k = 0; k < kWalks; ++k) {
      const double angle = 2 * std::numbers::pi * k / kWalks;
      walk(psi, boundary, x, std::cos(angle) * u + std::sin(angle) * v, h_at, beyond * h_at, of_start[i]);
    }
  });
  std::vector<LostPoint> lost;
  for (const std::vector<LostPoint>& points : of_start) lost.insert(lost.end(), points.begin(), points.end());
  return lost;
}

}  // namespace umtet
