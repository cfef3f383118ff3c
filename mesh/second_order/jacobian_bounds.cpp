#include "mesh/second_order/jacobian_bounds.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace umtet {
namespace {

using Coefficients = std::array<double, 20>;
using CubicIndex = std::array<std::array<std::array<int, 4>, 4>, 4>;

constexpr CubicIndex make_cubic_index() {
  CubicIndex index{};
  int n = 0;
  for (int i = 0; i < 4; ++i) {
    for (int j = i; j < 4; ++j) {
      for (int k = j; k < 4; ++k, ++n) {
        index[i][j][k] = index[i][k][j] = index[j][i][k] = index[j][k][i] = index[k][i][j] = index[k][j][i] = n;
      }
    }
  }
  return index;
}

constexpr CubicIndex kIndex = make_cubic_index();
constexpr std::array<int, 4> kCorners = {kIndex[0][0][0], kIndex[1][1][1], kIndex[2][2][2], kIndex[3][3][3]};

/// Coefficients along lines parallel to an edge (i, j): those of l_i^k l_j^(n-k) times the same rest, k = 0 .. n.
struct EdgeLines {
  std::array<std::array<int, 4>, 10> line{};
  std::array<int, 10> degree{};  ///< n; lines of degree 0 are points that an edge's halving leaves as they are
};

constexpr std::array<EdgeLines, 6> make_edge_lines() {
  std::array<EdgeLines, 6> all{};
  for (int e = 0; e < 6; ++e) {
    const int i = kMidSideEdge[e][0], j = kMidSideEdge[e][1];
    int p = 0;
    while (p == i || p == j) ++p;
    const int q = 6 - i - j - p;
    int n_lines = 0;
    for (int n = 0; n <= 3; ++n) {
      for (int of_p = 0; of_p <= 3 - n; ++of_p, ++n_lines) {
        all[e].degree[n_lines] = n;
        for (int k = 0; k <= n; ++k) {
          std::array<int, 3> factors{};
          for (int f = 0; f < 3; ++f) factors[f] = f < k ? i : f < n ? j : f < n + of_p ? p : q;
          all[e].line[n_lines][k] = kIndex[factors[0]][factors[1]][factors[2]];
        }
      }
    }
  }
  return all;
}

constexpr std::array<EdgeLines, 6> kEdgeLines = make_edge_lines();

/// The edge along which second differences are greatest.
int bent_edge(const Coefficients& c) {
  int most = 0;
  double greatest = -1;
  for (int e = 0; e < 6; ++e) {
    double bend = 0;
    for (int l = 0; l < 10; ++l) {
      const auto& line = kEdgeLines[e].line[l];
      for (int k = 0; k + 2 <= kEdgeLines[e].degree[l]; ++k) {
        bend = std::max(bend, std::abs(c[line[k]] - 2 * c[line[k + 1]] + c[line[k + 2]]));
      }
    }
    if (bend > greatest) greatest = bend, most = e;
  }
  return most;
}

/// De Casteljau at the middle of an edge (i, j): coefficients on the halves at j and at i.
void halve(const Coefficients& c, int edge, Coefficients& at_j, Coefficients& at_i) {
  at_j = at_i = c;
  for (int l = 0; l < 10; ++l) {
    const auto& line = kEdgeLines[edge].line[l];
    const int n = kEdgeLines[edge].degree[l];
    std::array<double, 4> p{};
    for (int k = 0; k <= n; ++k) p[k] = c[line[k]];
    for (int level = 0; level <= n; ++level) {
      at_j[line[level]] = p[0];
      at_i[line[n - level]] = p[n - level];
      for (int k = 0; k < n - level; ++k) p[k] = (p[k] + p[k + 1]) / 2;
    }
  }
}

double least(const Coefficients& c) { return *std::min_element(c.begin(), c.end()); }

double least_at_corners(const Coefficients& c) {
  double value = c[kCorners[0]];
  for (int k = 1; k < 4; ++k) value = std::min(value, c[kCorners[k]]);
  return value;
}

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kUnit = std::numeric_limits<double>::epsilon() / 2;  // of rounding: 2^-53
constexpr double kGap = .02;                                          // of the upper bound
constexpr int kDepth = 48, kParts = 4000;                             // 48 halvings make parts of 2^-16 of each edge

struct Part {
  Coefficients c;
  int depth;
};

}  // namespace

const CubicIndex kCubicIndex = kIndex;
const std::array<int, 20> kCubicOrders = [] {
  std::array<int, 20> orders{};
  for (int i = 0; i < 64; ++i) ++orders[kIndex[i / 16][i / 4 % 4][i % 4]];
  return orders;
}();

JacobianColumns jacobian_columns(const QuadraticNodes& x) {
  std::array<Vec3, 4> corner;
  for (int i = 0; i < 4; ++i) corner[i] = x[i] - x[0];
  std::array<std::array<Vec3, 4>, 4> b;
  for (int i = 0; i < 4; ++i) b[i][i] = corner[i];
  for (int k = 0; k < 6; ++k) {
    const auto [i, j] = kMidSideEdge[k];
    b[i][j] = b[j][i] = 2 * (x[4 + k] - x[0]) - (corner[i] + corner[j]) / 2;
  }
  JacobianColumns a;
  for (int i = 0; i < 4; ++i) {
    for (int j = 1; j < 4; ++j) a[i][j - 1] = 2 * (b[i][j] - b[i][0]);
  }
  return a;
}

// With u = 2^-53, M the greatest component of a node less the first corner, A that of a column: a b_ij is at most 3 M
// and off by 7 u M, a column by 40 u M. A determinant is six products of three columns, off by 18 A^2 (40 u M) for them
// and by 30 u A^3 for its own operations, the mean of six of them by another 36 u A^3. What is left of u^2 and where
// products underflow is covered by the rounder numbers.
JacobianCoefficients jacobian_coefficients(const QuadraticNodes& x) {
  const JacobianColumns a = jacobian_columns(x);
  JacobianCoefficients result{};
  for (int j = 0; j < 4; ++j) {
    for (int k = 0; k < 4; ++k) {
      const Vec3 normal = a[j][1].cross(a[k][2]);
      for (int i = 0; i < 4; ++i) result.c[kIndex[i][j][k]] += a[i][0].dot(normal);
    }
  }
  for (int n = 0; n < 20; ++n) result.c[n] /= kCubicOrders[n];
  double M = 0, A = 0;
  for (int n = 1; n < 10; ++n) M = std::max(M, (x[n] - x[0]).cwiseAbs().maxCoeff());
  for (const auto& columns : a) {
    for (const Vec3& column : columns) A = std::max(A, column.cwiseAbs().maxCoeff());
  }
  result.rounding = kUnit * A * A * (800 * M + 80 * A) + std::numeric_limits<double>::min();
  return result;
}

double mean_jacobian(const JacobianCoefficients& coefficients) {
  return std::accumulate(coefficients.c.begin(), coefficients.c.end(), 0.) / 20;
}

JacobianBounds jacobian_bounds(const QuadraticNodes& x) {
  const JacobianCoefficients whole = jacobian_coefficients(x);
  JacobianBounds bounds{kInfinity, kInfinity, mean_jacobian(whole)};
  double greatest = 0;
  for (const double c : whole.c) greatest = std::max(greatest, std::abs(c));
  if (!std::isfinite(bounds.mean) || !std::isfinite(whole.rounding)) return {-kInfinity, kInfinity, bounds.mean};

  std::array<Part, kDepth + 2> stack;
  int n = 1, n_parts = 1, deepest = 0;
  stack[0] = {whole.c, 0};
  while (n > 0) {
    const Part part = stack[--n];
    const double low = least(part.c);
    bounds.upper = std::min(bounds.upper, least_at_corners(part.c));
    const bool decided = low >= (1 - kGap) * bounds.upper, hopeless = bounds.upper <= 0;
    if (decided || hopeless || part.depth == kDepth || n_parts >= kParts) {
      bounds.lower = std::min(bounds.lower, low);
      continue;
    }
    stack[n].depth = stack[n + 1].depth = part.depth + 1;
    halve(part.c, bent_edge(part.c), stack[n].c, stack[n + 1].c);
    deepest = std::max(deepest, part.depth + 1);
    n += 2;
    n_parts += 2;
  }
  // A halving takes means at most three times one after the other.
  const double rounding = whole.rounding + 3 * kUnit * deepest * greatest;
  bounds.lower -= rounding;
  bounds.upper += rounding;
  return bounds;
}

}  // namespace umtet
