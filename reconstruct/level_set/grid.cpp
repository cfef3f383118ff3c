#include "reconstruct/level_set/grid.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <set>

#include "common/formatted.h"
#include "reconstruct/level_set/image_level.h"

namespace umtet {
namespace {

// What a max-ent lattice needs along an axis: 2 half_width nodes.
constexpr int kLeastNodes = 6;
// Of the volume of a cell over the product of its steps: axes that lie in a plane but for rounding.
constexpr double kFlat = 1e-6;
// Nothing lies between two parts and what is around them.
constexpr std::size_t kFewValues = 3;
// Of label maps of the suite 0 to .1 of the nodes rise (layers of one voxel do), of grey images .3
// and more.
constexpr double kMostRising = .2;

bool has_few_values(const Grid& grid) {
  std::set<double> values;
  double last = -1;
  for (const double v : grid.values) {
    if (v == last) continue;
    values.insert(last = v);
    if (values.size() > kFewValues) return false;
  }
  return true;
}

/// Of the nodes whose value differs from that of a neighbour along an axis, those where it is between both.
double share_of_rising_nodes(const Grid& grid) {
  std::size_t n_changing = 0, n_rising = 0;
  const std::ptrdiff_t strides[] = {1, grid.n[0], static_cast<std::ptrdiff_t>(grid.n[0]) * grid.n[1]};
  for (int axis = 0; axis < 3; ++axis) {
    const std::ptrdiff_t s = strides[axis];
    for (std::ptrdiff_t at = 0; at < static_cast<std::ptrdiff_t>(grid.size()); ++at) {
      const auto i = static_cast<int>(at / s % grid.n[axis]);
      if (i == 0 || i + 1 == grid.n[axis]) continue;
      const double a = grid.values[at - s], b = grid.values[at], c = grid.values[at + s];
      if (a == b && b == c) continue;
      ++n_changing;
      if ((a < b && b < c) || (a > b && b > c)) ++n_rising;
    }
  }
  return n_changing == 0 ? 0 : static_cast<double>(n_rising) / static_cast<double>(n_changing);
}

}  // namespace

std::vector<std::string> problems(const Grid& grid) {
  std::vector<std::string> all;
  if (grid.n.minCoeff() < kLeastNodes) {
    all.push_back(formatted("%d x %d x %d nodes: at least %d are wanted along each axis", grid.n[0], grid.n[1],
                            grid.n[2], kLeastNodes));
  }
  if (!all.empty()) return all;
  if (grid.values.size() != grid.size()) all.push_back(formatted("%zu values, not one a node", grid.values.size()));
  const bool is_finite = grid.axes.allFinite() && grid.origin.allFinite() && grid.axes.cwiseAbs().maxCoeff() < 1e50 &&
                         grid.origin.cwiseAbs().maxCoeff() < 1e50;
  if (!is_finite || !(std::abs(grid.axes.determinant()) > kFlat * grid.steps().prod())) {
    all.push_back("spacing or directions of the axes do not span space");
  }
  const auto bad = std::find_if(grid.values.begin(), grid.values.end(), [](double v) { return !(std::abs(v) < 1e50); });
  if (bad != grid.values.end()) {
    const auto at = static_cast<std::size_t>(bad - grid.values.begin());
    const auto nx = static_cast<std::size_t>(grid.n[0]), ny = static_cast<std::size_t>(grid.n[1]);
    all.push_back(
        formatted("value (%zu, %zu, %zu) is not finite, or beyond 1e50", at % nx, at / nx % ny, at / nx / ny));
  }
  return all;
}

bool has_whole_values(const Grid& grid) {
  return std::all_of(grid.values.begin(), grid.values.end(), [](double v) { return v == std::round(v); });
}

GridKind kind_of(const Grid& grid) {
  const auto [least, greatest] = std::minmax_element(grid.values.begin(), grid.values.end());
  if (has_whole_values(grid)) {
    if (*least < 0) return GridKind::Image;
    return has_few_values(grid) || share_of_rising_nodes(grid) <= kMostRising ? GridKind::Segmentation
                                                                              : GridKind::Image;
  }
  if (!(*least < 0 && *greatest > 0)) return GridKind::Image;
  return wall_share(grid, [](double v) { return v < 0; }) > 0 ? GridKind::Image : GridKind::LevelSet;
}

}  // namespace umtet
