#pragma once

#include <vector>

#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// The label of the surface at x_k, where its outward normal is n_k: that of most of the kVoters nearest samples whose
/// own normals look to the same side (on a thin sheet the samples of the other side are near, too), or of the nearest
/// samples whatever their normals where none of the kNearby nearest does. Of equally many votes the nearest sample's.
///
/// Five, as measured on 2000 samples of a torus in two halves, away from their border: where 10 % of the labels are
/// random, 1 voter puts 5.5 % of the area on the wrong side, 3 put .95 %, 5 .14 %, 9 none; of a strip two spacings wide
/// 5 voters keep 96 %, as 1 does, and 9 keep 87 %.
///
/// @param normals  of any length; zero: no side
/// \throw std::invalid_argument  a cloud without points, labels or normals, or not as many normals as places
/// Cost: O(n log n). The result does not depend on the number of threads.
std::vector<int> vote_labels(const OrientedPointCloud& cloud, const std::vector<Vec3>& places,
                             const std::vector<Vec3>& normals);

inline constexpr int kVoters = 5, kNearby = 32;

}  // namespace umtet
