#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "common/vec3.h"

namespace umtet {

/// What was measured at every sample besides its place: a temperature, an intensity.
struct SampleField {
  std::string name;
  std::vector<double> values;  ///< one a sample, in the unit of the file; NaN, infinite or beyond 1e300: not measured
};

using Colour = std::array<std::uint8_t, 3>;  ///< red, green, blue

/// P = {(x_i, n_i)}: a sampled surface                                          [Rangarajan2018, Section 3.7]
/// Arrays of equal length, but that all behind the normals may be missing; x_i in model units, n_i unit and pointing
/// out of the body.
struct OrientedPointCloud {
  std::vector<Vec3> points;              ///< x_i
  std::vector<Vec3> normals;             ///< n_i
  std::vector<int> labels = {};          ///< which part of the surface a sample is on; or empty
  std::vector<Vec3> origins = {};        ///< where the scanner stood that saw a sample; or empty
  std::vector<Colour> colours = {};      ///< or empty
  std::vector<SampleField> fields = {};  ///< of different names
  std::vector<int> counts = {};          ///< how many samples each of these was merged of (merged_samples.h); or empty
  std::vector<double> spreads = {};      ///< their standard deviation along n_i, model units; or empty
};

}  // namespace umtet
