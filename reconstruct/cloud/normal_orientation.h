#pragma once

#include <string>
#include <vector>

#include "reconstruct/cloud/covering.h"
#include "reconstruct/cloud/neighbourhoods.h"
#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

struct OrientationParams {
  int neighbours = 12;  ///< of every point, over which signs are carried; in 4..64
  /// Repair turns a region when this share of the evidence along its border is against it; in [0.5, 1). A wrong
  /// region of a clean cloud has 1. Noise lowers that, and makes right regions look wrong with a little more than 0.5:
  /// lower values turn these too, higher ones leave wrong regions as they are.
  double disagreement = 0.75;
};
std::vector<std::string> problems(const OrientationParams&);

/// What was found, and what had to be guessed.
struct OrientationReport {
  double consistency = 1;  ///< of the signs as they came, in [0, 1]; see consistency()
  double consistency_after = 1;
  std::size_t n_turned = 0;      ///< normals that were turned over; after estimation that says nothing
  std::size_t n_undefined = 0;   ///< zero normals: left alone
  std::size_t n_components = 0;  ///< that got their outward side each on its own, of at least 100 points
  std::size_t n_cavities = 0;    ///< components inside of another: their normals point into the hole
  std::size_t n_doubtful = 0;  ///< points whose outward side is a guess: of pieces that are open, flat, or half inside
  bool left_alone = false;     ///< repair: nothing to turn, the same bits
};

/// The functions below search the params.neighbours nearest of every point themselves where `near` is not given. Where
/// the cloud lies on scan lines (covering.h) signs are found for the representatives, and each point takes that of its
/// own and those around it; repair turns it only where it is surely against them. Counts but n_turned are then those of
/// the representatives, scaled.

/// Share of the evidence of neighbouring pairs (sign_graph.h) that agrees with the signs of the normals: 1 consistent,
/// 0.5 random. Where a share p of the normals is turned, at random, it is about 1 - 2 p (1 - p): 0.82 for a tenth.
/// \throw std::invalid_argument  as orient_normals
double consistency(const OrientedPointCloud& cloud, const OrientationParams& params = {},
                   const Neighbourhoods* near = nullptr, const Covering* covering = nullptr);

/// Gives all normals signs from nothing: neighbours agree, and every component encloses a positive volume, or a
/// negative one where it lies inside of another. Directions stay.
///
/// \throw std::invalid_argument  not as many normals as points, a coordinate or normal not finite, a problem of params,
///        or `near` of another cloud or another number of neighbours
/// Cost: O(n log n). The result does not depend on the number of threads.
OrientationReport orient_normals(OrientedPointCloud& cloud, const OrientationParams& params = {},
                                 const Neighbourhoods* near = nullptr, const Covering* covering = nullptr);

/// Turns over what disagrees with the rest: signs are found as by orient_normals from the given directions, which are
/// those of a minority turned over. A cloud that is consistent, and whose bodies enclose positive volumes, is left
/// alone bit for bit (at a fraction of the cost, when no point is contested); so is a body that
/// faces outward and touches another. Where volumes do not tell, the majority of the given signs does. \throw
/// std::invalid_argument  as orient_normals
OrientationReport repair_normals(OrientedPointCloud& cloud, const OrientationParams& params = {},
                                 const Neighbourhoods* near = nullptr, const Covering* covering = nullptr);

/// Turns all normals over.
void flip(OrientedPointCloud& cloud);

}  // namespace umtet
