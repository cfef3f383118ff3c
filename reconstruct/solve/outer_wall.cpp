#include "reconstruct/solve/outer_wall.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "reconstruct/cloud/neighbours/neighbour_tree.h"

namespace umtet {
namespace {

// As ClosingPlan has it of cells that no sample shows.
constexpr double kWallWeight = 1e-3;
constexpr int kWallSamples = 16;  // along each edge of a face

}  // namespace

double least_wall_value(const LevelSet& psi) {
  double least = std::numeric_limits<double>::infinity();
  const Eigen::AlignedBox3d& box = psi.domain();
  for (int face = 0; face < 6; ++face) {
    for (int s = 0; s < kWallSamples * kWallSamples; ++s) {
      const int row = s / kWallSamples, column = s % kWallSamples;
      Vec3 t;  // position in the box, 0 .. 1 on each axis
      t[face / 2] = face % 2;
      t[(face / 2 + 1) % 3] = (column + 0.5) / kWallSamples;
      t[(face / 2 + 2) % 3] = (row + 0.5) / kWallSamples;
      least = std::min(least, psi.value(box.min() + t.cwiseProduct(box.sizes())));
    }
  }
  return least;
}

std::vector<SsdSample> wall_samples(const Lattice& lattice, const std::vector<SsdSample>& surface) {
  const NeighbourTree tree(SampleColumns(surface).places);
  const Eigen::Vector3i n = lattice.n - Eigen::Vector3i::Ones();  // cells
  std::vector<SsdSample> samples;
  for (int k = 0; k < n[2]; ++k) {
    for (int j = 0; j < n[1]; ++j) {
      const bool is_wall = k == 0 || k + 1 == n[2] || j == 0 || j + 1 == n[1];
      for (int i = 0; i < n[0]; i += is_wall ? 1 : std::max(1, n[0] - 1)) {
        const Vec3 x(i + .5, j + .5, k + .5);
        std::array<Neighbour, 1> room;
        const double distance = std::sqrt(tree.k_nearest(x, room).front().distance2);
        samples.push_back({x, Vec3::Zero(), kWallWeight, 0, distance});
      }
    }
  }
  return samples;
}

}  // namespace umtet
