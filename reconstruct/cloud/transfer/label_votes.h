#pragma once

#include <vector>

#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// Nearest-neighbour vote on labels: the label of the surface at x_k, where its outward normal is n_k. The kVoters
/// nearest samples with normals on the same side vote (on a thin sheet, samples of the other side are near, too). If
/// none of the kNearby nearest samples is on the same side, the nearest samples vote whatever their normals. A tie is
/// decided by the nearest sample.
///
/// With a random fraction p of wrong labels, one voter is wrong with probability p, three with 3 p^2 and five with 10
/// p^3, to leading order: 5 %, .7 % and .1 % for p = .05. More voters than five would remove narrow strips.
///
/// @param normals  normals of any length; if a normal is zero, samples on all sides count
/// \throw std::invalid_argument for a cloud without points, labels or normals, or if the numbers of normals and
///        positions differ
/// Cost: O(n log n). The result does not depend on the number of threads.
std::vector<int> vote_labels(const OrientedPointCloud& cloud, const std::vector<Vec3>& places,
                             const std::vector<Vec3>& normals);

inline constexpr int kVoters = 5;   ///< samples that vote: see above
inline constexpr int kNearby = 32;  ///< nearest samples among which the voters are searched

}  // namespace umtet
