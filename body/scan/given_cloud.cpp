#include "body/scan/given_cloud.h"

#include <stdexcept>
#include <utility>

#include "common/formatted.h"
#include "reconstruct/cloud/cloud_arrays.h"

namespace umtet {
namespace {

// Squares stay finite: the limit of files.
constexpr double kFarthest = 1e50;

void require_length(const char* name, std::size_t n, std::size_t n_points) {
  if (n == 0 || n == n_points) return;
  throw std::invalid_argument(formatted("%s: as many as points are wanted, or none: %zu for %zu", name, n, n_points));
}

}  // namespace

CloudFile given_cloud(OrientedPointCloud cloud) {
  const std::size_t n = cloud.points.size();
  require_length("normals", cloud.normals.size(), n);
  require_length("labels", cloud.labels.size(), n);
  require_length("origins", cloud.origins.size(), n);
  for (std::size_t i = 0; i < n; ++i) {
    if (cloud.points[i].cwiseAbs().maxCoeff() <= kFarthest && cloud.points[i].allFinite()) continue;
    throw std::invalid_argument(formatted("points[%zu] is not finite, or beyond 1e50", i));
  }
  for (Vec3& n : cloud.normals) n = n.allFinite() && !n.isZero(0) ? unit_normal(n) : Vec3::Zero();
  CloudFile file;
  file.report.format = "arrays";
  file.report.n_points = n;
  file.cloud = std::move(cloud);
  return file;
}

}  // namespace umtet
