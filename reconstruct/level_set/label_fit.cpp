#include "reconstruct/level_set/label_fit.h"

#include <Eigen/LU>
#include <cmath>
#include <utility>

namespace umtet {
namespace {

// Within it psi is evaluated: the tets of a surface that are two voxels long and their neighbours need no more.
constexpr float kNear = 4;  // in the largest step

}  // namespace

LabelLevelSet::LabelLevelSet(MaskFit fit, bool is_outside)
    : psi_(std::move(fit.psi)),
      report_(fit.report),
      voxels_(std::move(fit.voxels)),
      to_nodes_(voxels_.axes.inverse()),
      far_(kNear * voxels_.steps().maxCoeff()),
      sign_(is_outside ? -1 : 1) {
  const std::vector<float> d = signed_face_distances(voxels_.mask, voxels_.steps());
  place_.reserve(d.size());
  for (const float distance : d)
    place_.push_back(std::abs(distance) <= far_ ? Place::Near : distance < 0 ? Place::Inside : Place::Outside);
}

double LabelLevelSet::evaluate(const Vec3& x, Vec3* gradient, Mat3* hessian) const {
  const Vec3 at = to_nodes_ * (x - voxels_.origin);
  const Eigen::Vector3i& n = voxels_.mask.n;
  const bool is_in = (at.array() > -.5).all() && (at.array() < n.cast<double>().array() - .5).all();
  Place place = Place::Outside;
  if (is_in) {
    const Eigen::Vector3i i = at.array().round().cast<int>();
    place = place_[static_cast<std::size_t>(voxels_.mask.index(i[0], i[1], i[2]))];
  }
  if (place != Place::Near) {
    if (gradient) gradient->setZero();
    if (hessian) hessian->setZero();
    return place == Place::Inside ? -sign_ * far_ : sign_ * far_;
  }
  const double value = psi_.evaluate(x, gradient, hessian);
  if (gradient) *gradient *= sign_;
  if (hessian) *hessian *= sign_;
  return sign_ * value;
}

std::vector<LabelLevelSet> fit_labels(const Grid& grid, const std::vector<double>& labels) {
  Grid mask = grid;
  for (std::size_t i = 0; i < grid.values.size(); ++i) {
    bool is_in = false;
    for (const double label : labels) is_in = is_in || grid.values[i] == label;
    mask.values[i] = is_in ? 1 : 0;
  }
  std::vector<LabelLevelSet> functions;
  functions.reserve(labels.size() + 1);
  functions.emplace_back(fit_mask(mask, std::nullopt), true);
  for (const double label : labels) functions.emplace_back(fit_mask(grid, label), false);
  return functions;
}

}  // namespace umtet
