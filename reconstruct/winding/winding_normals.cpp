#include "reconstruct/winding/winding_normals.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "reconstruct/cloud/neighbours/neighbour_tree.h"
#include "reconstruct/winding/fast_winding_number.h"

namespace umtet {
namespace {

// w jumps by one across the surface.
constexpr double kOff = 0.25;
// A patch reaches so many deviations of the noise, which holds nearly all of it, and so many spacings: 7 samples of a
// clean cloud, and 20 or more where noise of a spacing puts w at single samples off by a half.
constexpr double kDeviations = 3, kSpacings = 1.5;
// The jump is taken where neither the noise (deviations) nor single samples (spacings) show, at so many samples, whose
// median is then known to 2 %.
constexpr double kJumpDeviations = 2.5;
constexpr std::size_t kJumps = 1000;

double median(std::vector<double> v) {
  const auto middle = v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2);
  std::nth_element(v.begin(), middle, v.end());
  return *middle;
}

/// Outward, unit; zero where the field is.
std::vector<Vec3> normals_of(const FastWindingNumber& w, const std::vector<Vec3>& places) {
  std::vector<Vec3> normals;
  w.evaluate(places, &normals);
  for (Vec3& n : normals) n = -n.normalized();
  return normals;
}

}  // namespace

std::vector<Vec3> winding_normals(const std::vector<Vec3>& points, const std::vector<double>& areas,
                                  const WindingNormalsParams& params) {
  std::vector<Vec3> v(points.size(), Vec3::Zero()), step;
  FastWindingNumber w(points, v, areas);
  for (int round = 0; round < params.rounds; ++round) {
    const double left = params.rounds > 1 ? 1 - round / (params.rounds - 1.) : 0;
    w.set_softening(params.narrowest + left * (params.widest - params.narrowest));
    w.set_normals(v);
    std::vector<double> rest = w.evaluate(points);
    for (double& r : rest) r = 0.5 - r;
    w.set_charges(rest);
    w.evaluate(points, &step);
    w.set_normals(step);
    const std::vector<double> change = w.evaluate(points);
    double along = 0, change2 = 0;
    for (std::size_t i = 0; i < v.size(); ++i) {
      along += areas[i] * rest[i] * change[i];
      change2 += areas[i] * change[i] * change[i];
    }
    if (change2 > 0)
      for (std::size_t i = 0; i < v.size(); ++i) v[i] += along / change2 * step[i];
    w.set_normals(v);
    const std::vector<Vec3> normals = normals_of(w, points);
    for (std::size_t i = 0; i < v.size(); ++i) v[i] = v[i].norm() * normals[i];
  }
  for (Vec3& n : v) n.normalize();
  return v;
}

double off_a_half(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, const std::vector<double>& areas,
                  double softening) {
  const FastWindingNumber w(points, normals, areas, {.softening = softening});
  std::size_t n_off = 0;
  for (const double value : w.evaluate(points)) n_off += std::abs(value - 0.5) > kOff ? 1 : 0;
  return static_cast<double>(n_off) / static_cast<double>(points.size());
}

double patches_off_a_half(const std::vector<Vec3>& points, const std::vector<Vec3>& normals,
                          const std::vector<double>& areas, double noise) {
  const FastWindingNumber w(points, normals, areas, {.softening = WindingNormalsParams{}.narrowest});
  const std::size_t n = points.size();
  const double spacing = std::sqrt(median(areas)), away = spacing + kJumpDeviations * noise;
  std::vector<double> jumps;
  for (std::size_t i = 0; i < n; i += std::max<std::size_t>(1, n / kJumps))
    jumps.push_back(w(points[i] - away * normals[i]) - w(points[i] + away * normals[i]));
  const double jump = std::max(1., median(std::move(jumps))),
               reach = std::hypot(kDeviations * noise, kSpacings * spacing);
  const std::vector<double> values = w.evaluate(points);
  const NeighbourTree tree(points);
  std::vector<std::uint8_t> is_off(n);
  tbb::parallel_for(std::size_t{0}, n, [&](std::size_t i) {
    std::vector<std::uint32_t> patch;
    tree.within(points[i], reach * reach, [&](std::uint32_t j, double) {
      if (j == i || normals[i].dot(normals[j]) > 0) patch.push_back(j);
    });
    std::sort(patch.begin(), patch.end());  // the search gives them in no order, and sums depend on it
    double sum = 0;
    for (const std::uint32_t j : patch) sum += values[j];
    is_off[i] = std::abs(sum / (jump * static_cast<double>(patch.size())) - 0.5) > kOff ? 1 : 0;
  });
  return static_cast<double>(std::count(is_off.begin(), is_off.end(), 1)) / static_cast<double>(n);
}

std::vector<Vec3> normals_by_winding(const std::vector<Vec3>& points, const std::vector<double>& areas,
                                     const std::vector<Vec3>& places, const WindingNormalsParams& params) {
  return normals_of({points, winding_normals(points, areas, params), areas, {.softening = params.narrowest}}, places);
}

}  // namespace umtet
