#include "body/scan/fitted_domain.h"

#include <utility>

namespace umtet {

Domain fitted_domain(LevelSet psi, OrientedPointCloud cloud, const LevelSetReport& report,
                     const std::optional<Box>& box) {
  Domain domain;
  domain.shift = report.shift;
  domain.cloud_spacing = report.fit.cloud_spacing;
  domain.noise = report.noise;
  domain.fitted = domain.level_set = std::move(psi);
  domain.cloud = std::move(cloud);
  Box cloud_box;
  for (Vec3& x : domain.cloud.points) {
    x -= domain.shift;
    cloud_box.extend(x);
  }
  domain.diagonal = cloud_box.diagonal().norm();
  domain.box = box ? Box(box->min() - domain.shift, box->max() - domain.shift) : domain.level_set->domain();
  return domain;
}

}  // namespace umtet
