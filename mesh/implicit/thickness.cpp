#include "mesh/implicit/thickness.h"

#include <algorithm>
#include <cmath>

#include "common/polled_loops.h"
#include "mesh/core/asking_psi.h"

namespace umtet {

namespace {

// A sheet may be nearer than the first step; this often it is halved before psi is taken to be grazing there, or to
// have no simple zero.
constexpr int kHalvings = 8;

// The distance from x along d at which psi, of sign `side` behind the start, changes sign again; or limit.
double first_return(ImplicitFunctionRef psi, const Vec3& x, const Vec3& d, double side, const SheetSearch& search) {
  double before = search.step / 2, value = side * psi.value(x + before * d), beyond = value;
  for (int k = 0; k < kHalvings && !(value > 0); ++k) {
    before /= 2, beyond = value;
    value = side * psi.value(x + before * d);
  }
  if (!(value > 0)) return search.limit;
  if (!(beyond > 0)) return before + before * value / (value - beyond);
  while (true) {
    const double t = before + std::max({search.step, value / search.steepest, search.growth * before});
    if (!(t < search.limit)) return search.limit;
    const double next = side * psi.value(x + t * d);
    if (next <= 0) return before + (t - before) * value / (value - next);  // linear in between
    before = t, value = next;
  }
}

SheetDistances sheet_distances_at(ImplicitFunctionRef psi, Vec3 x, double step, double limit, double steepest) {
  Vec3 g;
  double value = psi.value(x, g);
  for (int it = 0; it < 8 && std::abs(value) > 1e-6 * step * g.norm(); ++it) {
    const Vec3 move = -value / std::max(g.squaredNorm(), 1e-300) * g;
    x += move * std::min(1.0, step / std::max(move.norm(), 1e-300));
    value = psi.value(x, g);
  }
  const double slope = g.norm();
  if (!(slope > 0) || std::abs(value) > 1e-3 * step * slope) return {limit, limit};
  return sheet_distances_from(psi, x, g / slope, {step, limit, steepest});
}

std::vector<double> least_of(const std::vector<SheetDistances>& distances) {
  std::vector<double> out;
  for (const SheetDistances& d : distances) out.push_back(std::min(d.body, d.gap));
  return out;
}

}  // namespace

SheetDistances sheet_distances_from(ImplicitFunctionRef psi, const Vec3& x, const Vec3& n, const SheetSearch& search) {
  return {first_return(psi, x, -n, -1, search), first_return(psi, x, n, 1, search)};
}

std::vector<SheetDistances> sheet_distances(ImplicitFunctionRef psi, const std::vector<Vec3>& points, double step,
                                            double limit, const Context& context, double steepest) {
  std::vector<SheetDistances> out(points.size());
  for_each_asking(psi, points.size(), kValuesPerPoll, context,
                  [&](std::size_t i) { out[i] = sheet_distances_at(psi, points[i], step, limit, steepest); });
  return out;
}

std::vector<SheetDistances> sheet_distances(ImplicitFunctionRef psi, const std::vector<Vec3>& points,
                                            const std::vector<double>& scale, double step, double limit,
                                            const Context& context, double steepest) {
  std::vector<SheetDistances> out(points.size());
  for_each_asking(psi, points.size(), kValuesPerPoll, context, [&](std::size_t i) {
    out[i] = sheet_distances_at(psi, points[i], step * scale[i], limit * scale[i], steepest);
  });
  return out;
}

std::vector<double> thickness(ImplicitFunctionRef psi, const std::vector<Vec3>& points, double step, double limit,
                              const Context& context, double steepest) {
  return least_of(sheet_distances(psi, points, step, limit, context, steepest));
}

std::vector<double> thickness(ImplicitFunctionRef psi, const std::vector<Vec3>& points,
                              const std::vector<double>& scale, double step, double limit, const Context& context,
                              double steepest) {
  return least_of(sheet_distances(psi, points, scale, step, limit, context, steepest));
}

}  // namespace umtet
