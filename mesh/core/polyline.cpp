#include "mesh/core/polyline.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace umtet {
namespace {

constexpr std::size_t kSegments = 16;  // of a box: a box costs as much as one of them

}  // namespace

Polyline::Polyline(std::vector<Vec3> points) : points_(std::move(points)) {
  arc_.reserve(points_.size());
  arc_.push_back(0);
  for (std::size_t k = 0; k + 1 < points_.size(); ++k) {
    arc_.push_back(arc_.back() + (points_[k + 1] - points_[k]).norm());
    if (k % kSegments == 0) boxes_.emplace_back(points_[k]);
    boxes_.back().extend(points_[k]);
    boxes_.back().extend(points_[k + 1]);
  }
}

Polyline::Nearest Polyline::nearest(const Vec3& x) const {
  Nearest best;
  double least = std::numeric_limits<double>::infinity();
  std::size_t segment = 0;
  for (std::size_t b = 0; b < boxes_.size(); ++b) {
    if (boxes_[b].squaredExteriorDistance(x) >= least) continue;
    const std::size_t last = std::min((b + 1) * kSegments, points_.size() - 1);
    for (std::size_t k = b * kSegments; k < last; ++k) {
      const Vec3 d = points_[k + 1] - points_[k];
      const double t = std::clamp((x - points_[k]).dot(d) / d.squaredNorm(), 0., 1.);
      const Vec3 y = t < 1 ? Vec3(points_[k] + t * d) : points_[k + 1];
      const double distance = (x - y).squaredNorm();
      if (!(distance < least)) continue;
      least = distance;
      segment = k;
      best.arc = arc_[k] + t * (arc_[k + 1] - arc_[k]);
      best.point = y;
    }
  }
  best.distance = std::sqrt(least);
  best.tangent = (points_[segment + 1] - points_[segment]).normalized();
  return best;
}

Vec3 Polyline::at(double s) const {
  const auto after = std::upper_bound(arc_.begin() + 1, arc_.end() - 1, s) - arc_.begin();
  const double t = (s - arc_[after - 1]) / (arc_[after] - arc_[after - 1]);
  return points_[after - 1] + t * (points_[after] - points_[after - 1]);
}

}  // namespace umtet
