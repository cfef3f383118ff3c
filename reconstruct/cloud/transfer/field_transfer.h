#pragma once

#include <vector>

#include "common/context.h"
#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// Values of fields at given positions, interpolated from samples; NaN where there is no value.
struct SurfaceFields {
  std::vector<SampleField> fields;  ///< fields of the cloud, with one value per position
  std::vector<Vec3> colours;        ///< red, green, blue in 0..1, one per position; empty without colours
};

/// Shepard interpolation: colours and fields of the surface at x_k, where its outward normal is n_k, by the weighted
/// mean       [Shepard1968]
///   f(x) = sum_i w_i f_i / sum_i w_i,   w_i = (1 - r_i)^4 (4 r_i + 1),   r_i = |x - x_i| / R < 1     [Wendland1995]
/// over the samples whose normals are on the same side: on a thin sheet, samples of the other side are near, too. R is
/// the distance of the next sample after the kAveraged nearest, and at most `reach`. A sample that enters has weight
/// zero, so f is continuous. A mean is between the values of the samples. It is exact for a constant; if f has the
/// gradient g, its error is less than R |g|, and much less where samples lie on all sides of x. Twelve are about two
/// rings of samples on a surface, so the noise of a sample is reduced to a third.
///
/// A position has no value if every sample on its side is at least `reach` away, or if the closer samples have no
/// value.
///
/// @param normals  normals of any length; if a normal is zero, samples on all sides count
/// @param reach    model units, > 0
/// \throw std::invalid_argument for a cloud without points, or without a normal and a value of every field for each
///        point, or if the numbers of normals and positions differ; Cancelled
/// Cost: O(n log n). The result does not depend on the number of threads.
SurfaceFields fields_at(const OrientedPointCloud& cloud, const std::vector<Vec3>& places,
                        const std::vector<Vec3>& normals, double reach, const Context& context = {});

inline constexpr int kAveraged = 12;  ///< number of samples per mean: two rings

}  // namespace umtet
