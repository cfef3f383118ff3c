#include "mesh/implicit/zero_surface.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <unordered_map>
#include <unordered_set>

#include "common/polled_loops.h"

namespace umtet {
namespace {

using Cell = std::array<int, 3>;
// Cubes along an edge of the coarse grid that finds components without points.
constexpr int kCoarse = 4;
constexpr int kMostCells = 1 << 20;  // three indices and three bits of a direction fit into 64 bits
constexpr int kNewtonSteps = 2;

/// The six tets of a cube share its diagonal; each takes the corners on a path along three edges. Bits of a corner: its
/// offset along x, y, z.
constexpr std::array<std::array<int, 4>, 6> kKuhnTets = {
    {{0, 1, 3, 7}, {0, 1, 5, 7}, {0, 2, 3, 7}, {0, 2, 6, 7}, {0, 4, 5, 7}, {0, 4, 6, 7}}};

class SurfaceFollower {
 public:
  SurfaceFollower(ImplicitFunctionRef psi, const Eigen::AlignedBox3d& box, double spacing, const Context& context);
  ZeroSurface operator()(const std::vector<Vec3>& near);

 private:
  std::uint64_t key(const Cell& c) const {
    return (static_cast<std::uint64_t>(c[2]) << 42) | (static_cast<std::uint64_t>(c[1]) << 21) |
           static_cast<std::uint64_t>(c[0]);
  }
  static Cell corner(const Cell& cube, int bits) {
    return {cube[0] + (bits & 1), cube[1] + ((bits >> 1) & 1), cube[2] + ((bits >> 2) & 1)};
  }
  Vec3 at(const Cell& node) const { return box_.min() + Vec3(node[0], node[1], node[2]).cwiseProduct(step_); }
  bool is_cube(const Cell& c) const {
    return c[0] >= 0 && c[1] >= 0 && c[2] >= 0 && c[0] < n_[0] && c[1] < n_[1] && c[2] < n_[2];
  }
  double value(const Cell& node) const { return value_.at(key(node)); }
  void add(const Cell& cube) {
    if (is_cube(cube) && seen_.insert(key(cube)).second) front_.push_back(cube);
  }
  void evaluate(std::vector<Cell> nodes);
  void start_at(const std::vector<Vec3>& near);
  void start_at_coarse_edges();
  void follow();
  void cut(const Cell& cube);
  int vertex(const Cell& inside, const Cell& outside);
  void add_triangle(int a, int b, int c, const Vec3& outward);
  void project();

  ImplicitFunctionRef psi_;
  Eigen::AlignedBox3d box_;
  const Context& context_;
  Cell n_;  ///< numbers of cubes
  Vec3 step_;
  std::unordered_map<std::uint64_t, double> value_;  ///< by key of a node
  std::unordered_set<std::uint64_t> seen_;           ///< keys of cubes
  std::vector<Cell> front_, cubes_;
  std::unordered_map<std::uint64_t, std::vector<std::pair<std::uint64_t, int>>> vertex_;  ///< by keys of both ends
  ZeroSurface surface_;
};

SurfaceFollower::SurfaceFollower(ImplicitFunctionRef psi, const Eigen::AlignedBox3d& box, double spacing,
                                 const Context& context)
    : psi_(psi), box_(box), context_(context) {
  const Vec3 size = box.sizes();
  if (!(spacing > 0)) throw std::invalid_argument("a surface needs a spacing > 0");
  if (box.isEmpty() || !size.allFinite() || !(size.minCoeff() > 0))
    throw std::invalid_argument("a surface needs a bounded box");
  for (int k = 0; k < 3; ++k) {
    const double n = kCoarse * std::ceil(size[k] / (kCoarse * spacing));
    if (!(n < kMostCells)) throw std::length_error("the box has too many cubes of this spacing");
    n_[k] = static_cast<int>(n);
    step_[k] = size[k] / n;
  }
}

/// Evaluates psi at the nodes that are not known yet.
void SurfaceFollower::evaluate(std::vector<Cell> nodes) {
  std::vector<Vec3> points;
  std::vector<std::uint64_t> keys;
  for (const Cell& node : nodes) {
    if (!value_.try_emplace(key(node), 0).second) continue;
    keys.push_back(key(node));
    points.push_back(at(node));
  }
  std::vector<double> values(points.size());
  if (psi_.side_by_side()) {
    psi_.values(points, values.data());
  } else {
    polled_parallel_for(points.size(), kValuesPerPoll, context_,
                        [&](std::size_t i) { values[i] = psi_.value(points[i]); });
  }
  for (std::size_t i = 0; i < keys.size(); ++i) value_[keys[i]] = std::isfinite(values[i]) ? values[i] : HUGE_VAL;
}

void SurfaceFollower::start_at(const std::vector<Vec3>& near) {
  for (const Vec3& x : near) {
    const Vec3 place = (x - box_.min()).cwiseQuotient(step_);
    if (!place.allFinite() || place.cwiseAbs().maxCoeff() > kMostCells) continue;
    add({static_cast<int>(std::floor(place[0])), static_cast<int>(std::floor(place[1])),
         static_cast<int>(std::floor(place[2]))});
  }
}

void SurfaceFollower::start_at_coarse_edges() {
  std::vector<Cell> nodes;
  for (int z = 0; z <= n_[2]; z += kCoarse)
    for (int y = 0; y <= n_[1]; y += kCoarse)
      for (int x = 0; x <= n_[0]; x += kCoarse) nodes.push_back({x, y, z});
  evaluate(nodes);
  for (const Cell& node : nodes) {
    for (int axis = 0; axis < 3; ++axis) {
      Cell end = node;
      end[axis] += kCoarse;
      if (end[axis] > n_[axis] || (value(node) < 0) == (value(end) < 0)) continue;
      for (int k = 0; k < kCoarse; ++k) {
        // A cube beside the edge, inside of the box.
        Cell cube = node;
        cube[axis] += k;
        for (int other = 0; other < 3; ++other) cube[other] = std::min(cube[other], n_[other] - 1);
        add(cube);
      }
    }
  }
}

/// Adds the cubes behind the faces on which psi changes sign.
void SurfaceFollower::follow() {
  while (!front_.empty()) {
    const std::vector<Cell> cubes = std::move(front_);
    front_.clear();
    std::vector<Cell> nodes;
    nodes.reserve(8 * cubes.size());
    for (const Cell& cube : cubes)
      for (int bits = 0; bits < 8; ++bits) nodes.push_back(corner(cube, bits));
    evaluate(std::move(nodes));
    for (const Cell& cube : cubes) {
      int inside = 0;
      for (int bits = 0; bits < 8; ++bits) inside |= (value(corner(cube, bits)) < 0 ? 1 : 0) << bits;
      if (inside == 0 || inside == 255) continue;
      cubes_.push_back(cube);
      constexpr std::array kHigh = {0xAA, 0xCC, 0xF0};  // corners with offset 1 along the axis
      for (int axis = 0; axis < 3; ++axis) {
        for (const int side : {-1, 1}) {
          const int face = side > 0 ? kHigh[axis] : 255 - kHigh[axis];
          if ((inside & face) == 0 || (inside & face) == face) continue;
          Cell next = cube;
          next[axis] += side;
          add(next);
        }
      }
    }
  }
}

int SurfaceFollower::vertex(const Cell& inside, const Cell& outside) {
  const std::uint64_t a = key(inside), b = key(outside);
  std::vector<std::pair<std::uint64_t, int>>& of_a = vertex_[std::min(a, b)];
  for (const auto& [other, v] : of_a)
    if (other == std::max(a, b)) return v;
  const double p = value(inside), q = value(outside);
  const double s = std::isfinite(q) && std::isfinite(p) ? p / (p - q) : .5;
  const int v = static_cast<int>(surface_.V.size());
  surface_.V.push_back((1 - s) * at(inside) + s * at(outside));
  of_a.emplace_back(std::max(a, b), v);
  return v;
}

void SurfaceFollower::add_triangle(int a, int b, int c, const Vec3& outward) {
  const std::vector<Vec3>& V = surface_.V;
  const bool faces_out = (V[b] - V[a]).cross(V[c] - V[a]).dot(outward) >= 0;
  surface_.F.push_back(faces_out ? std::array{a, b, c} : std::array{a, c, b});
}

void SurfaceFollower::cut(const Cell& cube) {
  for (const auto& tet : kKuhnTets) {
    std::vector<Cell> in, out;
    Vec3 outward = Vec3::Zero();
    for (const int bits : tet) {
      const Cell node = corner(cube, bits);
      const bool is_inside = value(node) < 0;
      (is_inside ? in : out).push_back(node);
    }
    if (in.empty() || out.empty()) continue;
    for (const Cell& a : in)
      for (const Cell& b : out) outward += at(b) - at(a);
    if (in.size() == 2) {
      const int v[4] = {vertex(in[0], out[0]), vertex(in[0], out[1]), vertex(in[1], out[1]), vertex(in[1], out[0])};
      add_triangle(v[0], v[1], v[2], outward);
      add_triangle(v[0], v[2], v[3], outward);
    } else if (in.size() == 1) {
      add_triangle(vertex(in[0], out[0]), vertex(in[0], out[1]), vertex(in[0], out[2]), outward);
    } else {
      add_triangle(vertex(in[0], out[0]), vertex(in[1], out[0]), vertex(in[2], out[0]), outward);
    }
  }
}

void SurfaceFollower::project() {
  const double most = step_.minCoeff() / kNewtonSteps;
  for (int k = 0; k < kNewtonSteps; ++k) {
    polled_parallel_for(surface_.V.size(), kValuesPerPoll, context_, [&](std::size_t i) {
      Vec3 g;
      const double value = psi_.value(surface_.V[i], g);
      const double slope2 = g.squaredNorm();
      if (!(std::isfinite(value) && slope2 > 0)) return;
      Vec3 move = -value / slope2 * g;
      if (const double length = move.norm(); length > most) move *= most / length;
      if (move.allFinite()) surface_.V[i] += move;
    });
  }
}

ZeroSurface SurfaceFollower::operator()(const std::vector<Vec3>& near) {
  start_at_coarse_edges();
  start_at(near);
  follow();
  for (const Cell& cube : cubes_) cut(cube);
  if (!psi_.side_by_side()) project();
  return std::move(surface_);
}

}  // namespace

ZeroSurface zero_surface(ImplicitFunctionRef psi, const Eigen::AlignedBox3d& box, double spacing,
                         const std::vector<Vec3>& near, const Context& context) {
  return SurfaceFollower(psi, box, spacing, context)(near);
}

}  // namespace umtet
