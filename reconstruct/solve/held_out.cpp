#include "reconstruct/solve/held_out.h"

#include <cmath>
#include <stdexcept>

#include "reconstruct/cloud/cleaning/covering.h"

namespace umtet {
namespace {

constexpr double kSpacings = .6;  // of the known samples: see the header

}  // namespace

double HeldOutResidual::energy() const { return std::pow(rms_value / spacing, 2) + normal_defect; }

HeldOutResidual held_out_residual(const OrientedPointCloud& known, const OrientedPointCloud& held_out, double noise,
                                  const Context& context) {
  if (held_out.points.empty() || held_out.points.size() != held_out.normals.size())
    throw std::invalid_argument("held-out samples: at least one, each with a normal");
  const NeighbourDistances near = covered_distances(known.points);
  SsdParams params;
  params.spacing = kSpacings * sample_spacing(near);
  params.noise = noise;
  params.closing = Closing::None;
  const SsdFit fit = fit_ssd(known, params, context, &near);
  HeldOutResidual residual;
  residual.spacing = fit.report.spacing;
  residual.bounds_a_body = fit.report.least_wall_value >= 0;
  for (std::size_t i = 0; i < held_out.points.size(); ++i) {
    Vec3 gradient;
    residual.rms_value += std::pow(fit.psi.evaluate(held_out.points[i], &gradient, nullptr), 2);
    residual.normal_defect += (gradient - held_out.normals[i]).squaredNorm();
    residual.opposed_share += gradient.dot(held_out.normals[i]) < 0 ? 1 : 0;
  }
  const auto n = static_cast<double>(held_out.points.size());
  residual.rms_value = std::sqrt(residual.rms_value / n);
  residual.normal_defect /= n;
  residual.opposed_share /= n;
  return residual;
}

}  // namespace umtet
