#include "reconstruct/level_set/grid.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <set>

#include "common/formatted.h"

namespace umtet {
namespace {

// What a max-ent lattice needs along an axis: 2 half_width nodes.
constexpr int kLeastNodes = 6;
// Of the volume of a cell over the product of its steps: axes that lie in a plane but for rounding.
constexpr double kFlat = 1e-6;
constexpr std::size_t kMostParts = 256;

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

bool is_segmentation(const Grid& grid) {
  if (!grid.is_whole) return false;
  std::set<double> parts;
  double last = -1;
  for (const double v : grid.values) {
    if (v == last) continue;
    if (v < 0) return false;
    parts.insert(last = v);
    if (parts.size() > kMostParts) return false;
  }
  return true;
}

}  // namespace umtet
