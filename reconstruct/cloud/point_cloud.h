#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "common/vec3.h"

namespace umtet {

/// A quantity measured at every sample besides its position, such as a temperature or an intensity.
struct SampleField {
  std::string name;
  std::vector<double> values;  ///< one per sample, in the unit of the file; NaN, infinite or beyond 1e300: not measured
};

using Colour = std::array<std::uint8_t, 3>;  ///< red, green, blue

/// Oriented point cloud P = {(x_i, n_i)}: a sampled surface                     [Rangarajan2018, Section 3.7]
///
/// Arrays have equal length, but all after the normals may be missing. x_i are in model units, n_i are unit and point
/// out of the body.
struct OrientedPointCloud {
  std::vector<Vec3> points;              ///< x_i
  std::vector<Vec3> normals;             ///< n_i
  std::vector<int> labels = {};          ///< part of the surface that a sample is on; optional
  std::vector<Vec3> origins = {};        ///< position of the scanner that saw a sample; optional
  std::vector<Colour> colours = {};      ///< optional
  std::vector<SampleField> fields = {};  ///< with different names
  std::vector<int> counts = {};          ///< number of samples merged into each of these (merged_samples.h); optional
  std::vector<double> spreads = {};      ///< standard deviation of the merged samples along n_i, model units; optional
};

}  // namespace umtet
