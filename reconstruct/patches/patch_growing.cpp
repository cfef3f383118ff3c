#include "reconstruct/patches/patch_growing.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <span>
#include <tuple>

#include "common/disjoint_sets.h"
#include "reconstruct/patches/measures.h"

namespace umtet {
namespace {

constexpr std::size_t kLinks = 8;   ///< neighbours that must agree with a core: one ring of samples
constexpr std::size_t kFewest = 8;  ///< cores of a region: a quadric has six coefficients
/// Turn of normals between neighbours of a smooth region, per spacing, or per link if it is shorter. A cylinder with a
/// radius of 5 spacings turns by 11 degrees. Surfaces that curve more are divided into several regions, which merge
/// later. With 22 degrees, edges of 45 degrees are lost at a tilt of 20 degrees.
constexpr double kSmoothTurn = 12 * kDegree;
constexpr double kBetweenTurn = 22 * kDegree;  ///< the same for samples between regions: noise of filtered normals

class Growing {
 public:
  Growing(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, const Neighbourhoods& near)
      : points_(points), normals_(normals), near_(near), labels_(points.size(), -1) {}

  std::vector<int> run() {
    find_cores();
    label_components(core_, kSmoothTurn);
    flood(kBetweenTurn);
    std::vector<char> rest(points_.size());
    for (std::size_t i = 0; i < points_.size(); ++i) rest[i] = labels_[i] < 0;
    label_components(rest, kBetweenTurn);
    flood(std::numeric_limits<double>::infinity());
    for (int& label : labels_)
      if (label < 0) label = 0;
    renumber(labels_);
    return std::move(labels_);
  }

 private:
  std::span<const std::uint32_t> links(std::size_t i) const {
    return near_.points(i).first(std::min(kLinks, near_.k()));
  }
  /// The turn from i to j, as an angle per spacing for long links.
  double turn(std::size_t i, std::size_t j) const {
    return angle_between(normals_[i], normals_[j]) / std::max(1.0, (points_[i] - points_[j]).norm());
  }

  void find_cores() {
    core_.resize(points_.size());
    for (std::size_t i = 0; i < points_.size(); ++i) {
      core_[i] = 1;
      for (const std::uint32_t j : links(i))
        if (turn(i, j) > kSmoothTurn) core_[i] = 0;
    }
  }

  /// New labels for components of unlabelled members that are large enough.
  void label_components(const std::vector<char>& member, double limit) {
    DisjointSets sets(points_.size());
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (!member[i]) continue;
      for (const std::uint32_t j : links(i))
        if (member[j] && turn(i, j) <= limit) sets.unite(static_cast<int>(i), static_cast<int>(j));
    }
    std::vector<std::size_t> size(points_.size());
    for (std::size_t i = 0; i < points_.size(); ++i)
      if (member[i]) ++size[static_cast<std::size_t>(sets.find(static_cast<int>(i)))];
    const int first = next_;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (!member[i]) continue;
      const int root = sets.find(static_cast<int>(i));
      if (size[static_cast<std::size_t>(root)] >= kFewest) {
        labels_[i] = first + root;
        next_ = std::max(next_, first + root + 1);
      }
    }
  }

  /// Labels pass from sample to sample over the links of least turn.
  void flood(double limit) {
    using Step = std::tuple<double, std::uint32_t, int>;  // turn, sample, label
    std::priority_queue<Step, std::vector<Step>, std::greater<>> steps;
    const auto leave = [&](std::size_t i) {
      for (const std::uint32_t j : links(i))
        if (labels_[j] < 0 && turn(i, j) <= limit) steps.emplace(turn(i, j), j, labels_[i]);
    };
    for (std::size_t i = 0; i < points_.size(); ++i)
      if (labels_[i] >= 0) leave(i);
    while (!steps.empty()) {
      const auto [at, i, label] = steps.top();
      steps.pop();
      if (labels_[i] >= 0) continue;
      labels_[i] = label;
      leave(i);
    }
  }

  const std::vector<Vec3>&points_, &normals_;
  const Neighbourhoods& near_;
  std::vector<int> labels_;
  std::vector<char> core_;
  int next_ = 0;
};

}  // namespace

std::vector<int> grow_patches(const std::vector<Vec3>& points, const std::vector<Vec3>& normals,
                              const Neighbourhoods& near) {
  return Growing(points, normals, near).run();
}

int renumber(std::vector<int>& labels) {
  if (labels.empty()) return 0;
  std::vector<int> number(1 + static_cast<std::size_t>(*std::max_element(labels.begin(), labels.end())), -1);
  int count = 0;
  for (int& label : labels) {
    int& to = number[static_cast<std::size_t>(label)];
    if (to < 0) to = count++;
    label = to;
  }
  return count;
}

}  // namespace umtet
