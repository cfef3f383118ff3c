#include "mesh/octree/graded_mesh.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "mesh/core/tet_quality.h"
#include "mesh/octree/balanced_octree.h"

namespace umtet {
namespace {

constexpr std::size_t kTetsPerTask = 1 << 12;
// A leaf has at most 6 x 8 tets on either side of its faces.
constexpr int kMaxSteps = 96;

struct RootCube {
  Vec3 origin;
  double width = 0;
  int max_level = 0;
};

RootCube root_cube(const Grading& g) {
  if (g.box.isEmpty() || !g.box.sizes().allFinite()) throw std::invalid_argument("box: must be finite and not empty");
  if (!(g.finest > 0) || !std::isfinite(g.finest)) {
    throw std::invalid_argument("finest = " + std::to_string(g.finest) + ": must be > 0");
  }
  if (!(g.tolerance > 0)) throw std::invalid_argument("tolerance = " + std::to_string(g.tolerance) + ": must be > 0");
  if (!g.size) throw std::invalid_argument("size: a function is needed");
  RootCube root;
  root.width = g.finest / kBccMeanEdge;
  for (; root.width < g.box.sizes().maxCoeff(); root.width *= 2) ++root.max_level;
  if (root.max_level > kMaxOctreeLevel) {
    throw std::invalid_argument("finest = " + std::to_string(g.finest) + ": the box would need " +
                                std::to_string(root.max_level) + " levels, more than " +
                                std::to_string(kMaxOctreeLevel));
  }
  root.origin = g.box.center() - Vec3::Constant(.5 * root.width);
  return root;
}

std::vector<std::uint64_t> leaves_of(const Grading& g, const RootCube& root) {
  const double unit = root.width / kRootWidth;
  const auto half_width = [&](std::uint64_t cube) { return .5 * unit * width(cube_level(cube)); };
  const auto centre = [&](std::uint64_t cube) -> Vec3 {
    const GridPoint p = grid_point(cube);
    return root.origin + unit * Vec3(p[0], p[1], p[2]);
  };
  OctreeRules rules{.max_level = root.max_level, .splits = {}, .wanted = {}, .max_leaves = g.max_leaves};
  rules.splits = [&](std::uint64_t cube) {
    const double half = half_width(cube), size = g.size(centre(cube), half);
    if (!(size > 0)) throw std::invalid_argument("size = " + std::to_string(size) + ": must be > 0");
    return kBccMeanEdge * 2 * half > g.tolerance * size;
  };
  if (g.wanted) rules.wanted = [&](std::uint64_t cube) { return g.wanted(centre(cube), half_width(cube)); };
  try {
    return balanced_octree(rules);
  } catch (const std::length_error& error) {
    throw std::invalid_argument("finest = " + std::to_string(g.finest) + ", with these sizes: " + error.what());
  }
}

}  // namespace

GradedMesh::GradedMesh(const Grading& grading)
    : finest_(grading.finest), tets_(leaves_of(grading, root_cube(grading))) {
  const RootCube root = root_cube(grading);
  origin_ = root.origin;
  unit_ = root.width / kRootWidth;
  if (tets_.n_vertices() > std::numeric_limits<int>::max()) {  // a mesh cut out of this one has vertex numbers of int
    throw std::invalid_argument("finest = " + std::to_string(finest_) +
                                ", with these sizes: more than 2^31 - 1 vertices");
  }
  offsets_ = smooth_transitions(tets_, tets_.transition_vertices(), grading.transition_sweeps);
}

GradedMesh GradedMesh::around(const IdSet& vertices, int rings, int transition_sweeps) const {
  GradedMesh some(finest_, unit_, origin_, OctreeTets(tets_.leaves_at(tets_.with_rings(vertices, rings))));
  some.offsets_ = smooth_transitions(some.tets_, some.tets_.transition_vertices(), transition_sweeps);
  return some;
}

Eigen::AlignedBox3d GradedMesh::box() const {
  const GridPoint &low = tets_.lowest(), &high = tets_.highest();
  return {Vec3(origin_ + unit_ * Vec3(low[0], low[1], low[2])),
          Vec3(origin_ + unit_ * Vec3(high[0], high[1], high[2]))};
}

std::size_t GradedMesh::n_bytes() const {
  constexpr std::size_t kSetWord = sizeof(std::uint64_t) + sizeof(std::uint32_t);  // 64 ids and their rank
  return tets_.n_bytes() + offsets_.moved.n_words() * kSetWord + offsets_.by.size() * sizeof(offsets_.by[0]);
}

Vec3 GradedMesh::position(std::int64_t vertex) const {
  const GridPoint p = grid_point(key(vertex));
  if (!offsets_.has(vertex)) return origin_ + unit_ * Vec3(p[0], p[1], p[2]);
  const auto& by = offsets_.by[static_cast<std::size_t>(offsets_.moved.rank(vertex))];
  return origin_ + unit_ * Vec3(p[0] + static_cast<double>(by[0]), p[1] + static_cast<double>(by[1]),
                                p[2] + static_cast<double>(by[2]));
}

bool GradedMesh::bcc_link(std::int64_t vertex, BccLink& vertices) const {
  if (offsets_.has(vertex) || !tets_.bcc_link(vertex, vertices)) return false;
  return std::none_of(vertices.begin(), vertices.end(), [&](std::int64_t w) { return offsets_.has(w); });
}

std::int64_t GradedMesh::tet_at(const Vec3& x) const {
  if (!box().contains(x)) return -1;
  GridPoint p;
  for (int a = 0; a < 3; ++a) {
    p[a] = std::clamp(static_cast<std::int32_t>((x[a] - origin_[a]) / unit_), 0, kRootWidth - 1);
  }
  std::int64_t at = tets_.tet_near(p);
  if (at < 0) return -1;
  // A walk towards x. It cannot be long; the bound is for rounding that could send it round.
  for (int steps = 0; steps < kMaxSteps; ++steps) {
    const auto corners = tet(at);
    std::int64_t next = -1;
    for (int k = 0; k < 4 && next < 0; ++k) {
      const auto& f = kTetFace[k];
      if (volume6(position(corners[f[0]]), position(corners[f[1]]), position(corners[f[2]]), x) > 0) {
        next = neighbor(at, k);
      }
    }
    if (next < 0) break;
    at = next;
  }
  return at;
}

}  // namespace umtet
