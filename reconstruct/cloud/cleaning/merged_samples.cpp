#include "reconstruct/cloud/cleaning/merged_samples.h"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_sort.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>

#include "reconstruct/cloud/cloud_arrays.h"
#include "reconstruct/cloud/neighbours/morton_order.h"

namespace umtet {
namespace {

// Cells along an axis, to either side of the middle: what a code of 63 bits has room for.
constexpr double kHalfCells = 1 << 20;
constexpr std::uint64_t kAlone = std::uint64_t{1} << 63;  // a code with the number of a point that is a cell of its own
constexpr std::size_t kPicked = 10000;                    // quantiles of .5 % are good to a tenth
constexpr double kOutside = .005;                         // of the samples beyond either end of an axis
// Cells that share the work of a task: some 100 us.
constexpr std::size_t kCellsPerTask = 1024;
// A cell that the surface passes by a corner may hold single samples of another one; a turned sample is no sheet.
constexpr double kSecondSheet = .2;
// Counts of cells go like edge^-2 until they reach the number of samples.
constexpr int kMostSteps = 12;
constexpr double kEnough = .9, kLeastStep = .25, kCloser = .97;
// Cosine of 26 degrees, as in local_noise.cpp: more is an edge.
constexpr double kAlike = .9;

std::uint64_t code_of(const Vec3& x, const Vec3& middle, double edge, std::uint32_t point) {
  const Vec3 cell = ((x - middle) / edge).array().floor();
  if (!(cell.cwiseAbs().maxCoeff() < kHalfCells)) return kAlone | point;
  std::uint64_t code = 0;
  for (int axis = 0; axis < 3; ++axis) code |= spread_bits(static_cast<std::uint64_t>(cell[axis] + kHalfCells)) << axis;
  return code;
}

/// Of the bits of the coordinates: picks the same samples in whatever order they come [Steele2014, the finaliser].
std::uint64_t mixed_bits(const Vec3& x) {
  std::uint64_t bits = 0;
  for (int axis = 0; axis < 3; ++axis) {
    bits += std::bit_cast<std::uint64_t>(x[axis] + 0.) + 0x9e3779b97f4a7c15;  // + 0: of -0 the bits of 0
    bits = (bits ^ bits >> 30) * 0xbf58476d1ce4e5b9;
    bits = (bits ^ bits >> 27) * 0x94d049bb133111eb;
    bits ^= bits >> 31;
  }
  return bits;
}

/// What is summed up of the samples that become one. Places count from the first of them: sums of far coordinates would
/// lose digits.
class Sums {
 public:
  Sums(const OrientedPointCloud& cloud, std::uint32_t first)
      : cloud_(cloud), first_(first), fields_(cloud.fields.size(), 0.), n_measured_(cloud.fields.size(), 0) {}

  /// Whether a sample is of the same part of the surface, and looks to the same side.
  bool takes(std::uint32_t i) const {
    if (!cloud_.labels.empty() && cloud_.labels[i] != cloud_.labels[first_]) return false;
    return cloud_.normals.empty() || cloud_.normals[i].dot(axis_) >= 0;
  }

  void add(std::uint32_t i) {
    const Vec3 d = cloud_.points[i] - cloud_.points[first_];
    ++n_;
    place_ += d;
    square_.noalias() += d * d.transpose();
    if (!cloud_.normals.empty() && !cloud_.normals[i].isZero(0)) {
      const Vec3& normal = cloud_.normals[i];
      if (axis_.isZero(0)) axis_ = normal;
      ++n_normals_;
      normal_ += normal;
      normal_place_ += normal.dot(d);
    }
    if (!cloud_.origins.empty()) origin_ += cloud_.origins[i] - cloud_.origins[first_];
    if (!cloud_.colours.empty())
      for (int k = 0; k < 3; ++k) colour_[k] += cloud_.colours[i][k];
    for (std::size_t f = 0; f < fields_.size(); ++f) {
      const double value = cloud_.fields[f].values[i];
      if (!std::isfinite(value)) continue;
      fields_[f] += value;
      ++n_measured_[f];
    }
  }

  int n() const { return n_; }

  void append_to(OrientedPointCloud& merged) const {
    const double n = n_;
    const Vec3 mean = place_ / n;
    const Mat3 covariance = square_ / n - mean * mean.transpose();
    Vec3 normal = Vec3::Zero();
    double off = 0, variance = 0;
    if (n_normals_ > 0 && normal_.norm() > kCancelled * n_normals_) {
      normal = normal_.normalized();
      off = (normal_.dot(mean) - normal_place_) / (2. * n_normals_);
      variance = n_ > 1 ? normal.dot(covariance * normal) * n / (n - 1) : 0;
    } else if (n_ > 3) {
      Eigen::SelfAdjointEigenSolver<Mat3> axes;
      variance = axes.computeDirect(covariance, Eigen::EigenvaluesOnly).eigenvalues()[0] * n / (n - 3);
    }
    // One sample stays what it is, bit by bit.
    merged.points.push_back(n_ == 1 ? cloud_.points[first_] : cloud_.points[first_] + mean - off * normal);
    if (!cloud_.normals.empty()) merged.normals.push_back(n_ == 1 ? cloud_.normals[first_] : normal);
    if (!cloud_.labels.empty()) merged.labels.push_back(cloud_.labels[first_]);
    if (!cloud_.origins.empty()) merged.origins.push_back(cloud_.origins[first_] + origin_ / n);
    if (!cloud_.colours.empty()) {
      Colour& colour = merged.colours.emplace_back();
      for (int k = 0; k < 3; ++k) colour[k] = static_cast<std::uint8_t>((2 * colour_[k] + n_) / (2 * n_));
    }
    for (std::size_t f = 0; f < fields_.size(); ++f) {
      merged.fields[f].values.push_back(n_measured_[f] > 0 ? fields_[f] / n_measured_[f]
                                                           : std::numeric_limits<double>::quiet_NaN());
    }
    merged.counts.push_back(n_);
    merged.spreads.push_back(std::sqrt(std::max(0., variance)));
  }

 private:
  // Of unit normals that contradict one another nothing is left.
  static constexpr double kCancelled = 1e-6;

  const OrientedPointCloud& cloud_;
  std::uint32_t first_;
  int n_ = 0, n_normals_ = 0;
  Vec3 axis_ = Vec3::Zero(), place_ = Vec3::Zero(), normal_ = Vec3::Zero(), origin_ = Vec3::Zero();
  Mat3 square_ = Mat3::Zero();
  double normal_place_ = 0;
  std::array<std::int64_t, 3> colour_{};
  std::vector<double> fields_;
  std::vector<int> n_measured_;
};

/// So that sums do not depend on the order in which samples came.
void sort_by_place(std::vector<std::uint32_t>& members, const std::vector<Vec3>& points) {
  std::sort(members.begin(), members.end(), [&](std::uint32_t a, std::uint32_t b) {
    const Vec3 &x = points[a], &y = points[b];
    for (int axis = 0; axis < 3; ++axis)
      if (x[axis] != y[axis]) return x[axis] < y[axis];
    return a < b;
  });
}

OrientedPointCloud without_samples(const OrientedPointCloud& cloud) {
  OrientedPointCloud none;
  for (const SampleField& field : cloud.fields) none.fields.push_back({field.name, {}});
  return none;
}

/// Behind what `all` holds. Both have the same arrays.
void append(OrientedPointCloud& all, const OrientedPointCloud& more) {
  const auto add = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  add(all.points, more.points);
  add(all.normals, more.normals);
  add(all.labels, more.labels);
  add(all.origins, more.origins);
  add(all.colours, more.colours);
  add(all.counts, more.counts);
  add(all.spreads, more.spreads);
  for (std::size_t f = 0; f < all.fields.size(); ++f) add(all.fields[f].values, more.fields[f].values);
}

}  // namespace

SampleCells::SampleCells(const std::vector<Vec3>& points, double edge, const Vec3& middle) : edge_(edge) {
  if (points.size() > std::numeric_limits<std::uint32_t>::max())
    throw std::invalid_argument(std::to_string(points.size()) + " points: more than 32 bits can number");
  rows_.resize(points.size());
  tbb::parallel_for(std::size_t{0}, points.size(), [&](std::size_t i) {
    const auto point = static_cast<std::uint32_t>(i);
    rows_[i] = {code_of(points[i], middle, edge, point), point};
  });
  tbb::parallel_sort(rows_.begin(), rows_.end());
  for (std::size_t row = 0; row < rows_.size(); ++row)
    if (row == 0 || rows_[row].code != rows_[row - 1].code) begin_.push_back(row);
  begin_.push_back(rows_.size());
}

CoreBox core_box(const std::vector<Vec3>& points) {
  const std::size_t stride = std::max<std::size_t>(1, points.size() / kPicked);
  std::vector<Vec3> some;
  for (const Vec3& x : points)
    if (mixed_bits(x) % stride == 0) some.push_back(x);
  if (some.empty()) some = points;
  CoreBox core;
  Vec3 sides;
  std::vector<double> picked(some.size());
  for (int axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < some.size(); ++i) picked[i] = some[i][axis];
    std::sort(picked.begin(), picked.end());
    const auto out = static_cast<std::size_t>(kOutside * static_cast<double>(picked.size()));
    const double low = picked[out], high = picked[picked.size() - 1 - out];
    core.middle[axis] = low + (high - low) / 2;
    sides[axis] = high - low;
  }
  core.diagonal = sides.norm();
  return core;
}

SampleCells cells_for(const std::vector<Vec3>& points, const CoreBox& core, double largest, std::size_t fewest) {
  SampleCells cells(points, largest, core.middle);
  const auto wanted = static_cast<double>(std::min(fewest, points.size()));
  for (int step = 0; step < kMostSteps && static_cast<double>(cells.size()) < kEnough * wanted; ++step) {
    const double shrink = kCloser * std::sqrt(static_cast<double>(cells.size()) / wanted);
    const double edge = std::max(shrink, kLeastStep) * cells.edge();
    cells = SampleCells({}, edge, core.middle);  // two of them at once are not needed
    cells = SampleCells(points, edge, core.middle);
  }
  return cells;
}

MergedSamples merged_samples(const OrientedPointCloud& cloud, const SampleCells& cells,
                             const std::function<bool(const Vec3&)>& stays) {
  require_equal_lengths(cloud);
  struct Part {
    OrientedPointCloud cloud;
    std::size_t n_two_sided = 0;
  };
  std::vector<Part> parts((cells.size() + kCellsPerTask - 1) / kCellsPerTask);
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t p) {
    Part& part = parts[p];
    part.cloud = without_samples(cloud);
    std::vector<std::uint32_t> members;
    std::vector<Sums> found;
    for (std::size_t cell = p * kCellsPerTask; cell < std::min(cells.size(), (p + 1) * kCellsPerTask); ++cell) {
      members.clear();
      cells.for_each_point(cell, [&](std::uint32_t i) { members.push_back(i); });
      sort_by_place(members, cloud.points);
      found.clear();
      if (stays && stays(cloud.points[members.front()])) {
        for (const std::uint32_t i : members) {
          Sums one(cloud, i);
          one.add(i);
          one.append_to(part.cloud);
        }
        continue;
      }
      for (const std::uint32_t i : members) {
        const auto sums = std::find_if(found.begin(), found.end(), [i](const Sums& s) { return s.takes(i); });
        (sums == found.end() ? found.emplace_back(cloud, i) : *sums).add(i);
      }
      for (const Sums& sums : found) sums.append_to(part.cloud);
      if (cloud.labels.empty() && found.size() > 1) {
        const int most = std::max_element(found.begin(), found.end(), [](const Sums& a, const Sums& b) {
                           return a.n() < b.n();
                         })->n();
        const auto n = static_cast<double>(members.size());
        part.n_two_sided += n - most >= kSecondSheet * n ? 1 : 0;
      }
    }
  });
  MergedSamples result;
  result.cloud = without_samples(cloud);
  for (Part& part : parts) {
    append(result.cloud, part.cloud);
    result.n_two_sided += part.n_two_sided;
    part.cloud = {};
  }
  return result;
}

std::vector<double> relative_counts(const std::vector<int>& counts, const Neighbourhoods& near) {
  std::vector<double> weights(counts.size());
  tbb::parallel_for(std::size_t{0}, counts.size(), [&](std::size_t i) {
    double sum = counts[i];
    for (const std::uint32_t j : near.points(i)) sum += counts[j];
    weights[i] = counts[i] * static_cast<double>(near.k() + 1) / sum;
  });
  return weights;
}

double noise_before_merging(const OrientedPointCloud& cloud, const NeighbourTree& tree, std::size_t sampled_points) {
  const std::size_t stride = std::max<std::size_t>(1, tree.size() / sampled_points);
  std::vector<double> variances((tree.size() + stride - 1) / stride);
  tbb::parallel_for(std::size_t{0}, variances.size(), [&](std::size_t p) {
    const std::uint32_t i = tree.order()[p * stride];
    std::array<Neighbour, Neighbourhoods::kDefault + 1> room;
    double n = 0, sum = 0, square = 0;
    for (const Neighbour& other : tree.k_nearest(cloud.points[i], room)) {
      const std::uint32_t j = other.point;
      const Vec3 &a = cloud.normals[i], &b = cloud.normals[j];
      if (j != i && a.dot(b) < kAlike) continue;
      const double count = cloud.counts[j], d = (a + b).dot(cloud.points[j] - cloud.points[i]) / 2;
      n += count;
      sum += count * d;
      square += count * d * d + (count - 1) * cloud.spreads[j] * cloud.spreads[j];
    }
    variances[p] = square / n - std::pow(sum / n, 2);
  });
  const auto middle = variances.begin() + static_cast<std::ptrdiff_t>(variances.size() / 2);
  std::nth_element(variances.begin(), middle, variances.end());
  return std::sqrt(std::max(0., *middle));
}

}  // namespace umtet
