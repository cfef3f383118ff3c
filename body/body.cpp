#include "body/body.h"

#include <utility>

#include "body/label_volume.h"

namespace umtet {

// Here the two libraries meet: neither includes the other.
static_assert(JointlyEvaluated<LevelSet>);
static_assert(JointlyEvaluated<LevelSetApart>);
static_assert(JointlyEvaluated<GridLevelSet>);
static_assert(JointlyEvaluated<Domain>);

namespace {

/// psi and a constant, which is in the span of max-ent functions: they sum to one.
LevelSet raised(const LevelSet& psi, double by) {
  LevelSetLevel coarsest = psi.coarsest();
  for (double& c : coarsest.coefficients) c += by;
  std::vector<LevelSetBand> bands;
  for (int level = 1; level < psi.n_levels(); ++level) bands.push_back(psi.band(level));
  return {psi.prior(), std::move(coarsest), std::move(bands)};
}

}  // namespace

void Domain::limit_detail(double h) {
  if (!fitted) return;
  level_set = fitted->band_limited(kLeastSpacing * h);
  if (level_shift != 0) level_set = raised(*level_set, -level_shift);
}

void Domain::shift_level(double by, double h) {
  level_shift = by;
  limit_detail(h);
}

const BodySize& Domain::size() const {
  // Volume and area of closed triangles are exact, however thin the body is; a grid would have to resolve it.
  if (triangles && triangles->body.is_closed && !complement && !size_)
    size_.emplace(box, BodySize{triangles->body.volume, triangles->body.area});
  if (triangles && triangles->body.is_closed && !complement) return size_->second;
  const bool known = size_ && size_->first.min() == box.min() && size_->first.max() == box.max();
  if (known) return size_->second;
  // Thin parts of a segmentation fall between the places of an estimate.
  const auto measured = [&](ImplicitFunctionRef psi) {
    return labels && !complement ? BodySize{labels->report.volume_of_psi, labels->area}
                                 : body_size(psi, box, steepest());
  };
  size_.emplace(box, with_psi_apart(measured));
  return size_->second;
}

double Domain::evaluate(const Vec3& x, Vec3* gradient, Mat3* hessian) const {
  const ImplicitFunctionRef f = body();
  Vec3 g;
  Mat3 H;
  const double sign = complement ? -1 : 1;
  const double value = hessian ? f.value(x, g, H) : gradient ? f.value(x, g) : f.value(x);
  if (gradient) *gradient = sign * g;
  if (hessian) *hessian = sign * H;
  return sign * value;
}

void Domain::values(std::span<const Vec3> x, double* out) const {
  body().values(x, out);
  for (std::size_t i = 0; complement && i < x.size(); ++i) out[i] = -out[i];
}

ImplicitFunctionRef Domain::psi() const { return complement ? ImplicitFunctionRef(*this) : body(); }

}  // namespace umtet
