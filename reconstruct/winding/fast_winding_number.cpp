#include "reconstruct/winding/fast_winding_number.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "common/formatted.h"

namespace umtet {
namespace {

// Numbers of samples have 32 bits.
constexpr std::size_t kMostSamples = std::size_t{1} << 31;
// Samples of a leaf, at most: a series costs as much as about six.
constexpr std::uint32_t kLeaf = 8;

/// sum T_ijk d_i d_j d_k of a symmetric T, and the vector T_ijk d_j d_k.
struct Cubic {
  Vec3 slope, trace_vector;
  double value, trace;  ///< trace: T_iij d_j
};

Cubic cubic(const std::array<double, 10>& t, const Vec3& d) {
  const auto& [xxx, yyy, zzz, xxy, xxz, xyy, yyz, xzz, yzz, xyz] = t;
  const double x = d.x(), y = d.y(), z = d.z();
  const Vec3 slope(xxx * x * x + xyy * y * y + xzz * z * z + 2 * (xxy * x * y + xxz * x * z + xyz * y * z),
                   xxy * x * x + yyy * y * y + yzz * z * z + 2 * (xyy * x * y + xyz * x * z + yyz * y * z),
                   xxz * x * x + yyz * y * y + zzz * z * z + 2 * (xyz * x * y + xzz * x * z + yzz * y * z)),
      trace(xxx + xyy + xzz, xxy + yyy + yzz, xxz + yyz + zzz);
  return {slope, trace, slope.dot(d), trace.dot(d)};
}

}  // namespace

std::vector<std::string> problems(const WindingNumberParams& params) {
  std::vector<std::string> found;
  if (!(params.beta > 1)) found.push_back(formatted("beta = %g: must be > 1", params.beta));
  if (!(params.softening >= 0 && std::isfinite(params.softening)))
    found.push_back(formatted("softening = %g: must be >= 0", params.softening));
  return found;
}

FastWindingNumber::FastWindingNumber(const std::vector<Vec3>& points, const std::vector<Vec3>& normals,
                                     const std::vector<double>& areas, const WindingNumberParams& params)
    : beta_(params.beta) {
  if (const auto found = problems(params); !found.empty()) throw std::invalid_argument(joined(found, "; "));
  if (points.empty() || points.size() >= kMostSamples || areas.size() != points.size())
    throw std::invalid_argument(
        formatted("%zu points and %zu areas: must be as many, at least one, below 2^31", points.size(), areas.size()));
  samples_.resize(points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite()) throw std::invalid_argument(formatted("points[%u] is not finite", i));
    if (!(areas[i] >= 0 && std::isfinite(areas[i])))
      throw std::invalid_argument(formatted("areas[%u] = %g: must be >= 0 and finite", i, areas[i]));
    samples_[i] = {points[i], Vec3::Zero(), areas[i], 0, 0, i};
  }
  nodes_.reserve(points.size() / 2 + 1);
  grow_sample_tree(samples_, nodes_, kLeaf, 0, static_cast<std::uint32_t>(points.size()));
  tbb::parallel_for(std::size_t{0}, nodes_.size(), [&](std::size_t n) { find_ball(nodes_[n]); });
  set_softening(params.softening);
  set_normals(normals);
}

void FastWindingNumber::find_ball(Node& node) const {
  double area = 0;
  Vec3 sum = Vec3::Zero();
  const Vec3& origin = samples_[node.first].x;
  for (std::uint32_t i = node.first; i < node.last; ++i) {
    area += samples_[i].area;
    sum += samples_[i].area * (samples_[i].x - origin);
  }
  node.centre = area > 0 ? Vec3(origin + sum / area) : origin;
  double radius2 = 0;
  for (std::uint32_t i = node.first; i < node.last; ++i)
    radius2 = std::max(radius2, (samples_[i].x - node.centre).squaredNorm());
  node.radius = std::sqrt(radius2);
}

void FastWindingNumber::set_softening(double softening) {
  if (const auto found = problems({.beta = beta_, .softening = softening}); !found.empty())
    throw std::invalid_argument(found.front());
  for (Sample& s : samples_) s.softening = softening * std::sqrt(s.area / std::numbers::pi);
  for (std::size_t n = nodes_.size(); n-- > 0;) {
    Node& node = nodes_[n];
    double widest = 0;
    for (std::uint32_t i = node.first; i < node.last; ++i) widest = std::max(widest, samples_[i].softening);
    node.far = std::max(node.radius > 0 ? beta_ * node.radius : 0, node.radius + widest);
  }
}

void FastWindingNumber::find_moments(Node& node) const {
  node.charge = 0;
  node.dipole = Vec3::Zero();
  node.second = {};
  node.third = {};
  for (std::uint32_t i = node.first; i < node.last; ++i) {
    const double charge = samples_[i].charge;
    const Vec3 d = samples_[i].x - node.centre;
    node.charge += charge;
    node.dipole += samples_[i].moment + charge * d;
    Vec3 m = samples_[i].moment + charge / 2 * d;
    for (int a = 0; a < 3; ++a) node.second[a] += d[a] * m[a];
    node.second[3] += (d[0] * m[1] + d[1] * m[0]) / 2;
    node.second[4] += (d[0] * m[2] + d[2] * m[0]) / 2;
    node.second[5] += (d[1] * m[2] + d[2] * m[1]) / 2;
    m = samples_[i].moment + charge / 3 * d;
    const auto symmetric = [&](int a, int b, int c) {
      return (d[a] * d[b] * m[c] + d[a] * d[c] * m[b] + d[b] * d[c] * m[a]) / 6;
    };
    node.third[0] += symmetric(0, 0, 0);
    node.third[1] += symmetric(1, 1, 1);
    node.third[2] += symmetric(2, 2, 2);
    node.third[3] += symmetric(0, 0, 1);
    node.third[4] += symmetric(0, 0, 2);
    node.third[5] += symmetric(0, 1, 1);
    node.third[6] += symmetric(1, 1, 2);
    node.third[7] += symmetric(0, 2, 2);
    node.third[8] += symmetric(1, 2, 2);
    node.third[9] += symmetric(0, 1, 2);
  }
}

void FastWindingNumber::update_moments() {
  tbb::parallel_for(std::size_t{0}, nodes_.size(), [&](std::size_t n) { find_moments(nodes_[n]); });
}

void FastWindingNumber::set_normals(const std::vector<Vec3>& normals) {
  if (normals.size() != samples_.size())
    throw std::invalid_argument(
        formatted("%zu points but %zu normals: must be equal", samples_.size(), normals.size()));
  for (std::size_t i = 0; i < normals.size(); ++i)
    if (!normals[i].allFinite()) throw std::invalid_argument(formatted("normals[%zu] is not finite", i));
  for (Sample& s : samples_) {
    s.moment = s.area * normals[s.number];
    s.charge = 0;
  }
  update_moments();
}

void FastWindingNumber::set_charges(const std::vector<double>& charges) {
  if (charges.size() != samples_.size())
    throw std::invalid_argument(
        formatted("%zu points but %zu charges: must be equal", samples_.size(), charges.size()));
  for (std::size_t i = 0; i < charges.size(); ++i)
    if (!std::isfinite(charges[i])) throw std::invalid_argument(formatted("charges[%zu] is not finite", i));
  for (Sample& s : samples_) {
    s.moment = Vec3::Zero();
    s.charge = s.area * charges[s.number];
  }
  update_moments();
}

double FastWindingNumber::evaluate(const Vec3& x, Vec3* gradient) const {
  double w = 0;
  Vec3 slope = Vec3::Zero();  // by the places of the samples: minus the gradient
  std::array<std::uint32_t, kDeepestSampleTree> stack;
  std::size_t depth = 0;
  stack[depth++] = 0;
  while (depth > 0) {
    const std::uint32_t number = stack[--depth];
    const Node& node = nodes_[number];
    const Vec3 r = node.centre - x;
    const double r2 = r.squaredNorm();
    if (r2 > node.far * node.far) {
      const double q2 = 1 / r2, q3 = q2 * std::sqrt(q2), q5 = q3 * q2, q7 = q5 * q2;
      const auto& [xx, yy, zz, xy, xz, yz] = node.second;
      const Vec3 m_r(xx * r[0] + xy * r[1] + xz * r[2], xy * r[0] + yy * r[1] + yz * r[2],
                     xz * r[0] + yz * r[1] + zz * r[2]);
      const double p = node.dipole.dot(r), m = m_r.dot(r), trace = xx + yy + zz;
      const Cubic t = cubic(node.third, r);
      w += p * q3 + (trace * q3 - 3 * m * q5) + (15 * t.value * q7 - 9 * t.trace * q5);
      if (gradient) {
        const double q9 = q7 * q2;
        slope += node.charge * q3 * r + q3 * node.dipole - 6 * q5 * m_r + 45 * q7 * t.slope - 9 * q5 * t.trace_vector +
                 (-3 * p * q5 - 3 * trace * q5 + 15 * m * q7 - 105 * t.value * q9 + 45 * t.trace * q7) * r;
      }
    } else if (node.right > 0) {
      stack[depth++] = node.right;
      stack[depth++] = number + 1;
    } else {
      for (std::uint32_t i = node.first; i < node.last; ++i) {
        const Sample& s = samples_[i];
        const Vec3 d = s.x - x;
        const double d2 = d.squaredNorm(), p = s.moment.dot(d), e2 = s.softening * s.softening;
        if (!(d2 > 0) && !(e2 > 0)) continue;  // a point is on neither of its sides
        const bool is_near = d2 < e2;
        const double g = is_near ? (5 - 3 * d2 / e2) / (2 * e2 * s.softening) : 1 / (d2 * std::sqrt(d2));
        w += p * g;
        if (gradient)
          slope += s.charge * g * d + g * s.moment - 3 * p * (is_near ? 1 / (e2 * e2 * s.softening) : g / d2) * d;
      }
    }
  }
  if (gradient) *gradient = -slope / (4 * std::numbers::pi);
  return w / (4 * std::numbers::pi);
}

std::vector<double> FastWindingNumber::evaluate(const std::vector<Vec3>& places, std::vector<Vec3>* gradients) const {
  std::vector<double> w(places.size());
  if (gradients) gradients->resize(places.size());
  tbb::parallel_for(std::size_t{0}, places.size(),
                    [&](std::size_t i) { w[i] = evaluate(places[i], gradients ? &(*gradients)[i] : nullptr); });
  return w;
}

}  // namespace umtet
