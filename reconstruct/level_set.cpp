#include "reconstruct/level_set.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "reconstruct/detail/contract.h"

namespace umtet {

namespace {

using namespace detail;

template <JetOrder order>
void add_level(const LmeTables& tables, const LevelSetLevel& level, const Vec3& x, LatticeJet& sum) {
  const Lattice& L = level.lattice;
  const Vec3 xi = ((x - L.origin) / L.h).cwiseMax(0.0).cwiseMin((L.n.array() - 1).cast<double>().matrix());
  LmeBasis3d B;
  evaluate_lme_3d<order == kHessian>(tables, L.n, xi, B);
  const LatticeJet f = dispatch_width(
      tables.width(), [&](auto W) { return contract<W.value, order>(B, L.n, level.coefficients.data()); });
  sum.value += f.value;
  if constexpr (order >= kGradient) sum.gradient += f.gradient / L.h;
  if constexpr (order >= kHessian) sum.hessian += f.hessian / (L.h * L.h);
}

}  // namespace

LevelSet::LevelSet(const LmePrior& prior, std::vector<LevelSetLevel> levels)
    : tables_(std::make_shared<const LmeTables>(prior)), levels_(std::move(levels)) {
  if (levels_.empty()) throw std::invalid_argument("a level set needs at least one level");
  for (LevelSetLevel& level : levels_) {
    const Lattice& L = level.lattice;
    if (!(L.h > 0) || L.n.minCoeff() < tables_->width() ||
        static_cast<std::ptrdiff_t>(level.coefficients.size()) != L.size()) {
      throw std::invalid_argument("a level needs h > 0, at least 2 half_width nodes an axis and a coefficient a node");
    }
    level.coefficients.resize(level.coefficients.size() + LevelSetLevel::kPad, 0.0);
  }
  const Lattice& L = levels_.front().lattice;
  domain_ = Eigen::AlignedBox3d(L.origin, L.origin + L.h * (L.n.array() - 1).cast<double>().matrix());
}

double LevelSet::evaluate(const Vec3& x, Vec3* gradient, Mat3* hessian) const {
  LatticeJet f;
  for (const LevelSetLevel& level : levels_) {
    if (hessian)
      add_level<kHessian>(*tables_, level, x, f);
    else if (gradient)
      add_level<kGradient>(*tables_, level, x, f);
    else
      add_level<kValue>(*tables_, level, x, f);
  }
  const double outside = std::sqrt(domain_.squaredExteriorDistance(x));
  if (outside > 0) {
    const Vec3 away = x - x.cwiseMax(domain_.min()).cwiseMin(domain_.max());
    f.value += outside;
    f.gradient = (away.array() != 0).select(0.0, f.gradient.array()).matrix() + away / outside;
    f.hessian.setZero();
  }
  if (gradient) *gradient = f.gradient;
  if (hessian) *hessian = f.hessian;
  return f.value;
}

double LevelSet::value(const Vec3& x) const { return evaluate(x, nullptr, nullptr); }

Vec3 LevelSet::gradient(const Vec3& x) const {
  Vec3 g;
  evaluate(x, &g, nullptr);
  return g;
}

Mat3 LevelSet::hessian(const Vec3& x) const {
  Vec3 g;
  Mat3 H;
  evaluate(x, &g, &H);
  return H;
}

namespace {

// Least and greatest coefficient over all nodes whose function can be non-zero in the box [low, high] of the model.
LevelSet::Bounds level_bounds(const LevelSetLevel& level, int R, const Vec3& low, const Vec3& high) {
  const Lattice& L = level.lattice;
  Eigen::Vector3i first, last;
  for (int d = 0; d < 3; ++d) {
    const int cell_low = static_cast<int>(std::floor((low[d] - L.origin[d]) / L.h));
    const int cell_high = static_cast<int>(std::ceil((high[d] - L.origin[d]) / L.h)) - 1;
    first[d] = std::clamp(cell_low - R + 1, 0, L.n[d] - 1);
    last[d] = std::clamp(std::max(cell_high, cell_low) + R, 0, L.n[d] - 1);
  }
  LevelSet::Bounds b{level.coefficients[L.index(first[0], first[1], first[2])], 0};
  b.high = b.low;
  for (int k = first[2]; k <= last[2]; ++k)
    for (int j = first[1]; j <= last[1]; ++j)
      for (int i = first[0]; i <= last[0]; ++i) {
        const double c = level.coefficients[L.index(i, j, k)];
        b.low = std::min(b.low, c);
        b.high = std::max(b.high, c);
      }
  return b;
}

// Extremes over a window of 2R nodes along one axis, in place: entry i becomes the extreme over i - R + 1 .. i + R.
template <class Pick>
void sliding_extreme(std::vector<double>& a, const Eigen::Vector3i& n, int axis, int R, Pick pick) {
  const std::ptrdiff_t stride = axis == 0 ? 1 : axis == 1 ? n[0] : static_cast<std::ptrdiff_t>(n[0]) * n[1];
  std::vector<double> line(n[axis]);
  const Eigen::Vector3i others((axis + 1) % 3, (axis + 2) % 3, 0);
  const std::ptrdiff_t strides[3] = {1, n[0], static_cast<std::ptrdiff_t>(n[0]) * n[1]};
  for (int u = 0; u < n[others[0]]; ++u)
    for (int v = 0; v < n[others[1]]; ++v) {
      double* base = a.data() + u * strides[others[0]] + v * strides[others[1]];
      for (int i = 0; i < n[axis]; ++i) line[i] = base[i * stride];
      for (int i = 0; i < n[axis]; ++i) {
        double best = line[i];
        for (int q = std::max(0, i - R + 1); q <= std::min(n[axis] - 1, i + R); ++q) best = pick(best, line[q]);
        base[i * stride] = best;
      }
    }
}

}  // namespace

LevelSet::Bounds LevelSet::cell_bounds(const Eigen::Vector3i& cell) const {
  const Lattice& L = levels_.back().lattice;
  // A tenth of a per mille inside the cell: round-off must not bring in the next layer of coarse cells.
  const Vec3 low = L.origin + L.h * (cell.cast<double>().array() + 1e-4).matrix();
  const Vec3 high = low + Vec3::Constant(L.h * (1 - 2e-4));
  Bounds sum{0, 0};
  for (const LevelSetLevel& level : levels_) {
    const Bounds b = level_bounds(level, tables_->half_width(), low, high);
    sum.low += b.low, sum.high += b.high;
  }
  return sum;
}

std::vector<Vec3> LevelSet::sign_change_cells() const {
  const LevelSetLevel& finest = levels_.back();
  const Lattice& L = finest.lattice;
  const int R = tables_->half_width();
  std::vector<double> low, high;
  const bool single = levels_.size() == 1;
  if (single) {  // separable: one pass an axis instead of (2R)^3 look-ups a cell
    low.assign(finest.coefficients.begin(), finest.coefficients.begin() + L.size());
    high = low;
    for (int axis = 0; axis < 3; ++axis) {
      sliding_extreme(low, L.n, axis, R, [](double a, double b) { return std::min(a, b); });
      sliding_extreme(high, L.n, axis, R, [](double a, double b) { return std::max(a, b); });
    }
  }
  std::vector<Vec3> cells;
  Eigen::Vector3i c;
  for (c[2] = 0; c[2] + 1 < L.n[2]; ++c[2])
    for (c[1] = 0; c[1] + 1 < L.n[1]; ++c[1])
      for (c[0] = 0; c[0] + 1 < L.n[0]; ++c[0]) {
        const std::ptrdiff_t at = L.index(c[0], c[1], c[2]);
        const Bounds b = single ? Bounds{low[at], high[at]} : cell_bounds(c);
        if (b.low <= 0 && b.high >= 0) cells.push_back(L.origin + L.h * (c.cast<double>().array() + 0.5).matrix());
      }
  return cells;
}

}  // namespace umtet
