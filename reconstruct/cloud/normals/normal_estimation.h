#pragma once

#include <string>
#include <vector>

#include "reconstruct/cloud/cleaning/covering.h"
#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// Parameters of estimate_normals().
struct NormalEstimationParams {
  int neighbours = 24;     ///< size of the first neighbourhood; >= 8. Four times the coefficients of a quadric
  double noise_angle = 2;  ///< permitted effect of noise on a normal, degrees, before the neighbourhood grows; > 0
  /// Maximum growth of its radius; >= 1. Nine times the radius of 24 neighbours contains 2000.
  double largest_growth = 9;
};
std::vector<std::string> problems(const NormalEstimationParams&);

/// Result of estimate_normals().
struct EstimatedNormals {
  std::vector<Vec3> normals;    ///< unit, signs arbitrary; zero if all neighbours are at one position
  std::size_t n_undefined = 0;  ///< zero normals
  std::size_t n_widened = 0;    ///< points whose noise required a larger radius
};

/// Normal estimation: directions of the normals from quadrics through neighbourhoods that grow with the noise.
///
/// n neighbours within r and noise sigma leave an angle of 2 sigma / (r sqrt(n)). The radius grows by sqrt(3) until
/// this is below params.noise_angle; it is below at once if sigma < spacing / 4. Wide neighbourhoods are searched among
/// every 3rd, 9th, ... point, so that the cost of a step is constant.
///
/// All computations are in double: PCL's points are float, so its estimation would fail for scans at 1e7 from the
/// origin and lose the last digits of all others. On scan lines the neighbours of a point are the representatives
/// around it (covering.h), because the points on its own line define no plane.
///
/// @param covering  covering of the points; null if they are sampled evenly
/// \throw std::invalid_argument for fewer than 3 points, a coordinate that is not finite, or a problem of the
///        parameters
/// Cost: O(n log n), and several times as much if noise is as large as spacings. The result does not depend on the
/// number of threads.
EstimatedNormals estimate_normals(const std::vector<Vec3>& points, const NormalEstimationParams& params = {},
                                  const Covering* covering = nullptr);

}  // namespace umtet
