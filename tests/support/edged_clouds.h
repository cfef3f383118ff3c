#pragma once

// Samples of bodies with sharp edges, with the patch of each sample.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <random>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "mesh/features/feature_graph.h"
#include "reconstruct/cloud/neighbours/cloud_neighbours.h"
#include "reconstruct/patches/sample_patches.h"
#include "tests/support/piecewise_bodies.h"

namespace umtet::testing {

/// A torus around the z axis of radii 1 and r, by the distance from its circle.
inline PiecewiseDomain torus_at(const Placement& at, double r) {
  return PiecewiseDomain([at, r](const Vec3& x, Vec3* g, Mat3* H) {
    const Vec3 d = at.rotation.transpose() * (x - at.offset);
    const double rho = d.head<2>().norm();
    const Vec3 radial(d.x() / rho, d.y() / rho, 0), from = d - radial;
    const double distance = from.norm();
    if (g) *g = at.rotation * (from / distance);
    if (H) H->setZero();  // not used by who traces
    return distance - r;
  });
}

/// Bodies of piecewise_body(), and "half-torus", "bracket" (a plate with two holes and a rib), "prism" (edges of 63,
/// 99, 108, 135 degrees, some along a cylinder).
inline PiecewiseDomain edged_domain_of(const std::string& name, const Placement& at) {
  const Vec3 x = Vec3::UnitX(), y = Vec3::UnitY(), z = Vec3::UnitZ();
  const auto slab = [&](const Vec3& n, double low, double high) {
    return intersection(half_space(at, n, high), half_space(at, -n, -low));
  };
  if (name == "half-torus") return intersection(torus_at(at, .4), half_space(at, y, .1));
  if (name == "bracket") {
    PiecewiseDomain plate = intersection(intersection(slab(x, -1, 1), slab(y, -.7, .7)), slab(z, -.15, .15));
    for (const double where : {-.55, .55}) {
      Placement hole = at;
      hole.offset += at.rotation * (where * x);
      plate = intersection(plate, complement(pipe_at(hole, .25)));
    }
    return united(plate, intersection(intersection(slab(x, -.1, .1), slab(y, -.45, .45)), slab(z, -.05, .7)));
  }
  if (name == "prism") {
    PiecewiseDomain body = slab(z, -.6, .6);
    double angle = 0;
    for (const double turn : {117., 45., 72., 45., 81.}) {
      body = intersection(body, half_space(at, {std::cos(angle), std::sin(angle), 0}, .8));
      angle += turn * std::numbers::pi / 180;
    }
    Placement side = at;
    side.offset += at.rotation * Vec3(-.3, 0, 0);
    return intersection(body, pipe_at(side, .95));
  }
  return piecewise_body(name, at).domain;
}

/// Samples of a body.
struct EdgedCloud {
  std::vector<Vec3> points, normals;  ///< with noise
  std::vector<Vec3> exact;            ///< without
  SamplePatches patches;              ///< labels of the truth; borders where true curves are
  FeatureGraph truth;                 ///< patches in it are numbers of these labels
  std::vector<int> domain_patch;      ///< the patch of the domain of each label
  double diagonal = 0;
};

namespace detail {

/// The first n of some points that keep a distance from all before, with the largest distance that leaves n.
inline std::vector<std::size_t> spread_points(const std::vector<Vec3>& points, std::size_t n) {
  Eigen::AlignedBox3d box;
  for (const Vec3& x : points) box.extend(x);
  double low = 0, high = box.diagonal().norm();
  std::vector<std::size_t> best;
  for (int k = 0; k < 25; ++k) {
    const double r = (low + high) / 2;
    std::unordered_multimap<std::int64_t, std::size_t> grid;
    const auto key = [](std::int64_t i, std::int64_t j, std::int64_t l) { return (l * 2097152 + j) * 2097152 + i; };
    std::vector<std::size_t> kept;
    for (std::size_t i = 0; i < points.size() && kept.size() < n; ++i) {
      const Eigen::Array3d at = ((points[i] - box.min()) / r).array().floor() + 1;
      const std::int64_t a = static_cast<std::int64_t>(at[0]), b = static_cast<std::int64_t>(at[1]),
                         c = static_cast<std::int64_t>(at[2]);
      bool is_free = true;
      for (std::int64_t d = 0; d < 27 && is_free; ++d) {
        const auto [from, to] = grid.equal_range(key(a + d % 3 - 1, b + d / 3 % 3 - 1, c + d / 9 - 1));
        for (auto it = from; it != to; ++it) is_free = is_free && (points[it->second] - points[i]).norm() >= r;
      }
      if (!is_free) continue;
      grid.emplace(key(a, b, c), i);
      kept.push_back(i);
    }
    if (kept.size() == n) {
      best = kept;
      low = r;
    } else {
      high = r;
    }
  }
  return best;
}

}  // namespace detail

/// @param noise    standard deviation of the positions along each axis, as a share of the diagonal
/// @param tilt_deg of the normals
inline EdgedCloud edged_cloud(const PiecewiseDomain& domain, double radius, const Placement& at, std::size_t n,
                              double noise, double tilt_deg, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  std::normal_distribution<double> gauss;
  constexpr int kSteps = 60, kDarts = 8;
  std::vector<Vec3> darts;
  while (darts.size() < kDarts * n) {
    const Vec3 d = Vec3(gauss(random), gauss(random), gauss(random)).normalized(), u = d.unitOrthogonal();
    const double r = radius * std::sqrt(unit(random)), angle = 2 * std::numbers::pi * unit(random);
    const Vec3 start = at.offset + r * (std::cos(angle) * u + std::sin(angle) * d.cross(u)) - radius * d;
    double t0 = 0, before = domain.value(start);
    for (int s = 1; s <= kSteps; ++s) {
      const double t1 = 2 * radius * s / kSteps, after = domain.value(start + t1 * d);
      if ((before < 0) != (after < 0)) {
        double low = t0, high = t1;
        for (int k = 0; k < 45; ++k)
          ((domain.value(start + (low + high) / 2 * d) < 0) == (before < 0) ? low : high) = (low + high) / 2;
        darts.push_back(start + low * d);
      }
      t0 = t1, before = after;
    }
  }
  EdgedCloud cloud;
  for (const std::size_t i : detail::spread_points(darts, n)) cloud.exact.push_back(darts[i]);
  Eigen::AlignedBox3d box;
  for (const Vec3& x : cloud.exact) box.extend(at.rotation.transpose() * (x - at.offset));
  cloud.diagonal = box.diagonal().norm();
  std::map<int, int> label;
  for (const Vec3& x : cloud.exact) {
    const auto [at, is_new] = label.try_emplace(domain.active(x), static_cast<int>(label.size()));
    if (is_new) cloud.domain_patch.push_back(at->first);
    cloud.patches.patch.push_back(at->second);
    const Vec3 normal = domain.gradient(x).normalized();
    const double tilt = std::tan(tilt_deg * std::numbers::pi / 180) / std::numbers::sqrt2;
    const auto noisy = [&] { return Vec3(gauss(random), gauss(random), gauss(random)); };
    cloud.points.push_back(x + noise * cloud.diagonal * noisy());
    cloud.normals.push_back((normal + tilt * noisy()).normalized());
  }
  cloud.patches.count = static_cast<int>(label.size());
  cloud.patches.normals = cloud.normals;
  cloud.patches.noise = noise * cloud.diagonal;
  cloud.patches.spacing = sample_spacing(neighbour_distances(cloud.exact, kAreaNeighbours));
  cloud.truth = trace_features(domain, cloud.exact, cloud.patches.spacing);
  std::map<std::pair<int, int>, SamplePatches::Border> borders;
  for (FeatureCurve& c : cloud.truth.curves) {
    for (int& p : c.patches) p = label.at(p);
    std::sort(c.patches.begin(), c.patches.end());
    auto& border = borders[{c.patches[0], c.patches[1]}];
    border.a = c.patches[0], border.b = c.patches[1], border.sharp = true;
    border.length += c.length();
    border.angle = std::abs(180 - c.angle_deg[c.angle_deg.size() / 2]) * std::numbers::pi / 180;
  }
  for (FeatureCorner& c : cloud.truth.corners) {
    for (int& p : c.patches) p = label.at(p);
    std::sort(c.patches.begin(), c.patches.end());
  }
  for (const auto& [pair, border] : borders) cloud.patches.borders.push_back(border);
  return cloud;
}

/// Samples of edged_domain_of() in a random place.
inline EdgedCloud edged_cloud(const std::string& name, std::size_t n, double noise, double tilt_deg, unsigned seed,
                              PiecewiseDomain* truth = nullptr) {
  const Placement at = random_placement(seed, 1);
  const PiecewiseDomain domain = edged_domain_of(name, at);
  if (truth) *truth = domain;
  return edged_cloud(domain, 2, at, n, noise, tilt_deg, seed);
}

}  // namespace umtet::testing
