#include "mesh/regions/detail/vertex_places.h"

#include <Eigen/Dense>
#include <algorithm>
#include <bit>

namespace umtet::detail {
namespace {

constexpr int kMostSteps = 30;        // of Gauss's and Newton's method; it converges in a few
constexpr double kArrived = 1e-11;    // in h
constexpr double kFarthest = 2;       // in h, from the vertex
constexpr double kLeastPivot = 1e-3;  // of unit gradients: below it sheets are parallel

}  // namespace

std::vector<int> patches_between(const RegionDomain& domain, RegionSet regions) {
  std::vector<int> patches;
  for (RegionSet as = regions; as != 0; as &= as - 1)
    for (RegionSet bs = as & (as - 1); bs != 0; bs &= bs - 1)
      patches.push_back(domain.patch(std::countr_zero(as), std::countr_zero(bs)));
  std::sort(patches.begin(), patches.end());
  patches.erase(std::unique(patches.begin(), patches.end()), patches.end());
  return patches;
}

Vec3 common_zero(const RegionDomain& domain, const std::vector<int>& patches, const Vec3& x, double h) {
  Vec3 y = x;
  Eigen::MatrixX3d A(patches.size(), 3);
  Eigen::VectorXd b(patches.size());
  for (int step = 0; step < kMostSteps; ++step) {
    for (std::size_t k = 0; k < patches.size(); ++k) {
      Vec3 g;
      const double value = domain.boundary().patch(patches[k], y, &g), norm = g.norm();
      const auto row = static_cast<Eigen::Index>(k);
      A.row(row) = g.transpose() / norm;
      b[row] = value / norm;
    }
    if (!A.allFinite() || !b.allFinite()) return x;
    Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixX3d> solver;
    solver.setThreshold(kLeastPivot);
    solver.compute(A);
    Vec3 move = solver.solve(b);
    const double length = move.norm();
    if (length > h) move *= h / length;
    y -= move;
    if ((y - x).norm() > kFarthest * h) return x;
    if (length <= kArrived * h) break;
  }
  return y;
}

Stratum stratum_of(const RegionDomain& domain, RegionSet regions) {
  const int n = std::popcount(regions);
  Stratum stratum;
  stratum.patches = patches_between(domain, regions);
  stratum.dimension = n == 2 ? 2 : n == 3 ? 1 : 0;
  return stratum;
}

Vec3 VertexPlaces::at(std::size_t vertex, RegionSet regions, const Vec3& x, double h) {
  if (std::popcount(regions) < 2) return x;
  for (const Place& p : known_[vertex])
    if (p.regions == regions) return p.place;
  Vec3 place = common_zero(domain_, patches_between(domain_, regions), x, h);
  known_[vertex].push_back({regions, place});
  return place;
}

}  // namespace umtet::detail
