#include "reconstruct/cloud/transfer/label_votes.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <span>
#include <stdexcept>

#include "reconstruct/cloud/neighbours/neighbour_tree.h"

namespace umtet {
namespace {

/// @param labels  nearest first, at least one
int most_frequent(std::span<const int> labels) {
  int winner = labels.front();
  std::ptrdiff_t most = 0;
  for (const int label : labels) {
    const auto n = std::count(labels.begin(), labels.end(), label);
    if (n <= most) continue;
    most = n;
    winner = label;
  }
  return winner;
}

int vote(const OrientedPointCloud& cloud, const NeighbourTree& tree, const Vec3& x, const Vec3& normal) {
  std::array<Neighbour, kNearby> room;
  const std::span<const Neighbour> near = tree.k_nearest(x, room);
  std::array<int, kVoters> labels;
  std::size_t n = 0;
  for (const Neighbour& sample : near) {
    if (n < labels.size() && cloud.normals[sample.point].dot(normal) > 0) labels[n++] = cloud.labels[sample.point];
  }
  if (n > 0) return most_frequent({labels.data(), n});
  for (const Neighbour& sample : near.first(std::min(near.size(), labels.size()))) {
    labels[n++] = cloud.labels[sample.point];
  }
  return most_frequent({labels.data(), n});
}

}  // namespace

std::vector<int> vote_labels(const OrientedPointCloud& cloud, const std::vector<Vec3>& places,
                             const std::vector<Vec3>& normals) {
  const std::size_t n = cloud.points.size();
  if (n == 0 || cloud.labels.size() != n || cloud.normals.size() != n) {
    throw std::invalid_argument("vote_labels: every point of the cloud needs a label and a normal");
  }
  if (places.size() != normals.size()) throw std::invalid_argument("vote_labels: not as many normals as places");
  const NeighbourTree tree(cloud.points);
  std::vector<int> labels(places.size());
  tbb::parallel_for(std::size_t{0}, places.size(),
                    [&](std::size_t i) { labels[i] = vote(cloud, tree, places[i], normals[i]); });
  return labels;
}

}  // namespace umtet
