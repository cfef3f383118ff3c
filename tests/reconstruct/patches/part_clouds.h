#pragma once

// Clouds of parts whose smooth patches are known: samples at random with a least spacing, with noise.

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "common/vec3.h"
#include "reconstruct/cloud/neighbours/neighbour_tree.h"

namespace umtet::test {

/// Random numbers that are the same with every standard library.
class PartRandom {
 public:
  explicit PartRandom(std::uint64_t seed) : engine_(seed) {}
  double uniform(double low = 0, double high = 1) {
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }
  double normal() { return std::sqrt(-2 * std::log(1 - uniform())) * std::cos(2 * std::numbers::pi * uniform()); }
  Vec3 direction() {
    const Vec3 v(normal(), normal(), normal());
    return v.normalized();
  }

 private:
  std::mt19937_64 engine_;
};

/// A smooth surface of which a patch is a part.
struct PartFace {
  double area;
  std::function<Vec3(PartRandom&, Vec3& normal)> sample;  ///< uniform by area; the normal to any side
};

/// A body by its faces. What of a face is not on the boundary of `inside` does not count.
struct Part {
  std::string name;
  std::vector<PartFace> faces;
  std::function<bool(const Vec3&)> inside;
};

inline PartFace rectangle(const Vec3& corner, const Vec3& u, const Vec3& v) {
  return {u.cross(v).norm(), [=](PartRandom& random, Vec3& normal) -> Vec3 {
            normal = u.cross(v).normalized();
            return corner + random.uniform() * u + random.uniform() * v;
          }};
}

inline PartFace sphere_face(const Vec3& centre, double r) {
  return {4 * std::numbers::pi * r * r, [=](PartRandom& random, Vec3& normal) -> Vec3 {
            normal = random.direction();
            return centre + r * normal;
          }};
}

/// The side of the cylinder around the z axis through a point, from its height up.
inline PartFace pipe_face(const Vec3& base, double r, double height) {
  return {2 * std::numbers::pi * r * height, [=](PartRandom& random, Vec3& normal) -> Vec3 {
            const double a = random.uniform(0, 2 * std::numbers::pi);
            normal = Vec3(std::cos(a), std::sin(a), 0);
            return base + r * normal + random.uniform(0, height) * Vec3::UnitZ();
          }};
}

inline void add_box(std::vector<PartFace>& faces, const Vec3& low, const Vec3& high) {
  const Vec3 d = high - low;
  for (int k = 0; k < 3; ++k) {
    const Vec3 u = d[(k + 1) % 3] * Vec3::Unit((k + 1) % 3), v = d[(k + 2) % 3] * Vec3::Unit((k + 2) % 3);
    faces.push_back(rectangle(low, u, v));
    faces.push_back(rectangle(low + d[k] * Vec3::Unit(k), u, v));
  }
}

inline bool in_box(const Vec3& x, const Vec3& low, const Vec3& high) {
  return (x - low).minCoeff() > 0 && (high - x).minCoeff() > 0;
}

/// The prism over a polygon in the xy plane, for 0 < z < height.
inline Part prism(const std::string& name, const std::vector<std::array<double, 2>>& polygon, double height) {
  Part part{name, {}, {}};
  Vec3 low = Vec3::Constant(1e9), high = -low;
  const std::size_t n = polygon.size();
  for (std::size_t k = 0; k < n; ++k) {
    const Vec3 a(polygon[k][0], polygon[k][1], 0), b(polygon[(k + 1) % n][0], polygon[(k + 1) % n][1], 0);
    part.faces.push_back(rectangle(a, b - a, height * Vec3::UnitZ()));
    low = low.cwiseMin(a);
    high = high.cwiseMax(a);
  }
  for (const double z : {0., height})
    part.faces.push_back(
        rectangle(Vec3(low[0], low[1], z), Vec3(high[0] - low[0], 0, 0), Vec3(0, high[1] - low[1], 0)));
  part.inside = [polygon, height](const Vec3& x) {
    bool in = false;
    for (std::size_t k = 0, l = polygon.size() - 1; k < polygon.size(); l = k++) {
      const auto &a = polygon[k], &b = polygon[l];
      if ((a[1] > x[1]) != (b[1] > x[1]) && x[0] < (b[0] - a[0]) * (x[1] - a[1]) / (b[1] - a[1]) + a[0]) in = !in;
    }
    return in && x[2] > 0 && x[2] < height;
  };
  return part;
}

/// The cube of side 2 whose edges and corners are rounded with radius r.
inline Part rounded_cube(double r) {
  Part part{"rounded", {}, {}};
  add_box(part.faces, Vec3::Constant(-1), Vec3::Constant(1));
  const double c = 1 - r;
  for (int k = 0; k < 8; ++k) part.faces.push_back(sphere_face({k & 1 ? c : -c, k & 2 ? c : -c, k & 4 ? c : -c}, r));
  for (int axis = 0; axis < 3; ++axis) {
    for (int k = 0; k < 4; ++k) {
      Vec3 base = Vec3::Constant(-c);
      if (k & 1) base[(axis + 1) % 3] = c;
      if (k & 2) base[(axis + 2) % 3] = c;
      part.faces.push_back({4 * std::numbers::pi * r * c, [=](PartRandom& random, Vec3& normal) -> Vec3 {
                              const double a = random.uniform(0, 2 * std::numbers::pi);
                              normal =
                                  std::cos(a) * Vec3::Unit((axis + 1) % 3) + std::sin(a) * Vec3::Unit((axis + 2) % 3);
                              return base + r * normal + random.uniform(0, 2 * c) * Vec3::Unit(axis);
                            }});
    }
  }
  part.inside = [=](const Vec3& x) {
    const Vec3 d = x.cwiseAbs() - Vec3::Constant(c);
    return d.maxCoeff() < r && d.cwiseMax(0).norm() < r;
  };
  return part;
}

/// The torus around the z axis with radii 1 and `tube`.
inline Part torus(double tube) {
  constexpr double pi = std::numbers::pi;
  const auto sample = [=](PartRandom& random, Vec3& normal) -> Vec3 {
    double u = 0, v = 0;
    do {
      u = random.uniform(0, 2 * pi);
      v = random.uniform(0, 2 * pi);
    } while (random.uniform() * (1 + tube) > 1 + tube * std::cos(v));
    normal = Vec3(std::cos(u) * std::cos(v), std::sin(u) * std::cos(v), std::sin(v));
    return Vec3(std::cos(u), std::sin(u), 0) + tube * normal;
  };
  return {"torus", {{4 * pi * pi * tube, sample}}, [=](const Vec3& x) {
            return std::hypot(std::hypot(x[0], x[1]) - 1, x[2]) < tube;
          }};
}

/// A sphere with waves of several lengths and heights: an organic shape. Its samples are uniform by direction.
inline Part blob() {
  const auto height = [](const Vec3& d) {
    return 1 + .15 * std::sin(3 * d[0] + 1) * std::sin(4 * d[1]) + .06 * std::sin(7 * d[2] + 2 * d[0]) +
           .02 * std::sin(13 * d[1] - 11 * d[2]);
  };
  const auto level = [=](const Vec3& x) { return x.norm() - height(x.normalized()); };
  const auto sample = [=](PartRandom& random, Vec3& normal) -> Vec3 {
    const Vec3 d = random.direction(), x = height(d) * d;
    for (int k = 0; k < 3; ++k) normal[k] = level(x + 1e-5 * Vec3::Unit(k)) - level(x - 1e-5 * Vec3::Unit(k));
    normal.normalize();
    return x;
  };
  return {"blob", {{4 * std::numbers::pi, sample}}, [=](const Vec3& x) { return level(x) < 0; }};
}

/// "cube", "L", "cube-ball", "balls", "cylinder", "lens", "bracket", "fan".
inline Part part_named(const std::string& name) {
  constexpr double pi = std::numbers::pi;
  const Vec3 one = Vec3::Ones(), z = Vec3::UnitZ();
  Part part{name, {}, {}};
  if (name == "cube") {
    add_box(part.faces, -one, one);
    part.inside = [=](const Vec3& x) { return in_box(x, -one, one); };
  } else if (name == "L") {
    return prism(name, {{-1, -1}, {1, -1}, {1, 0}, {0, 0}, {0, 1}, {-1, 1}}, 1.2);
  } else if (name == "cube-ball") {
    add_box(part.faces, -one, one);
    part.faces.push_back(sphere_face(one, 1));
    part.inside = [=](const Vec3& x) { return in_box(x, -one, one) && (x - one).norm() > 1; };
  } else if (name == "balls") {
    part.faces = {sphere_face(.7 * z, 1), sphere_face(-.7 * z, 1)};
    part.inside = [=](const Vec3& x) { return (x - .7 * z).norm() < 1 || (x + .7 * z).norm() < 1; };
  } else if (name == "lens") {
    part.faces = {sphere_face(.5 * z, 1), sphere_face(-.5 * z, 1)};
    part.inside = [=](const Vec3& x) { return (x - .5 * z).norm() < 1 && (x + .5 * z).norm() < 1; };
  } else if (name == "cylinder") {
    part.faces = {pipe_face(-z, 1, 2), rectangle({-1, -1, -1}, 2 * Vec3::UnitX(), 2 * Vec3::UnitY()),
                  rectangle({-1, -1, 1}, 2 * Vec3::UnitX(), 2 * Vec3::UnitY())};
    part.inside = [=](const Vec3& x) { return std::hypot(x[0], x[1]) < 1 && std::abs(x[2]) < 1; };
  } else if (name == "bracket") {
    // A plate with two holes and a rib across.
    const Vec3 plate(2.4, 1.2, .3), rib_low(1.05, 0, 0), rib_high(1.35, 1.2, .9);
    const Vec3 first(.5, .6, 0), second(1.9, .6, 0);
    add_box(part.faces, Vec3::Zero(), plate);
    // The ends of the rib continue those of the plate: they are on the same planes, so on the same patches.
    part.faces.push_back(rectangle({1.05, 0, .3}, {0, 1.2, 0}, {0, 0, .6}));
    part.faces.push_back(rectangle({1.35, 0, .3}, {0, 1.2, 0}, {0, 0, .6}));
    part.faces.push_back(rectangle({1.05, 0, .9}, {.3, 0, 0}, {0, 1.2, 0}));
    part.faces[2] = rectangle({0, 0, 0}, {2.4, 0, 0}, {0, 0, .9});
    part.faces[3] = rectangle({0, 1.2, 0}, {2.4, 0, 0}, {0, 0, .9});
    // The rib cuts the top of the plate into two.
    part.faces[5] = rectangle({0, 0, .3}, {1.05, 0, 0}, {0, 1.2, 0});
    part.faces.push_back(rectangle({1.35, 0, .3}, {1.05, 0, 0}, {0, 1.2, 0}));
    part.faces.push_back(pipe_face(first, .25, .3));
    part.faces.push_back(pipe_face(second, .2, .3));
    part.inside = [=](const Vec3& x) {
      const auto in_pipe = [&](const Vec3& c, double r) { return std::hypot(x[0] - c[0], x[1] - c[1]) < r; };
      return (in_box(x, Vec3::Zero(), plate) && !in_pipe(first, .25) && !in_pipe(second, .2)) ||
             in_box(x, rib_low, rib_high);
    };
  } else if (name == "fan") {
    // Angles of 63, 135, 117, 135 and 90 degrees along the profile.
    const double a = 63 * pi / 180;
    return prism(name, {{0, 0}, {2, 0}, {2, 1}, {1.5, 1.5}, {1.5 / std::tan(a), 1.5}}, 1.2);
  }
  return part;
}

/// A sampled part.
struct PartCloud {
  std::vector<Vec3> points, normals;
  std::vector<int> patch;  ///< the true face of each sample
  double spacing = 0;      ///< root of area / samples
  double diagonal = 0;
  /// Places on edges, with the two faces that meet there.
  struct EdgePlace {
    Vec3 x;
    int a, b;
  };
  std::vector<EdgePlace> edges;
};

/// Edge places of dense samples of known faces, about half a spacing from each other.
inline std::vector<PartCloud::EdgePlace> edge_places(const std::vector<Vec3>& dense, const std::vector<int>& face,
                                                     double spacing) {
  std::vector<PartCloud::EdgePlace> places;
  const NeighbourTree tree(dense);
  std::vector<Vec3> kept;
  for (std::size_t i = 0; i < dense.size(); ++i) {
    double least = .3 * spacing * .3 * spacing;
    std::uint32_t other = static_cast<std::uint32_t>(i);
    tree.within(dense[i], least, [&](std::uint32_t j, double d2) {
      if (face[j] != face[i] && d2 < least) {
        least = d2;
        other = j;
      }
    });
    if (other == i) continue;
    const Vec3 x = .5 * (dense[i] + dense[other]);
    const int a = std::min(face[i], face[other]), b = std::max(face[i], face[other]);
    bool is_new = true;
    for (const auto& place : places)
      if (place.a == a && place.b == b && (place.x - x).norm() < .5 * spacing) is_new = false;
    if (is_new) places.push_back({x, a, b});
  }
  return places;
}

/// About n samples of a part. Candidates are uniform by area; one is kept if no earlier one is near.
inline PartCloud sample_part(const Part& part, int n, std::uint64_t seed, bool with_edges = false) {
  PartRandom random(seed);
  std::vector<double> ends;
  double total = 0;
  for (const PartFace& face : part.faces) ends.push_back(total += face.area);
  std::vector<Vec3> dense, normals;
  std::vector<int> faces;
  std::size_t thrown = 0;
  while (static_cast<int>(dense.size()) < 12 * n) {
    ++thrown;
    const double at = random.uniform(0, total);
    const auto k = static_cast<std::size_t>(std::upper_bound(ends.begin(), ends.end(), at) - ends.begin());
    Vec3 normal;
    const Vec3 x = part.faces[k].sample(random, normal);
    const bool above = part.inside(x + 1e-6 * normal), below = part.inside(x - 1e-6 * normal);
    if (above == below) continue;
    dense.push_back(x);
    normals.push_back(below ? normal : -normal);
    faces.push_back(static_cast<int>(k));
  }
  PartCloud cloud;
  const double area = total * static_cast<double>(dense.size()) / static_cast<double>(thrown);
  const double radius = .75 * std::sqrt(area / n);  // 12 candidates a sample reach about n samples with it
  const NeighbourTree tree(dense);
  std::vector<char> taken(dense.size()), covered(dense.size());
  Vec3 low = dense[0], high = dense[0];
  for (std::size_t i = 0; i < dense.size(); ++i) {
    low = low.cwiseMin(dense[i]);
    high = high.cwiseMax(dense[i]);
    if (covered[i] || static_cast<int>(cloud.points.size()) == n) continue;
    tree.within(dense[i], radius * radius, [&](std::uint32_t j, double) { covered[j] = 1; });
    cloud.points.push_back(dense[i]);
    cloud.normals.push_back(normals[i]);
    cloud.patch.push_back(faces[i]);
  }
  cloud.spacing = std::sqrt(area / static_cast<double>(cloud.points.size()));
  cloud.diagonal = (high - low).norm();
  if (with_edges) cloud.edges = edge_places(dense, faces, cloud.spacing);
  return cloud;
}

/// Moves samples by a normal deviate along each axis, and turns normals by one around a random tangent.
/// @param position  standard deviation, relative to the diagonal.  @param degrees  that of the turn
inline void add_noise(PartCloud& cloud, double position, double degrees, std::uint64_t seed) {
  PartRandom random(seed);
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    for (int k = 0; k < 3; ++k) cloud.points[i][k] += position * cloud.diagonal * random.normal();
    const Vec3 axis = cloud.normals[i].cross(random.direction());
    if (!(axis.norm() > 1e-9)) continue;
    const double turn = degrees * std::numbers::pi / 180 * random.normal();
    cloud.normals[i] = (Eigen::AngleAxisd(turn, axis.normalized()) * cloud.normals[i]).normalized();
  }
}

}  // namespace umtet::test
