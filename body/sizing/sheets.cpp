#include "body/sizing/sheets.h"

#include <algorithm>

#include "body/piecewise_body.h"
#include "common/polled_loops.h"
#include "mesh/core/asking_psi.h"

namespace umtet {
namespace {

// Cosine of the angle between the normals of two sheets from which on they are the sides of a wedge. A wedge of 20
// degrees or less is two tets wide so far from its edge (6 h) that it is thin.
constexpr double kWedge = -.94;

/// Whether the sheet at x - d n, where n is the normal at x, is the other side of a wedge.
bool is_wedge(const PiecewiseDomain& body, const Vec3& x, double along) {
  Vec3 n;
  const double value = body.evaluate(x, &n, nullptr);
  const Vec3 foot = x - value / n.squaredNorm() * n;
  n = body.gradient(foot).normalized();
  const Vec3 opposite = foot + along * n;
  return body.active(foot) != body.active(opposite) && n.dot(body.gradient(opposite).normalized()) > kWedge;
}

}  // namespace

std::vector<SheetDistances> body_sheets(const Domain& domain, const std::vector<Vec3>& points,
                                        const std::vector<double>& scale, double step, double limit,
                                        const Context& context) {
  std::vector<SheetDistances> sheets =
      sheet_distances(domain.body(), points, scale, step, limit, context, domain.steepest());
  if (!domain.piecewise) return sheets;
  const PiecewiseDomain& body = domain.piecewise->domain;
  for_each_asking(domain.body(), points.size(), kValuesPerPoll, context, [&](std::size_t i) {
    const double farthest = limit * scale[i];
    auto& [inside, outside] = sheets[i];
    if (inside < farthest && is_wedge(body, points[i], -inside)) inside = farthest;
    if (outside < farthest && is_wedge(body, points[i], outside)) outside = farthest;
  });
  return sheets;
}

std::vector<double> body_thickness(const Domain& domain, const std::vector<Vec3>& points,
                                   const std::vector<double>& scale, double step, double limit,
                                   const Context& context) {
  std::vector<double> least;
  for (const SheetDistances& d : body_sheets(domain, points, scale, step, limit, context))
    least.push_back(std::min(d.body, d.gap));
  return least;
}

}  // namespace umtet
