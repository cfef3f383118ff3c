#include "reconstruct/level_set/voxel_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "reconstruct/level_set/voxel_lines.h"

namespace umtet {
namespace {

/// The least of parabolas of curvature 2 over a line of places: the apexes are added from left to right.
///                                                                                    [FelzenszwalbHuttenlocher2012]
class LowerEnvelope {
 public:
  explicit LowerEnvelope(double step) : step2_(step * step) {}
  void clear() { apexes_.clear(); }
  void add(double at, double height) {
    if (!std::isfinite(height)) return;
    double begin = -kInfinity;
    while (!apexes_.empty()) {
      const Apex& last = apexes_.back();
      begin = ((height - last.height) / step2_ + at * at - last.at * last.at) / (2 * (at - last.at));
      if (begin > last.from) break;
      apexes_.pop_back();
      begin = -kInfinity;
    }
    apexes_.push_back({at, height, begin});
  }
  /// f(i, value) for i = 0 .. n - 1.
  template <class F>
  void evaluate(int n, const F& f) const {
    if (apexes_.empty()) return;
    std::size_t k = 0;
    for (int i = 0; i < n; ++i) {
      while (k + 1 < apexes_.size() && apexes_[k + 1].from < i) ++k;
      f(i, step2_ * (i - apexes_[k].at) * (i - apexes_[k].at) + apexes_[k].height);
    }
  }

 private:
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();
  struct Apex {
    double at, height, from;
  };
  double step2_;
  std::vector<Apex> apexes_;
};

template <class T>
std::vector<T> indicator(const VoxelMask& mask, char is_there) {
  std::vector<T> d(mask.size());
  std::transform(mask.inside.begin(), mask.inside.end(), d.begin(),
                 [&](char in) { return in == is_there ? T(0) : std::numeric_limits<T>::infinity(); });
  return d;
}

}  // namespace

std::vector<double> centre_distances(const VoxelMask& mask, const Vec3& steps, char is_there) {
  auto d = indicator<double>(mask, is_there);
  for (int axis = 0; axis < 3; ++axis) {
    for_each_line(d, mask.n, axis, [&](const VoxelLine<double>& line) {
      LowerEnvelope envelope(steps[axis]);
      for (int q = 0; q < line.n; ++q) envelope.add(q, line[q]);
      envelope.evaluate(line.n, [&](int i, double v) { line[i] = v; });
    });
  }
  for (double& v : d) v = std::sqrt(v);
  return d;
}

std::vector<float> voxel_distances(const VoxelMask& mask, const Vec3& steps, char is_there) {
  auto d = indicator<float>(mask, is_there);
  for (int axis = 0; axis < 3; ++axis) {
    for_each_line(d, mask.n, axis, [&](const VoxelLine<float>& line) {
      LowerEnvelope envelope(steps[axis]);
      constexpr float kInfinity = std::numeric_limits<float>::infinity();
      for (int q = 0; q <= line.n; ++q)
        envelope.add(q - .5, std::min(q > 0 ? line[q - 1] : kInfinity, q < line.n ? line[q] : kInfinity));
      envelope.evaluate(line.n, [&](int i, double v) { line[i] = std::min(line[i], static_cast<float>(v)); });
    });
  }
  for (float& v : d) v = std::sqrt(v);
  return d;
}

std::vector<float> signed_face_distances(const VoxelMask& mask, const Vec3& steps) {
  std::vector<float> d = voxel_distances(mask, steps, 1);
  const std::vector<float> depth = voxel_distances(mask, steps, 0);
  for (std::size_t i = 0; i < d.size(); ++i) d[i] -= depth[i];
  return d;
}

}  // namespace umtet
