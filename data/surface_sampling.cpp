#include "data/surface_sampling.h"

#include <algorithm>
#include <cmath>
#include <queue>
#include <stdexcept>
#include <utility>
#include <vector>

namespace umtet {
namespace {

constexpr std::size_t kCandidatesPerSample = 10;  // from Yuksel's study: more gain little
constexpr double kActiveLayer = 0.02;             // half thickness of the layer candidates are drawn from, model units
constexpr int kNewtonSteps = 12;
constexpr double kLeastSlope = 0.2;  // |grad f| on the surface; the shapes have about 1

// Written out, since Eigen may add in another order on another instruction set.
double norm(const Vec3& v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

Dual evaluate(ShapeFunction f, const Vec3& x) {
  return f(Dual(x[0], 1, 0, 0), Dual(x[1], 0, 1, 0), Dual(x[2], 0, 0, 1));
}

Vec3 gradient(const Dual& f) { return {f.dx, f.dy, f.dz}; }

struct Candidates {
  OrientedPointCloud cloud;
  double density_integral = 0;  // of density over the surface
};

/// Moves x along grad f to the surface; returns the unit normal there.
Vec3 project(ShapeFunction f, Vec3& x) {
  for (int step = 0; step < kNewtonSteps; ++step) {
    const Dual at = evaluate(f, x);
    const Vec3 g = gradient(at);
    const double slope = norm(g);
    if (std::abs(at.value) < 1e-15 * slope) break;
    x -= at.value / slope / slope * g;
  }
  const Dual at = evaluate(f, x);
  const Vec3 g = gradient(at);
  const double slope = norm(g);
  if (!(slope > kLeastSlope) || !(std::abs(at.value) < 1e-12 * slope))
    throw std::runtime_error("a random point did not reach the surface: f is no good near it");
  return g / slope;
}

/// Points uniform in volume in the layer |f| < kActiveLayer |grad f|, projected: uniform in area up to curvature
/// squared.
Candidates draw_candidates(ShapeFunction f, const Vec3& low, const Vec3& high, std::size_t n, Density density,
                           Uniform& uniform) {
  const Vec3 size = high - low;
  Candidates drawn;
  std::size_t n_tries = 0;
  while (drawn.cloud.points.size() < n) {
    if (++n_tries > 100000 + 10000 * n) throw std::runtime_error("no surface in the box");
    Vec3 x;
    for (int a = 0; a < 3; ++a) x[a] = low[a] + uniform() * size[a];
    const double lot = uniform();
    const Dual at = evaluate(f, x);
    if (std::abs(at.value) >= kActiveLayer * norm(gradient(at))) continue;
    const Vec3 normal = project(f, x);
    if (lot >= density(x)) continue;
    drawn.cloud.points.push_back(x);
    drawn.cloud.normals.push_back(normal);
  }
  const double hit_rate = static_cast<double>(n) / static_cast<double>(n_tries);
  drawn.density_integral = hit_rate * size[0] * size[1] * size[2] / (2 * kActiveLayer);
  return drawn;
}

/// Points by cubic cell of a box around them.
class CellLists {
 public:
  CellLists(const std::vector<Vec3>& points, double size) : low_(points.front()), size_(size) {
    Vec3 high = low_;
    for (const Vec3& x : points) {
      low_ = low_.cwiseMin(x);
      high = high.cwiseMax(x);
    }
    for (int a = 0; a < 3; ++a) n_[a] = coordinate(high, a) + 1;
    cells_.resize(static_cast<std::size_t>(n_[0] * n_[1] * n_[2]));
    for (std::size_t i = 0; i < points.size(); ++i)
      cells_[index(coordinate(points[i], 0), coordinate(points[i], 1), coordinate(points[i], 2))].push_back(i);
  }

  /// Calls visit(j) for all points nearer than one cell size, and some more.
  template <class Visit>
  void for_each_around(const Vec3& x, Visit visit) const {
    long first[3], last[3];
    for (int a = 0; a < 3; ++a) {
      first[a] = std::max(coordinate(x, a) - 1, 0L);
      last[a] = std::min(coordinate(x, a) + 1, n_[a] - 1);
    }
    for (long p = first[0]; p <= last[0]; ++p)
      for (long q = first[1]; q <= last[1]; ++q)
        for (long r = first[2]; r <= last[2]; ++r)
          for (const std::size_t j : cells_[index(p, q, r)]) visit(j);
  }

 private:
  long coordinate(const Vec3& x, int a) const { return static_cast<long>((x[a] - low_[a]) / size_); }
  std::size_t index(long p, long q, long r) const { return static_cast<std::size_t>((p * n_[1] + q) * n_[2] + r); }

  Vec3 low_;
  double size_;
  long n_[3] = {0, 0, 0};
  std::vector<std::vector<std::size_t>> cells_;
};

/// Pairs of points closer than the sum of their radii, as lists per point: partner and weight.
class Crowding {
 public:
  Crowding(const std::vector<Vec3>& points, const std::vector<double>& radii);

  struct Pair {
    std::size_t partner;
    double weight;
  };
  const std::vector<Pair>& pairs(std::size_t i) const { return pairs_[i]; }

 private:
  std::vector<std::vector<Pair>> pairs_;
};

Crowding::Crowding(const std::vector<Vec3>& points, const std::vector<double>& radii) : pairs_(points.size()) {
  const double reach = 2 * *std::max_element(radii.begin(), radii.end());
  const CellLists cells(points, reach);
  for (std::size_t i = 0; i < points.size(); ++i) {
    cells.for_each_around(points[i], [&](std::size_t j) {
      if (j <= i) return;
      const double closeness = 1 - norm(points[j] - points[i]) / (radii[i] + radii[j]);
      if (closeness <= 0) return;
      const double c2 = closeness * closeness, c4 = c2 * c2;
      pairs_[i].push_back({j, c4 * c4});
      pairs_[j].push_back({i, c4 * c4});
    });
  }
}

/// Removes the most crowded point until n are left; true = kept.
std::vector<bool> eliminate(const Crowding& crowding, std::size_t n_all, std::size_t n) {
  std::vector<double> weight(n_all, 0.0);
  using Entry = std::pair<double, std::size_t>;  // no two are equal, so the order does not hang on the queue's inside
  std::priority_queue<Entry> queue;
  for (std::size_t i = 0; i < n_all; ++i) {
    for (const Crowding::Pair& p : crowding.pairs(i)) weight[i] += p.weight;
    queue.emplace(weight[i], i);
  }
  std::vector<bool> kept(n_all, true);
  for (std::size_t left = n_all; left > n;) {
    const auto [queued_weight, i] = queue.top();
    queue.pop();
    if (queued_weight != weight[i]) {  // partners have gone since: back into the queue with what is left
      queue.emplace(weight[i], i);
      continue;
    }
    kept[i] = false;
    --left;
    for (const Crowding::Pair& p : crowding.pairs(i)) weight[p.partner] -= p.weight;
  }
  return kept;
}

}  // namespace

OrientedPointCloud sample_surface(ShapeFunction f, const Vec3& low, const Vec3& high, std::size_t n, std::uint64_t seed,
                                  Density density) {
  Uniform uniform(seed);
  const Candidates drawn = draw_candidates(f, low, high, kCandidatesPerSample * n, density, uniform);
  const std::vector<Vec3>& points = drawn.cloud.points;

  // Discs of radius r packed hexagonally take 2 sqrt(3) r^2 each; here one takes 1 / (points per area).
  std::vector<double> radii(points.size());
  const double area_times_density = drawn.density_integral / static_cast<double>(n);
  for (std::size_t i = 0; i < points.size(); ++i)
    radii[i] = std::sqrt(area_times_density / density(points[i]) / (2 * std::sqrt(3.0)));

  const std::vector<bool> kept = eliminate(Crowding(points, radii), points.size(), n);
  OrientedPointCloud cloud;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!kept[i]) continue;
    cloud.points.push_back(points[i]);
    cloud.normals.push_back(drawn.cloud.normals[i]);
  }
  return cloud;
}

}  // namespace umtet
