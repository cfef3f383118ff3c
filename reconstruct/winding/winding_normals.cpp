#include "reconstruct/winding/winding_normals.h"

#include <array>
#include <cmath>
#include <stdexcept>

#include "common/formatted.h"
#include "reconstruct/cloud/cloud_neighbours.h"
#include "reconstruct/winding/fast_winding_number.h"

namespace umtet {
namespace {

// Samples that check, and that decide at first. A cloud that has no more is sparse: its parts are a few samples across,
// and neighbours tell directions worse than the field does.
constexpr std::size_t kChecked = 4000;
// w jumps by one across the surface.
constexpr double kOff = 0.25;
// Right normals have fewer of their samples off, with this softening or, where noise puts samples off, a wider one.
constexpr double kMostOff = 0.02, kWider = 3;
// So have those of a closed surface with thin parts.
constexpr double kClosed = 0.04;
// Others have to be off at this share of that, at most, before given or estimated ones are overruled.
constexpr double kBetter = 0.75;
// Where more samples than this are off, the next attempt, with more of them, knows better.
constexpr double kUnsettled = 0.1;
// Cosine of the angle from which on an estimated direction is not believed: that of a fit to both sheets of a thin
// part.
constexpr double kContradiction = 0.7;

struct Attempt {
  std::size_t n_samples;
  WindingNormalsParams params;
};
// Clean samples and parts as thin as those of so few are apart; noise of a spacing, and thinner parts.
constexpr std::array<Attempt, 2> kAttempts = {Attempt{kChecked, {}},
                                              Attempt{16000, {.rounds = 10, .widest = 4, .narrowest = 2}}};

/// Every m-th of them: `most`, or fewer.
std::vector<Vec3> at_most(const std::vector<Vec3>& all, std::size_t most) {
  const std::size_t m = (all.size() + most - 1) / most;
  std::vector<Vec3> some;
  for (std::size_t i = 0; i < all.size(); i += m) some.push_back(all[i]);
  return some;
}

struct Part {
  std::vector<Vec3> points, normals;
  std::vector<double> areas;
  Part(const OrientedPointCloud& cloud, std::size_t most)
      : points(at_most(cloud.points, most)), normals(at_most(cloud.normals, most)), areas(sample_areas(points)) {}
};

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

bool WindingReport::is_closed() const { return off_after <= kClosed; }

WindingReport orient_by_winding(OrientedPointCloud& cloud, const OrientByWinding& how) {
  const std::vector<Vec3>* const others = how.others;
  if (others && others->size() != cloud.points.size())
    throw std::invalid_argument(
        formatted("%zu points but %zu other normals: must be equal", cloud.points.size(), others->size()));
  WindingReport report;
  {
    const Part part(cloud, kChecked);
    report.off_before = report.off_after = off_a_half(part.points, part.normals, part.areas);
    if (report.off_before <= kMostOff) return report;
    if (off_a_half(part.points, part.normals, part.areas, kWider) <= kMostOff) return report;
    if (others) {
      const double off = off_a_half(part.points, at_most(*others, kChecked), part.areas);
      if (off < report.off_before) {
        cloud.normals = *others;
        report.restored = true;
        report.off_before = report.off_after = off;
      }
    }
  }
  if (how.only_others) return report;
  std::vector<Vec3> best;  // of all points
  for (const auto& [n_samples, params] : kAttempts) {
    const Part part(cloud, n_samples);
    const FastWindingNumber w(part.points, winding_normals(part.points, part.areas, params), part.areas,
                              {.softening = params.narrowest});
    const double before = off_a_half(part.points, part.normals, part.areas, params.narrowest),
                 after = off_a_half(part.points, normals_of(w, part.points), part.areas, params.narrowest);
    if (after < kBetter * before) {
      best = normals_of(w, cloud.points);
      report.off_before = before;
      report.off_after = after;
    }
    if (after <= kUnsettled || cloud.points.size() <= n_samples) break;
  }
  if (best.empty()) return report;
  report.taken = true;
  const bool is_sparse = cloud.points.size() <= kChecked;
  for (std::size_t i = 0; i < best.size(); ++i) {
    Vec3& n = cloud.normals[i];
    const double cosine = n.dot(best[i]);
    if (n.isZero(0) || best[i].isZero(0)) continue;
    report.n_turned += cosine < 0 ? 1 : 0;
    if (how.directions_may_change && (is_sparse || std::abs(cosine) < kContradiction)) {
      n = best[i];
      ++report.n_replaced;
    } else if (cosine < 0) {
      n = -n;
    }
  }
  return report;
}

}  // namespace umtet
