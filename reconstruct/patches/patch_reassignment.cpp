#include "reconstruct/patches/patch_reassignment.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace umtet {
namespace {

constexpr int kPottsRounds = 3;
constexpr std::size_t kNearBorder = 24;      ///< a sample with another label among so many neighbours is near a border
constexpr std::size_t kPottsNeighbours = 8;  ///< of the Potts term
constexpr double kPotts = .5;                ///< per neighbour of another patch
constexpr double kMost = 50;                 ///< of each residual squared: seven deviations are an outlier of any patch
constexpr double kMostFiltered = 1;          ///< for normals that are estimated from the same positions
/// Standard deviation of a filtered normal that is compared with a sheet's: what curvature and filter leave, radians.
constexpr double kFiltered = 8 * std::numbers::pi / 180;

struct Candidate {
  int label;
  double cost;
};

std::vector<Candidate> candidates_of(const PatchCloud& cloud, const std::vector<int>& labels, std::size_t i) {
  std::vector<Candidate> found;
  const auto add = [&](int label) {
    for (const Candidate& c : found)
      if (c.label == label) return;
    found.push_back({label, std::numeric_limits<double>::infinity()});
  };
  add(labels[i]);
  for (const std::uint32_t j : cloud.nearest(i, kNearBorder)) add(labels[j]);
  if (found.size() == 1) return found;
  const bool is_measured = cloud.has_measured_normals();
  const double deviation = is_measured ? cloud.tilt : kFiltered;
  const Vec3& normal = is_measured ? cloud.measured[i] : cloud.normals[i];
  for (Candidate& c : found) {
    const auto sheet = sheet_near(cloud, labels, c.label, i, Itself::LeftOut);
    if (!sheet) continue;
    const double d = sheet->distance(cloud.points[i]) / cloud.noise;
    const double a = (sheet->normal(cloud.points[i]) - normal).norm() / deviation;
    c.cost = std::min(kMost, d * d) + std::min(is_measured ? kMost : kMostFiltered, a * a);
  }
  return found;
}

int best_of(const PatchCloud& cloud, const std::vector<int>& labels, const std::vector<Candidate>& found,
            std::size_t i) {
  int best = labels[i];
  double least = std::numeric_limits<double>::infinity();
  for (const Candidate& c : found) {
    double cost = c.cost;
    for (const std::uint32_t j : cloud.nearest(i, kPottsNeighbours)) cost += labels[j] == c.label ? 0 : kPotts;
    if (cost < least) {
      least = cost;
      best = c.label;
    }
  }
  return best;
}

}  // namespace

std::size_t reassign_at_borders(const PatchCloud& cloud, std::vector<int>& labels) {
  const std::vector<int> before = labels;
  std::vector<std::vector<Candidate>> found(cloud.size());
  for (int round = 0; round < kPottsRounds; ++round) {
    tbb::parallel_for(std::size_t{0}, cloud.size(), [&](std::size_t i) { found[i] = candidates_of(cloud, labels, i); });
    for (std::size_t i = 0; i < cloud.size(); ++i)
      if (found[i].size() > 1) labels[i] = best_of(cloud, labels, found[i], i);
  }
  std::size_t changed = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) changed += labels[i] != before[i];
  return changed;
}

}  // namespace umtet
