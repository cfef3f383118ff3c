#include <algorithm>
#include <cmath>
#include <utility>

#include "reconstruct/level_set/level_volume.h"
#include "reconstruct/level_set/mask_fit.h"
#include "reconstruct/level_set/voxel_lines.h"

namespace umtet {
namespace {

// A Gaussian beyond this number of standard deviations adds less than a thousandth.
constexpr double kReach = 3.5;

/// Convolution with a Gaussian.
/// @param smooth  its standard deviation, in steps
void blur(Grid& grid, double smooth) {
  const int reach = static_cast<int>(std::ceil(kReach * smooth));
  std::vector<double> weight;
  double sum = 0;
  for (int k = -reach; k <= reach; ++k) {
    weight.push_back(smooth > 0 ? std::exp(-.5 * k * k / (smooth * smooth)) : 1);
    sum += weight.back();
  }
  for (int axis = 0; axis < 3 && reach > 0; ++axis) {
    for_each_line(grid.values, grid.n, axis, [&](const VoxelLine<double>& line) {
      std::vector<double> v(static_cast<std::size_t>(line.n));
      for (int i = 0; i < line.n; ++i) v[i] = line[i];
      for (int i = 0; i < line.n; ++i) {
        double mean = 0;
        for (int k = -reach; k <= reach; ++k) mean += weight[k + reach] * v[std::clamp(i + k, 0, line.n - 1)];
        line[i] = mean / sum;
      }
    });
  }
}

}  // namespace

MaskFit fit_mask_by_kernel(const Grid& image, std::optional<double> part, double smooth) {
  // Room for the mesh: what touches the wall of the image ends there.
  BodyVoxels voxels = body_voxels(image, part, 3 + static_cast<int>(std::ceil(kReach * smooth)));
  const VoxelMask& mask = voxels.mask;
  MaskReport report;
  report.n_inside = static_cast<std::size_t>(std::count(mask.inside.begin(), mask.inside.end(), 1));
  report.volume_of_voxels = static_cast<double>(report.n_inside) * voxels.voxel_volume();
  Grid grid{mask.n, voxels.origin, voxels.axes, centre_distances(mask, voxels.steps(), 1)};
  // Of a node on either side half a step less, so that psi = 0 is in the middle between the two sides.
  const double half = voxels.steps().minCoeff() / 2;
  const std::vector<double> depth = centre_distances(mask, voxels.steps(), 0);
  for (std::size_t i = 0; i < mask.size(); ++i)
    grid.values[i] = mask.inside[i] ? half - depth[i] : grid.values[i] - half;
  blur(grid, smooth);
  std::vector<float> values(mask.size());
  for (std::size_t i = 0; i < mask.size(); ++i) {
    values[i] = static_cast<float>(grid.values[i]);
    if ((grid.values[i] < 0) == (mask.inside[i] != 0)) continue;
    ++report.n_changed;
    report.farthest_changed = std::max(report.farthest_changed, std::abs(grid.values[i]));
  }
  std::vector<Vec3> surface = sign_changes(voxels, values);
  GridLevelSet psi = interpolate(std::move(grid));
  const std::vector<std::int32_t> one(mask.size(), 0);
  const double slack = voxels.steps().maxCoeff();
  report.volume = volumes_of_pieces(psi.in_nodes(), values, one, 1, slack)[0] * voxels.voxel_volume();
  return {std::move(psi), report, std::move(voxels), std::move(surface)};
}

}  // namespace umtet
