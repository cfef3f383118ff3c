#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "reconstruct/cloud/cleaning/covering.h"
#include "reconstruct/cloud/neighbours/neighbourhoods.h"
#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// Parameters of orient_normals() and repair_normals().
struct OrientationParams {
  int neighbours = 12;  ///< number of neighbours of every point over which signs are propagated; in 4..64
  /// Repair turns a region if this fraction of the evidence along its border is against it; in [0.5, 1). A wrong region
  /// of a clean cloud has 1. Noise lowers it, and makes right regions look wrong with a little more than 0.5: lower
  /// values turn these, too, and higher ones leave wrong regions unchanged.
  double disagreement = 0.75;
};
std::vector<std::string> problems(const OrientationParams&);

/// Report of orientation, with the number of guesses.
struct OrientationReport {
  double consistency = 1;  ///< consistency of the given signs, in [0, 1]; see consistency()
  double consistency_after = 1;
  std::size_t n_turned = 0;      ///< normals that were turned over; meaningless after estimation
  std::size_t n_undefined = 0;   ///< zero normals: unchanged
  std::size_t n_components = 0;  ///< components of at least 100 points, each oriented separately
  std::size_t n_cavities = 0;    ///< components inside another one: their normals point into the hole
  std::size_t n_doubtful = 0;  ///< points whose outward side is a guess: of pieces that are open, flat, or half inside
  std::vector<std::uint8_t> is_doubtful;  ///< whether a point is among them; empty if none is
  bool left_alone = false;                ///< repair: nothing to turn; the bits are unchanged
};

/// Unless `near` is given, the functions below search the params.neighbours nearest neighbours of every point
/// themselves. If the cloud lies on scan lines (covering.h), signs are computed for the representatives, and each point
/// takes the sign of its own representative and those around it; repair turns it only if it clearly disagrees with
/// them. All counts except n_turned are then those of the representatives, scaled.

/// Consistency of normals: fraction of the evidence of neighbouring pairs (sign_graph.h) that agrees with their signs.
/// 1 is consistent, 0.5 random. If a random fraction p of the normals is turned, it is about 1 - 2 p (1 - p): 0.82 for
/// a tenth.
/// \throw std::invalid_argument as orient_normals()
double consistency(const OrientedPointCloud& cloud, const OrientationParams& params = {},
                   const Neighbourhoods* near = nullptr, const Covering* covering = nullptr);

/// Normal orientation: gives all normals signs without using the present ones, such that neighbours agree and every
/// component encloses a positive volume, or a negative one if it is inside another. Directions are unchanged.
///
/// \throw std::invalid_argument if the numbers of normals and points differ, for a coordinate or normal that is not
///        finite, a problem of params, or a `near` of another cloud or with another number of neighbours
/// Cost: O(n log n). The result does not depend on the number of threads.
OrientationReport orient_normals(OrientedPointCloud& cloud, const OrientationParams& params = {},
                                 const Neighbourhoods* near = nullptr, const Covering* covering = nullptr);

/// Repair of normals: turns over those that disagree with the rest. Signs are computed as by orient_normals() from the
/// given directions, and the minority is turned over.
///
/// A cloud that is consistent, and whose bodies enclose positive volumes, is unchanged bit for bit (at a fraction of
/// the cost if no point is contested). So is a body that faces outward and touches another. Where volumes do not
/// decide, the majority of the given signs does.
/// \throw std::invalid_argument as orient_normals()
OrientationReport repair_normals(OrientedPointCloud& cloud, const OrientationParams& params = {},
                                 const Neighbourhoods* near = nullptr, const Covering* covering = nullptr);

/// Turns all normals over.
void flip(OrientedPointCloud& cloud);

}  // namespace umtet
