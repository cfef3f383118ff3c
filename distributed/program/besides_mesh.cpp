#include "distributed/program/besides_mesh.h"

#include "reconstruct/cloud/cloud_arrays.h"

namespace umtet {
namespace {

// Bytes per area h^2 of the boundary, for points of psi = 0 and for faces; if psi is fitted to samples, also for its
// cells and the distances of samples. They were chosen so that all ranks have similar peaks in the runs of ../README.md
// with 4 ranks: 4.8 M and 20 M tets of a formula, 7.1 M and 20 M tets of samples.
constexpr double kBytesPerSquare = 600, kBytesPerFittedSquare = 1100;

}  // namespace

double bytes_besides_mesh(const Domain& domain, double h) {
  double bytes = (domain.fitted ? kBytesPerFittedSquare : kBytesPerSquare) * domain.size().area / (h * h);
  for_each_array(domain.cloud, [&](const auto& array, const auto&) {
    bytes += static_cast<double>(array.size() * sizeof(array.front()));
  });
  if (!domain.fitted) return bytes;
  for (int level = domain.level_set->n_levels(); level < domain.fitted->held().n_levels(); ++level)
    bytes += static_cast<double>(domain.fitted->held().band(level).coefficients.size() * sizeof(float));
  return bytes;
}

}  // namespace umtet
