#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "mesh/core/piecewise_domain.h"

namespace umtet::testing {

/// A rotation and an offset of a body.
struct Placement {
  Mat3 rotation = Mat3::Identity();
  Vec3 offset = Vec3::Zero();
};

/// A random rotation, and an offset of at most `most` along each axis. The same for the same seed.
inline Placement random_placement(unsigned seed, double most) {
  std::mt19937 random(seed);
  const auto uniform = [&] {
    return 2 * (static_cast<double>(random()) / static_cast<double>(std::mt19937::max())) - 1;
  };
  Eigen::Vector4d q;
  do {
    for (int k = 0; k < 4; ++k) q[k] = uniform();
  } while (q.norm() > 1 || q.norm() < .1);
  q.normalize();
  Placement placed;
  placed.rotation = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix();
  for (int k = 0; k < 3; ++k) placed.offset[k] = most * uniform();
  return placed;
}

/// The half-space n . x < d, placed.
inline PiecewiseDomain half_space(const Placement& at, Vec3 n, double d) {
  n = at.rotation * n.normalized();
  d += n.dot(at.offset);
  return PiecewiseDomain([n, d](const Vec3& x, Vec3* g, Mat3* H) {
    if (g) *g = n;
    if (H) H->setZero();
    return n.dot(x) - d;
  });
}

inline PiecewiseDomain ball_at(const Placement& at, const Vec3& centre, double r) {
  const Vec3 c = at.rotation * centre + at.offset;
  return PiecewiseDomain([c, r](const Vec3& x, Vec3* g, Mat3* H) {
    if (g) *g = 2 * (x - c);
    if (H) *H = 2 * Mat3::Identity();
    return (x - c).squaredNorm() - r * r;
  });
}

/// An infinite cylinder around the z axis.
inline PiecewiseDomain pipe_at(const Placement& at, double r) {
  const Vec3 axis = at.rotation * Vec3::UnitZ(), c = at.offset;
  const Mat3 P = Mat3::Identity() - axis * axis.transpose();
  return PiecewiseDomain([P, c, r](const Vec3& x, Vec3* g, Mat3* H) {
    const Vec3 d = P * (x - c);
    if (g) *g = 2 * d;
    if (H) *H = 2 * P;
    return d.squaredNorm() - r * r;
  });
}

/// A body with edges, and what is known of it.
struct PiecewiseBody {
  std::string name;
  PiecewiseDomain domain;
  double radius;  ///< of a ball around the origin that contains it, without its offset
  double volume;
  bool has_flat_faces;  ///< the mesh then has the same volume
  int corners, curves;
  double curve_length;
  double least_angle_deg;  ///< of its edges
};

/// "cube", "cylinder", "L", "lens", "balls", "cube-ball", "wedge60" (or another angle up to 90 degrees).
inline PiecewiseBody piecewise_body(const std::string& name, const Placement& at) {
  constexpr double pi = std::numbers::pi;
  const auto slab = [&](const Vec3& n, double low, double high) {
    return intersection(half_space(at, n, high), half_space(at, -n, -low));
  };
  const Vec3 x = Vec3::UnitX(), y = Vec3::UnitY(), z = Vec3::UnitZ();
  const auto cube = [&] { return intersection(intersection(slab(x, -1, 1), slab(y, -1, 1)), slab(z, -1, 1)); };
  if (name == "cube") return {name, cube(), 1.75, 8, true, 8, 12, 24, 90};
  if (name == "cylinder")
    return {name, intersection(pipe_at(at, 1), slab(z, -1, 1)), 1.45, 2 * pi, false, 0, 2, 4 * pi, 90};
  if (name == "L") {
    const PiecewiseDomain notch = united(half_space(at, x, 0), half_space(at, y, 0));
    const PiecewiseDomain L = intersection(intersection(slab(x, -1, 1), slab(y, -1, 1)), notch);
    return {name, intersection(L, slab(z, -.6, .6)), 1.6, 3.6, true, 12, 18, 2 * 8 + 6 * 1.2, 90};
  }
  const auto cap = [&](double height) { return pi * height * height * (3 - height) / 3; };  // of a ball of radius 1
  if (name == "lens") {
    const double d = .5;
    return {name,
            intersection(ball_at(at, d * z, 1), ball_at(at, -d * z, 1)),
            1,
            2 * cap(1 - d),
            false,
            0,
            1,
            2 * pi * std::sqrt(1 - d * d),
            2 * std::acos(d) * 180 / pi};
  }
  if (name == "balls") {
    const double d = .7;
    return {name,
            united(ball_at(at, d * z, 1), ball_at(at, -d * z, 1)),
            1.75,
            2 * (4 * pi / 3 - cap(1 - d)),
            false,
            0,
            1,
            2 * pi * std::sqrt(1 - d * d),
            360 - 2 * std::acos(d) * 180 / pi};
  }
  if (name == "cube-ball") {
    const Vec3 corner = Vec3::Ones();
    return {name,  intersection(cube(), complement(ball_at(at, corner, 1))),
            1.75,  8 - pi / 6,
            false, 10,
            15,    24 - 3 + 3 * pi / 2,
            90};
  }
  if (name.rfind("wedge", 0) == 0) {
    // A prism over an isosceles triangle of height w.
    const double angle = std::stod(name.substr(5)) * pi / 180, w = std::min(2., 1 / std::tan(angle / 2));
    const Vec3 up(-std::sin(angle / 2), std::cos(angle / 2), 0), down(-std::sin(angle / 2), -std::cos(angle / 2), 0);
    const double d = w / 2 * std::sin(angle / 2), half_base = w * std::tan(angle / 2);
    const PiecewiseDomain triangle =
        intersection(intersection(half_space(at, up, d), half_space(at, down, d)), half_space(at, x, w / 2));
    return {name,
            intersection(triangle, slab(z, -1, 1)),
            2,
            2 * w * half_base,
            true,
            6,
            9,
            2 * (2 * half_base + 2 * std::hypot(w, half_base)) + 6,
            std::min(angle * 180 / pi, 90 - angle * 90 / pi)};
  }
  throw std::invalid_argument("no body has the name " + name);
}

}  // namespace umtet::testing
