#pragma once

#include <vector>

#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// The label of the surface at x_k, where its outward normal is n_k: that of most of the kVoters nearest samples whose
/// own normals look to the same side (on a thin sheet the samples of the other side are near, too), or of the nearest
/// samples whatever their normals where none of the kNearby nearest does. Of equally many votes the nearest sample's.
///
/// Five: where a share p of the labels is wrong, at random, one voter is wrong with probability p, three with 3 p^2 and
/// five with 10 p^3, to leading order: 5 %, .7 % and .1 % for p = .05. More voters would take narrow strips away.
///
/// @param normals  of any length; zero: no side
/// \throw std::invalid_argument  a cloud without points, labels or normals, or not as many normals as places
/// Cost: O(n log n). The result does not depend on the number of threads.
std::vector<int> vote_labels(const OrientedPointCloud& cloud, const std::vector<Vec3>& places,
                             const std::vector<Vec3>& normals);

inline constexpr int kVoters = 5;   ///< samples that vote: see above
inline constexpr int kNearby = 32;  ///< nearest samples among which the voters are searched

}  // namespace umtet
