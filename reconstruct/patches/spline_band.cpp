#include "reconstruct/patches/spline_band.h"

#include <algorithm>
#include <cmath>

namespace umtet {
namespace {

// Coefficients of the four cubics of a cell, in powers of t in [0, 1].
constexpr double kCubic[4][4] = {
    {1. / 6, -1. / 2, 1. / 2, -1. / 6}, {2. / 3, 0, -1, 1. / 2}, {1. / 6, 1. / 2, 1. / 2, -1. / 2}, {0, 0, 0, 1. / 6}};
constexpr std::int64_t kBits = 21, kOffset = std::int64_t{1} << (kBits - 1);

/// Coefficients of the derivative of this order.
std::array<double, 4> derivative(int function, int order) {
  std::array<double, 4> c = {kCubic[function][0], kCubic[function][1], kCubic[function][2], kCubic[function][3]};
  for (int d = 0; d < order; ++d) {
    for (int k = 0; k < 3; ++k) c[k] = (k + 1) * c[k + 1];
    c[3] = 0;
  }
  return c;
}

/// int_0^1 of the products of the derivatives of this order.
Eigen::Matrix4d products(int order) {
  Eigen::Matrix4d M = Eigen::Matrix4d::Zero();
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j) {
      const auto a = derivative(i, order), b = derivative(j, order);
      for (int p = 0; p < 4; ++p)
        for (int q = 0; q < 4; ++q) M(i, j) += a[p] * b[q] / (p + q + 1);
    }
  return M;
}

/// The four cubics and their derivatives at t.
struct Cubics {
  double N[4], d[4], dd[4];
  explicit Cubics(double t) {
    for (int i = 0; i < 4; ++i) {
      const double* c = kCubic[i];
      N[i] = c[0] + t * (c[1] + t * (c[2] + t * c[3]));
      d[i] = c[1] + t * (2 * c[2] + 3 * t * c[3]);
      dd[i] = 2 * c[2] + 6 * t * c[3];
    }
  }
};

int factorial(int n) { return n < 2 ? 1 : n * factorial(n - 1); }

}  // namespace

std::int64_t SplineBand::key(const std::array<int, 3>& at) {
  return ((at[2] + kOffset) << 2 * kBits) | ((at[1] + kOffset) << kBits) | (at[0] + kOffset);
}

std::array<int, 3> SplineBand::lattice_cell(const Vec3& x) const {
  std::array<int, 3> at;
  for (int k = 0; k < 3; ++k)
    at[k] = static_cast<int>(std::clamp(std::floor(x[k] / H_), -double(kOffset) + 8, double(kOffset) - 8));
  return at;
}

SplineBand::SplineBand(const std::vector<Vec3>& points, double H, int rings) : H_(H) {
  std::vector<std::array<int, 3>> own;
  own.reserve(points.size());
  for (const Vec3& x : points) own.push_back(lattice_cell(x));
  const auto unique = [](std::vector<std::array<int, 3>>& some) {
    std::sort(some.begin(), some.end(), [](const auto& a, const auto& b) { return key(a) < key(b); });
    some.erase(std::unique(some.begin(), some.end()), some.end());
  };
  unique(own);
  std::vector<std::array<int, 3>> band;
  for (const auto& at : own)
    for (int k = -rings; k <= rings; ++k)
      for (int j = -rings; j <= rings; ++j)
        for (int i = -rings; i <= rings; ++i) band.push_back({at[0] + i, at[1] + j, at[2] + k});
  unique(band);
  std::unordered_map<std::int64_t, int> node_at;
  for (const auto& at : band) {
    cell_at_.emplace(key(at), n_cells());
    Cell cell{at, {}};
    for (int k = 0, n = 0; k < 4; ++k)
      for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 4; ++i, ++n) {
          const auto [found, is_new] = node_at.try_emplace(key({at[0] + i, at[1] + j, at[2] + k}), n_nodes_);
          if (is_new) ++n_nodes_;
          cell.nodes[n] = found->second;
        }
    cells_.push_back(cell);
  }
}

Vec3 SplineBand::centre(int cell) const {
  const auto& at = cells_[cell].at;
  return H_ * Vec3(at[0] + .5, at[1] + .5, at[2] + .5);
}

int SplineBand::cell_of(const Vec3& x) const {
  const auto found = cell_at_.find(key(lattice_cell(x)));
  return found == cell_at_.end() ? -1 : found->second;
}

std::array<double, 3> SplineBand::local(const Cell& cell, const Vec3& x) const {
  return {x[0] / H_ - cell.at[0], x[1] / H_ - cell.at[1], x[2] / H_ - cell.at[2]};
}

void SplineBand::functions(int cell, const Vec3& x, Functions& B) const {
  const auto t = local(cells_[cell], x);
  const Cubics a(t[0]), b(t[1]), c(t[2]);
  for (int k = 0, n = 0; k < 4; ++k)
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 4; ++i, ++n)
        B.row(n) << a.N[i] * b.N[j] * c.N[k], a.d[i] * b.N[j] * c.N[k] / H_, a.N[i] * b.d[j] * c.N[k] / H_,
            a.N[i] * b.N[j] * c.d[k] / H_;
}

double SplineBand::evaluate(const std::vector<double>& coefficients, int cell, const Vec3& x, Vec3* g, Mat3* H) const {
  const Cell& at = cells_[cell];
  const auto t = local(at, x);
  const Cubics a(t[0]), b(t[1]), c(t[2]);
  double f = 0;
  Vec3 first = Vec3::Zero();
  Mat3 second = Mat3::Zero();
  for (int k = 0, n = 0; k < 4; ++k)
    for (int j = 0; j < 4; ++j) {
      double s = 0, d = 0, dd = 0;
      for (int i = 0; i < 4; ++i, ++n) {
        const double value = coefficients[at.nodes[n]];
        s += a.N[i] * value, d += a.d[i] * value, dd += a.dd[i] * value;
      }
      f += s * b.N[j] * c.N[k];
      first += Vec3(d * b.N[j] * c.N[k], s * b.d[j] * c.N[k], s * b.N[j] * c.d[k]);
      if (!H) continue;
      second(0, 0) += dd * b.N[j] * c.N[k], second(1, 1) += s * b.dd[j] * c.N[k], second(2, 2) += s * b.N[j] * c.dd[k];
      second(0, 1) += d * b.d[j] * c.N[k], second(0, 2) += d * b.N[j] * c.d[k], second(1, 2) += s * b.d[j] * c.d[k];
    }
  if (g) *g = first / H_;
  if (H) *H = second.selfadjointView<Eigen::Upper>().toDenseMatrix() / (H_ * H_);
  return f;
}

Eigen::MatrixXd SplineBand::energy(int order) const {
  Eigen::MatrixXd E = Eigen::MatrixXd::Zero(kNodes, kNodes);
  for (int i = 0; i <= order; ++i)
    for (int j = 0; i + j <= order; ++j) {
      const int k = order - i - j;
      const Eigen::Matrix4d X = products(i), Y = products(j), Z = products(k);
      const int factor = factorial(order) / (factorial(i) * factorial(j) * factorial(k));  // a whole number
      for (int a = 0; a < kNodes; ++a)
        for (int b = 0; b < kNodes; ++b)
          E(a, b) += factor * X(a % 4, b % 4) * Y(a / 4 % 4, b / 4 % 4) * Z(a / 16, b / 16);
    }
  return E * std::pow(H_, 3 - 2 * order);
}

}  // namespace umtet
