#include "reconstruct/cloud/transfer/field_transfer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <stdexcept>

#include "common/polled_loops.h"
#include "reconstruct/cloud/cloud_arrays.h"
#include "reconstruct/cloud/neighbours/neighbour_tree.h"

namespace umtet {
namespace {

// The other side of a thin sheet may have most of the nearest samples: then more are looked at, four times as many each
// time.
constexpr std::size_t kFirstLook = 32, kLastLook = 512;
// Sums of what is smaller are numbers.
constexpr double kLargest = 1e300;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

struct Weighted {
  double weight;
  std::uint32_t sample;
};

/// The nearest samples of one side, with their weights.
class Weights {
 public:
  Weights(const OrientedPointCloud& cloud, const NeighbourTree& tree, const Vec3& x, const Vec3& normal, double reach) {
    std::array<Neighbour, kLastLook> room;
    std::array<Neighbour, kAveraged + 1> chosen;
    std::size_t n = 0;
    for (std::size_t look = kFirstLook; look <= kLastLook; look *= 4) {
      const std::span<const Neighbour> near = tree.k_nearest(x, std::span(room).first(look));
      n = 0;
      for (const Neighbour& sample : near) {
        if (n == chosen.size() || !(sample.distance2 < reach * reach)) break;
        if (normal.isZero(0) || cloud.normals[sample.point].dot(normal) > 0) chosen[n++] = sample;
      }
      if (n == chosen.size() || near.size() < look || !(near.back().distance2 < reach * reach)) break;
    }
    const double radius = n == chosen.size() ? std::sqrt(chosen.back().distance2) : reach;
    n_ = std::min<std::size_t>(n, kAveraged);
    double sum = 0;
    for (std::size_t k = 0; k < n_; ++k) {
      const double r = radius > 0 ? std::sqrt(chosen[k].distance2) / radius : 0;
      const double s = (1 - r) * (1 - r);
      list_[k] = {s * s * (4 * r + 1), chosen[k].point};
      sum += list_[k].weight;
    }
    // All of them at one distance.
    if (!(sum > 0)) {
      for (std::size_t k = 0; k < n_; ++k) list_[k].weight = 1;
    }
  }
  std::span<const Weighted> list() const { return {list_.data(), n_}; }

 private:
  std::array<Weighted, kAveraged> list_;
  std::size_t n_ = 0;
};

bool is_measured(double value) { return std::abs(value) <= kLargest; }

double mean(std::span<const Weighted> samples, const std::vector<double>& values) {
  double sum = 0;
  for (const Weighted& s : samples) sum += is_measured(values[s.sample]) ? s.weight : 0;
  if (!(sum > 0)) return kNone;
  double f = 0;
  for (const Weighted& s : samples) {
    if (is_measured(values[s.sample])) f += s.weight / sum * values[s.sample];
  }
  return f;
}

Vec3 mean(std::span<const Weighted> samples, const std::vector<Colour>& colours) {
  if (samples.empty()) return Vec3::Constant(kNone);
  double sum = 0;
  Vec3 f = Vec3::Zero();
  for (const Weighted& s : samples) {
    const Colour& c = colours[s.sample];
    f += s.weight * Vec3(c[0], c[1], c[2]);
    sum += s.weight;
  }
  return f / (255 * sum);
}

}  // namespace

SurfaceFields fields_at(const OrientedPointCloud& cloud, const std::vector<Vec3>& places,
                        const std::vector<Vec3>& normals, double reach, const Context& context) {
  require_equal_lengths(cloud);
  if (cloud.points.empty() || cloud.normals.empty()) {
    throw std::invalid_argument("fields_at: every point of the cloud needs a normal");
  }
  if (places.size() != normals.size()) throw std::invalid_argument("fields_at: not as many normals as places");
  if (!(reach > 0)) throw std::invalid_argument("fields_at: reach must be > 0");
  SurfaceFields result;
  for (const SampleField& field : cloud.fields) {
    result.fields.push_back({field.name, std::vector<double>(places.size())});
  }
  if (!cloud.colours.empty()) result.colours.resize(places.size());
  const NeighbourTree tree(cloud.points);
  polled_parallel_for(places.size(), kValuesPerPoll, context, [&](std::size_t i) {
    const Weights weights(cloud, tree, places[i], normals[i], reach);
    for (std::size_t f = 0; f < cloud.fields.size(); ++f) {
      result.fields[f].values[i] = mean(weights.list(), cloud.fields[f].values);
    }
    if (!cloud.colours.empty()) result.colours[i] = mean(weights.list(), cloud.colours);
  });
  return result;
}

}  // namespace umtet
