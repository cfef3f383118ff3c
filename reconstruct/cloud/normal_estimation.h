#pragma once

#include <string>
#include <vector>

#include "reconstruct/cloud/covering.h"
#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

struct NormalEstimationParams {
  int neighbours = 24;        ///< of the first neighbourhood; >= 8. Four times the coefficients of a quadric
  double noise_angle = 2;     ///< degrees that noise may leave on a normal before the neighbourhood grows; > 0
  double largest_growth = 9;  ///< of its radius; >= 1. Nine times of 24 neighbours are what 2000 would fill
};
std::vector<std::string> problems(const NormalEstimationParams&);

struct EstimatedNormals {
  std::vector<Vec3> normals;    ///< unit, signs without meaning; zero where all neighbours lie at one place
  std::size_t n_undefined = 0;  ///< zero normals
  std::size_t n_widened = 0;    ///< points whose noise made a larger radius necessary
};

/// Directions of the normals, from quadrics through neighbourhoods that grow with the noise met in them.
///
/// n neighbours within r and noise sigma leave an angle of 2 sigma / (r sqrt(n)). The radius grows by sqrt(3) until
/// that is below params.noise_angle: at once where sigma < spacing / 4. Wide neighbourhoods are looked up among every
/// 3rd, 9th, ... point, so that the cost of a step stays the same.
///
/// Double throughout: PCL's points are float, so its estimation would lose scans of 1e7 from the origin and the last
/// digits of all others.
/// On scan lines the neighbours of a point are the representatives around it (covering.h): those on its own line have
/// no plane.
///
/// @param covering  of the points; null: they are sampled evenly
/// \throw std::invalid_argument  fewer than 3 points, a coordinate not finite, a problem of the parameters
/// Cost: O(n log n), and several times as much with noise of spacings. The result does not depend on the number of
/// threads.
EstimatedNormals estimate_normals(const std::vector<Vec3>& points, const NormalEstimationParams& params = {},
                                  const Covering* covering = nullptr);

}  // namespace umtet
