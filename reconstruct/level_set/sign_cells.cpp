#include "reconstruct/level_set/sign_cells.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "reconstruct/basis/contract.h"

namespace umtet {

namespace {

struct Range {
  double low = 0, high = 0;
};

// What is left of the coefficients of a window when an affine function is taken away: least and greatest.
// @param corner  the affine function at the first node
// @param g       its change from node to node
template <int W, class T>
Range rest_of(const CoefficientWindow<T>& window, double corner, const Vec3& g) {
  // One lane for each column: no operation waits for the one before.
  std::array<double, W> low, high;
  low.fill(std::numeric_limits<double>::infinity());
  high.fill(-std::numeric_limits<double>::infinity());
  for (int z = 0; z < W; ++z)
    for (int y = 0; y < W; ++y) {
      const T* c = window.first + window.row * y + window.layer * z;
      const double row = corner + g[1] * y + g[2] * z;
      for (int x = 0; x < W; ++x) {
        const double rest = static_cast<double>(c[x]) - (row + g[0] * x);
        low[x] = rest < low[x] ? rest : low[x];
        high[x] = rest > high[x] ? rest : high[x];
      }
    }
  return {*std::min_element(low.begin(), low.end()), *std::max_element(high.begin(), high.end())};
}

// sup |sum e_a H(N_a)| / max|e_a|, in lattice units: the row sums of a matrix with entries S'' = sum |N''| on the
// diagonal and S' S' off it.
double second_derivative_bound(const LmeTables& tables, bool at_walls) {
  constexpr int kSamples = 2000;  // an axis cell; the sums are smooth between the pieces of the tables
  constexpr double kMargin = 1.02;
  const int R = tables.half_width(), n = 4 * R;
  double first = 0, second = 0;
  const int from = at_walls ? 0 : R, to = at_walls ? R : R + 1;
  for (int s = 0; s <= (to - from) * kSamples; ++s) {
    LmeBasis1d B;
    tables.evaluate<true>(n, from + static_cast<double>(s) / kSamples, B);
    double s1 = 0, s2 = 0;
    for (int a = 0; a < tables.width(); ++a) s1 += std::abs(B.dN[a]), s2 += std::abs(B.ddN[a]);
    first = std::max(first, s1), second = std::max(second, s2);
  }
  return kMargin * (second + 2 * first * first);
}

class CellSearch {
 public:
  CellSearch(const LevelSet& psi, int depth);
  // Adds the cubes of depth `depth_` in a cube of `depth`; at depth 0, a cell of the coarsest lattice.
  void search(int depth, const Eigen::Vector3i& cell, std::vector<Eigen::Vector3i>& found) const;

 private:
  void split(int depth, const Eigen::Vector3i& cell, double bend, std::vector<Eigen::Vector3i>& found) const;
  bool has_one_sign(const Eigen::Vector3i& cell) const;
  // One level in one of its cells: its value and gradient in the middle, and C max|e_a| / h^2.
  struct LevelInCell {
    double value = 0, bend = 0;
    Vec3 gradient = Vec3::Zero();
  };
  LevelInCell level_in_cell(int level, const Eigen::Vector3i& cell) const;
  Range finer_levels(int depth, const Vec3& low, const Vec3& high) const;

  const LevelSet& psi_;
  int depth_, R_;
  double inside_, at_walls_;                     // C
  std::vector<std::vector<Range>> block_range_;  // of the coefficients in each block of each band
};

CellSearch::CellSearch(const LevelSet& psi, int depth)
    : psi_(psi),
      depth_(depth),
      R_(psi.tables().half_width()),
      inside_(second_derivative_bound(psi.tables(), false)),
      at_walls_(second_derivative_bound(psi.tables(), true)),
      block_range_(psi.n_levels()) {
  for (int level = 1; level < psi.n_levels(); ++level) {
    const LevelSetBand& band = psi.band(level);
    for (int b = 0; b < band.blocks.size(); ++b) {
      const auto begin = band.coefficients.begin() + static_cast<std::ptrdiff_t>(b) * LatticeBlocks::kNodes;
      const auto [low, high] = std::minmax_element(begin, begin + LatticeBlocks::kNodes);
      block_range_[level].push_back({std::min(0.0, double(*low)), std::max(0.0, double(*high))});
    }
  }
}

CellSearch::LevelInCell CellSearch::level_in_cell(int level, const Eigen::Vector3i& cell) const {
  const Lattice& L = psi_.lattice(level);
  CoefficientWindow<float> of_band{};
  if (level > 0) of_band = psi_.band_window(level, cell);
  LevelInCell result;
  if (level > 0 && of_band.first == nullptr) return result;
  const Vec3 middle = cell.cast<double>() + Vec3::Constant(0.5);
  result.value = psi_.evaluate_level(level, L.origin + L.h * middle, &result.gradient, nullptr);
  const Vec3 g = L.h * result.gradient;
  const Eigen::Vector3i first = (cell.array() - R_ + 1).cwiseMax(0).min(L.n.array() - 2 * R_);
  const double corner = result.value + g.dot(first.cast<double>() - middle);
  const Range e = simd::dispatch_width(2 * R_, [&](auto W) {
    return level == 0 ? rest_of<W.value>(psi_.coarsest_window(cell), corner, g) : rest_of<W.value>(of_band, corner, g);
  });
  const bool wall = (cell.array() < R_ - 1).any() || (cell.array() > L.n.array() - 1 - R_).any();
  result.bend = (wall ? at_walls_ : inside_) * (e.high - e.low) / 2 / (L.h * L.h);
  return result;
}

// The sum of all levels finer than a cube of `depth` in that cube.
Range CellSearch::finer_levels(int depth, const Vec3& low, const Vec3& high) const {
  Range sum;
  for (int level = depth + 1; level < psi_.n_levels(); ++level) {
    const LatticeBlocks& blocks = psi_.band(level).blocks;
    const Lattice& L = blocks.lattice();
    const int shift = blocks.shift();
    Range r;
    Eigen::Vector3i first, last;
    for (int d = 0; d < 3; ++d) {  // nodes whose functions meet the cube, by blocks
      first[d] = static_cast<int>(std::floor((low[d] - L.origin[d]) / L.h - R_)) + shift;
      last[d] = static_cast<int>(std::ceil((high[d] - L.origin[d]) / L.h + R_)) + shift;
    }
    for (int z = first[2] >> 3; z <= last[2] >> 3; ++z)
      for (int y = first[1] >> 3; y <= last[1] >> 3; ++y)
        for (int x = first[0] >> 3; x <= last[0] >> 3; ++x) {
          const int b = blocks.at({x, y, z});
          if (b < 0) continue;
          r.low = std::min(r.low, block_range_[level][b].low), r.high = std::max(r.high, block_range_[level][b].high);
        }
    sum.low += r.low, sum.high += r.high;
  }
  return sum;
}

// A cell of the coarsest lattice far from any zero: a sum of functions that are >= 0 and sum to one lies between the
// least and the greatest coefficient. Most cells end here, before their second derivatives are looked at.
bool CellSearch::has_one_sign(const Eigen::Vector3i& cell) const {
  const Range c = simd::dispatch_width(
      2 * R_, [&](auto W) { return rest_of<W.value>(psi_.coarsest_window(cell), 0, Vec3::Zero()); });
  if (c.low <= 0 && c.high >= 0) return false;
  const Lattice& L = psi_.coarsest().lattice;
  const Vec3 low = L.origin + L.h * cell.cast<double>();
  const Range finer = finer_levels(0, low, low + Vec3::Constant(L.h));
  return c.low + finer.low > 0 || c.high + finer.high < 0;
}

// @param bend  bound of the second derivatives of the levels coarser than the cube
void CellSearch::split(int depth, const Eigen::Vector3i& cell, double bend, std::vector<Eigen::Vector3i>& found) const {
  const Lattice& L = psi_.coarsest().lattice;
  const double edge = std::ldexp(L.h, -depth);
  const LevelInCell finest = depth < psi_.n_levels() ? level_in_cell(depth, cell) : LevelInCell();
  bend += finest.bend;
  const Vec3 low = L.origin + edge * cell.cast<double>(), middle = low + Vec3::Constant(edge / 2);
  double value = 0;
  Vec3 gradient = Vec3::Zero(), g;
  if (depth + 1 >= psi_.n_levels()) {
    value = psi_.evaluate(middle, &gradient, nullptr);
  } else {
    for (int level = 0; level < depth; ++level) {
      value += psi_.evaluate_level(level, middle, &g, nullptr);
      gradient += g;
    }
    value += finest.value;
    gradient += finest.gradient;
  }
  const Range finer = finer_levels(depth, low, low + Vec3::Constant(edge));
  const double curved = bend * 0.75 * edge * edge / 2;  // half a diagonal off the middle
  // psi differs from its linearisation by `curved` at most, in the cube and so in each eighth of it.
  const auto has_zero = [&](double linear, double half_edge) {
    const double slack = gradient.cwiseAbs().sum() * half_edge + curved;
    return linear - slack + finer.low <= 0 && linear + slack + finer.high >= 0;
  };
  if (!has_zero(value, edge / 2)) return;
  if (depth == depth_) {
    found.push_back(cell);
    return;
  }
  for (int q = 0; q < 8; ++q) {
    const Eigen::Vector3i octant(q & 1, q >> 1 & 1, q >> 2);
    const Vec3 off = edge / 4 * (2 * octant.cast<double>() - Vec3::Ones());
    if (has_zero(value + gradient.dot(off), edge / 4)) split(depth + 1, 2 * cell + octant, bend, found);
  }
}

void CellSearch::search(int depth, const Eigen::Vector3i& cell, std::vector<Eigen::Vector3i>& found) const {
  if (depth == 0 && has_one_sign(cell)) return;
  double bend = 0;
  for (int level = 0; level < std::min(depth, psi_.n_levels()); ++level) {
    const int up = depth - level;
    bend += level_in_cell(level, {cell[0] >> up, cell[1] >> up, cell[2] >> up}).bend;
  }
  split(depth, cell, bend, found);
}

int depth_of(const LevelSet& psi, double size) {
  constexpr int kMostHalvings = 20;
  int depth = 0;
  while (depth <= kMostHalvings && std::ldexp(psi.coarsest().lattice.h, -depth) > size) ++depth;
  if (!(size > 0) || depth > kMostHalvings) throw std::invalid_argument("cubes of this size cannot be made");
  return depth;
}

void sort_by_place(std::vector<Eigen::Vector3i>& cells) {
  std::sort(cells.begin(), cells.end(), [](const auto& a, const auto& b) {
    return std::array{a[2], a[1], a[0]} < std::array{b[2], b[1], b[0]};
  });
}

}  // namespace

SignCells sign_cells(const LevelSet& psi, double size) {
  const Lattice& L = psi.coarsest().lattice;
  const int depth = depth_of(psi, size);
  const CellSearch search(psi, depth);
  const Eigen::Vector3i n = (L.n.array() - 1).matrix();
  std::vector<std::vector<Eigen::Vector3i>> layers(n[2]);
  tbb::parallel_for(0, n[2], [&](int k) {
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i) search.search(0, {i, j, k}, layers[k]);
    sort_by_place(layers[k]);
  });
  SignCells result{L.origin, std::ldexp(L.h, -depth), {}};
  for (const auto& layer : layers) result.cells.insert(result.cells.end(), layer.begin(), layer.end());
  return result;
}

SignCells sign_cells_within(const LevelSet& psi, const SignCells& cells, const std::vector<int>& which, double size) {
  const Lattice& L = psi.coarsest().lattice;
  const int from = depth_of(psi, cells.size), depth = depth_of(psi, size);
  if (cells.origin != L.origin || cells.size != std::ldexp(L.h, -from) || depth < from) {
    throw std::invalid_argument("no cubes of this size within cubes of that");
  }
  const CellSearch search(psi, depth);
  std::vector<std::vector<Eigen::Vector3i>> found(which.size());
  tbb::parallel_for(std::size_t{0}, which.size(),
                    [&](std::size_t i) { search.search(from, cells.cells.at(which[i]), found[i]); });
  SignCells result{L.origin, std::ldexp(L.h, -depth), {}};
  for (const auto& some : found) result.cells.insert(result.cells.end(), some.begin(), some.end());
  sort_by_place(result.cells);
  return result;
}

}  // namespace umtet
