#include "mesh/octree/transition_smoothing.h"

#include <oneapi/tbb/parallel_for.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "mesh/base/id_blocks.h"
#include "mesh/core/tet_quality.h"
#include "mesh/octree/octree_tets.h"

namespace umtet {
namespace {

// p = 3 k is a multiple of three, so that Q^-p is a power of a rational function.
// Of some sixty schedules of eight and ten sweeps, tried on random octrees and on sizes that grow from points, these
// leave the greatest least Q: .7825 and .7846 after eight. 0.7 for omega is better by .0003, and near where sweeps
// diverge.
constexpr double kFirstExponent = 8, kLastExponent = 43;
constexpr double kOmega = .6, kMomentum = .4, kLambda = .05;
constexpr double kLongestStep = .05;  // edges
// Weights are those of Q / kScale: neither too small nor too great for float. Tets at the background boundary, half of
// whose corners cannot move, would take all the weight and spoil those behind them; they count as soon as they get
// worse.
constexpr double kScale = .77, kScaleAtBoundary = .73;

/// What a tet says to its corners.
struct TetTerms {
  float weight;
  std::array<std::array<float, 3>, 4> log_gradient;
};

double power(double x, int k) {
  double y = 1;
  for (; k > 0; k /= 2, x *= x) {
    if (k % 2 == 1) y *= x;
  }
  return y;
}

/// Q^3 = factor^3 det^2 / S^3 for a positive determinant and the sum of squared edge lengths S.
TetTerms terms(const std::array<Vec3, 4>& x, double scale, int k) {
  const Vec3 e = x[1] - x[0], f = x[2] - x[0], g = x[3] - x[0];
  const std::array<Vec3, 3> normal = {f.cross(g), g.cross(e), e.cross(f)};
  const double det = e.dot(normal[0]), s = sum_of_squared_edges(x[0], x[1], x[2], x[3]);
  const double ratio = scale / kMeanRatioFactor;
  TetTerms out;
  out.weight = static_cast<float>(power(ratio * ratio * ratio * s * s * s / (det * det), k));
  const Vec3 sum = e + f + g;  // from the first corner, four times the centroid
  const std::array<Vec3, 4> det_gradient = {-(normal[0] + normal[1] + normal[2]), normal[0], normal[1], normal[2]};
  const std::array<Vec3, 4> from_first = {Vec3::Zero(), e, f, g};
  const double by_det = 2 / (3 * det), by_s = 2 / s;
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec3 l = by_det * det_gradient[i] - by_s * (4 * from_first[i] - sum);
    out.log_gradient[i] = {static_cast<float>(l[0]), static_cast<float>(l[1]), static_cast<float>(l[2])};
  }
  return out;
}

/// The tets that move, numbered without gaps, and who meets whom.
struct Patch {
  std::vector<std::int64_t> moving;
  std::vector<Vec3> x;  ///< of all vertices of the tets
  std::vector<std::array<std::int32_t, 4>> tets;
  std::vector<double> scale;         ///< of their weights
  std::vector<std::size_t> begin;    ///< per moving vertex, into uses
  std::vector<std::uint32_t> uses;   ///< 4 tet + corner
  std::vector<std::int32_t> at;      ///< per moving vertex, into x
  std::vector<double> longest_step;  ///< per moving vertex
};

Patch patch_of(const OctreeTets& mesh, const IdSet& moving) {
  Patch patch;
  moving.for_each([&](std::int64_t v) { patch.moving.push_back(v); });
  const std::size_t n = patch.moving.size();
  IdSet tets(mesh.n_tets()), vertices(mesh.n_vertices());
  patch.begin.assign(n + 1, 0);
  tbb::parallel_for(std::size_t{0}, n, [&](std::size_t i) {
    thread_local std::vector<std::int64_t> star;
    star.clear();
    mesh.star(patch.moving[i], star);
    for (const std::int64_t t : star) tets.insert_shared(t);
    patch.begin[i + 1] = star.size();
  });
  for (std::size_t i = 0; i < n; ++i) patch.begin[i + 1] += patch.begin[i];
  patch.tets.resize(tets.index());
  const auto reader = [&](std::size_t) { return OctreeTets::Reader(mesh); };
  for_each_in_blocks(tets, reader, [&](OctreeTets::Reader& read, std::int64_t t) {
    for (const std::int64_t v : read.tet(t)) vertices.insert_shared(v);
  });
  patch.x.resize(vertices.index());
  for_each_in_blocks(tets, reader, [&](OctreeTets::Reader& read, std::int64_t t) {
    const auto corners = read.tet(t);
    for (std::size_t k = 0; k < 4; ++k)
      patch.tets[static_cast<std::size_t>(tets.rank(t))][k] = vertices.rank(corners[k]);
  });
  IdSet on_boundary(static_cast<std::int64_t>(patch.x.size()));
  for_each_in_blocks(vertices, [&](std::size_t, std::int64_t v) {
    if (mesh.on_boundary(v)) on_boundary.insert_shared(vertices.rank(v));
    const GridPoint p = grid_point(mesh.key(v));
    patch.x[static_cast<std::size_t>(vertices.rank(v))] = Vec3(p[0], p[1], p[2]);
  });
  patch.scale.resize(patch.tets.size());
  tbb::parallel_for(std::size_t{0}, patch.tets.size(), [&](std::size_t t) {
    const auto& corners = patch.tets[t];
    const bool at_boundary =
        std::any_of(corners.begin(), corners.end(), [&](std::int32_t v) { return on_boundary.test(v); });
    patch.scale[t] = at_boundary ? kScaleAtBoundary : kScale;
  });
  patch.uses.resize(patch.begin.back());
  patch.at.resize(n);
  patch.longest_step.resize(n);
  tbb::parallel_for(std::size_t{0}, n, [&](std::size_t i) {
    thread_local std::vector<std::int64_t> star;
    star.clear();
    mesh.star(patch.moving[i], star);
    const std::int32_t at = patch.at[i] = vertices.rank(patch.moving[i]);
    double least2 = std::numeric_limits<double>::infinity();
    std::size_t use = patch.begin[i];
    for (const std::int64_t t : star) {
      const auto number = static_cast<std::size_t>(tets.rank(t));
      const auto& corners = patch.tets[number];
      const auto k = static_cast<std::size_t>(std::find(corners.begin(), corners.end(), at) - corners.begin());
      patch.uses[use++] = static_cast<std::uint32_t>(4 * number + k);
      for (const std::int32_t other : corners) {
        if (other != at)
          least2 = std::min(
              least2, (patch.x[static_cast<std::size_t>(other)] - patch.x[static_cast<std::size_t>(at)]).squaredNorm());
      }
    }
    patch.longest_step[i] = kLongestStep * std::sqrt(least2);
  });
  return patch;
}

Vec3 step(const Patch& patch, const std::vector<TetTerms>& tets, std::size_t i, int k) {
  double gx = 0, gy = 0, gz = 0, xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;
  for (std::size_t u = patch.begin[i]; u < patch.begin[i + 1]; ++u) {
    const TetTerms& t = tets[patch.uses[u] / 4];
    const auto& l = t.log_gradient[patch.uses[u] % 4];
    const double x = l[0], y = l[1], z = l[2], wx = t.weight * x, wy = t.weight * y, wz = t.weight * z;
    gx += wx, gy += wy, gz += wz;
    xx += wx * x, yy += wy * y, zz += wz * z;
    xy += wx * y, xz += wx * z, yz += wy * z;
  }
  const double shift = kLambda * (xx + yy + zz);
  Mat3 a;
  a << xx + shift, xy, xz, xy, yy + shift, yz, xz, yz, zz + shift;
  const Vec3 s = kOmega / (3 * k) * (a.inverse() * Vec3(gx, gy, gz));
  const double length = s.norm();
  return length > patch.longest_step[i] ? patch.longest_step[i] / length * s : s;
}

}  // namespace

VertexOffsets smooth_transitions(const OctreeTets& mesh, IdSet moving, int n_sweeps) {
  for_each_in_blocks(moving, [&](std::size_t, std::int64_t v) {
    if (mesh.on_boundary(v)) moving.erase(v);
  });
  VertexOffsets offsets;
  const std::size_t n = moving.index();
  if (n == 0 || n_sweeps == 0) return offsets;
  Patch patch = patch_of(mesh, moving);
  std::vector<TetTerms> tets(patch.tets.size());
  std::vector<Vec3> moves(n, Vec3::Zero()), before(n);
  for (std::size_t i = 0; i < n; ++i) before[i] = patch.x[static_cast<std::size_t>(patch.at[i])];
  for (int sweep = 0; sweep < n_sweeps; ++sweep) {
    const double part = n_sweeps == 1 ? 1 : static_cast<double>(sweep) / (n_sweeps - 1);
    const int k = static_cast<int>(std::lround(kFirstExponent * std::pow(kLastExponent / kFirstExponent, part)));
    tbb::parallel_for(std::size_t{0}, tets.size(), [&](std::size_t t) {
      std::array<Vec3, 4> x;
      for (std::size_t c = 0; c < 4; ++c) x[c] = patch.x[static_cast<std::size_t>(patch.tets[t][c])];
      tets[t] = terms(x, patch.scale[t], k);
    });
    tbb::parallel_for(std::size_t{0}, n, [&](std::size_t i) {
      moves[i] = kMomentum * moves[i] + step(patch, tets, i, k);
      patch.x[static_cast<std::size_t>(patch.at[i])] += moves[i];
    });
  }
  offsets.by.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 by = patch.x[static_cast<std::size_t>(patch.at[i])] - before[i];
    for (int a = 0; a < 3; ++a) offsets.by[i][static_cast<std::size_t>(a)] = static_cast<float>(by[a]);
  }
  offsets.moved = std::move(moving);
  return offsets;
}

}  // namespace umtet
