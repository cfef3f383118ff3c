#include "mesh/regions/region_domain.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

namespace umtet {
namespace {

/// The region of a point among bodies, the last one first.
int region_of_bodies(const std::vector<PatchFunction>& bodies, const Vec3& x) {
  for (std::size_t k = bodies.size(); k > 0; --k)
    if (bodies[k - 1](x, nullptr, nullptr) < 0) return static_cast<int>(k);
  return 0;
}

/// The nearest zero among the bodies that can be seen from x: its own body's, and those of later ones.
ActivePatch nearest_of_bodies(const std::vector<PatchFunction>& bodies, const Vec3& x) {
  ActivePatch nearest{std::numeric_limits<double>::infinity(), 0};
  for (std::size_t k = bodies.size(); k > 0; --k) {
    const double value = bodies[k - 1](x, nullptr, nullptr);
    if (std::abs(value) < std::abs(nearest.value)) nearest = {value, static_cast<int>(k) - 1};
    if (value < 0) break;
  }
  return nearest;
}

/// The least of the functions, and the one that comes next.
std::pair<std::size_t, std::size_t> two_least_of(const std::vector<PatchFunction>& functions, const Vec3& x,
                                                 double& difference) {
  std::size_t first = 0, second = 0;
  double least = std::numeric_limits<double>::infinity(), next = least;
  for (std::size_t k = 0; k < functions.size(); ++k) {
    const double value = functions[k](x, nullptr, nullptr);
    if (value < least) {
      next = least, second = first;
      least = value, first = k;
    } else if (value < next) {
      next = value, second = k;
    }
  }
  difference = next - least;
  return {first, second};
}

/// a - b.
PatchFunction difference_of(PatchFunction a, PatchFunction b) {
  return [a = std::move(a), b = std::move(b)](const Vec3& x, Vec3* gradient, Mat3* hessian) {
    Vec3 g;
    Mat3 H;
    const double value = a(x, gradient, hessian) - b(x, gradient ? &g : nullptr, hessian ? &H : nullptr);
    if (gradient) *gradient -= g;
    if (hessian) *hessian -= H;
    return value;
  };
}

std::size_t pair_index(std::size_t a, std::size_t b) { return a * (a - 1) / 2 + b; }  // a > b

PiecewiseDomain boundary_of(const std::vector<PatchFunction>& functions, bool has_bodies) {
  if (has_bodies)
    return PiecewiseDomain::of_patches(functions,
                                       [functions](const Vec3& x) { return nearest_of_bodies(functions, x); });
  std::vector<PatchFunction> differences;
  for (std::size_t a = 1; a < functions.size(); ++a)
    for (std::size_t b = 0; b < a; ++b) differences.push_back(difference_of(functions[a], functions[b]));
  return PiecewiseDomain::of_patches(std::move(differences), [functions](const Vec3& x) {
    double difference;
    const auto [first, second] = two_least_of(functions, x, difference);
    const std::size_t a = std::max(first, second), b = std::min(first, second);
    return ActivePatch{first == a ? -difference : difference, static_cast<int>(pair_index(a, b))};
  });
}

}  // namespace

RegionDomain::RegionDomain(std::vector<PatchFunction> functions, bool has_bodies)
    : functions_(std::move(functions)),
      has_bodies_(has_bodies),
      n_regions_(static_cast<int>(functions_.size()) + (has_bodies ? 1 : 0)),
      patch_of_(static_cast<std::size_t>(n_regions_) * static_cast<std::size_t>(n_regions_), -1),
      boundary_(boundary_of(functions_, has_bodies)) {
  const auto n = static_cast<std::size_t>(n_regions_);
  for (std::size_t a = 1; a < n; ++a)
    for (std::size_t b = 0; b < a; ++b)
      patch_of_[a * n + b] = patch_of_[b * n + a] = static_cast<int>(has_bodies ? a - 1 : pair_index(a, b));
}

RegionDomain RegionDomain::of_bodies(std::vector<PatchFunction> bodies) {
  if (bodies.empty() || bodies.size() >= kMostRegions)
    throw std::invalid_argument("1 to " + std::to_string(kMostRegions - 1) + " bodies");
  return {std::move(bodies), true};
}

RegionDomain RegionDomain::of_least(std::vector<PatchFunction> functions) {
  if (functions.size() < 2 || functions.size() > kMostRegions)
    throw std::invalid_argument("2 to " + std::to_string(kMostRegions) + " functions");
  return {std::move(functions), false};
}

RegionDomain RegionDomain::in_coordinates(const Vec3& origin, const Vec3& scale) const {
  std::vector<PatchFunction> functions;
  functions.reserve(functions_.size());
  for (const PatchFunction& f : functions_)
    functions.emplace_back([f, origin, scale](const Vec3& y, Vec3* gradient, Mat3* hessian) {
      const double value = f(origin + scale.cwiseProduct(y), gradient, hessian);
      if (gradient) *gradient = gradient->cwiseProduct(scale);
      if (hessian) *hessian = scale.asDiagonal() * *hessian * scale.asDiagonal();
      return value;
    });
  return {std::move(functions), has_bodies_};
}

int RegionDomain::region(const Vec3& x) const {
  if (has_bodies_) return region_of_bodies(functions_, x);
  double difference;
  return static_cast<int>(two_least_of(functions_, x, difference).first);
}

}  // namespace umtet
