#pragma once

#include <vector>

#include "common/context.h"
#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// What the samples say of some places; NaN where they say nothing.
struct SurfaceFields {
  std::vector<SampleField> fields;  ///< as the cloud has them, a value a place
  std::vector<Vec3> colours;        ///< red, green, blue in 0..1, one a place; empty without colours
};

/// Colours and fields of the surface at x_k, where its outward normal is n_k: the weighted mean       [Shepard1968]
///   f(x) = sum_i w_i f_i / sum_i w_i,   w_i = (1 - r_i)^4 (4 r_i + 1),   r_i = |x - x_i| / R < 1     [Wendland1995]
/// of the samples whose own normals look to the same side: on a thin sheet those of the other side are near, too. R is
/// the distance of the next sample after the kAveraged nearest, and at most `reach`: a sample that enters has no weight
/// yet, so f is continuous. A mean stays between the values of the samples. It is exact for a constant; where f has the
/// gradient g it errs by less than R |g|, and by much less where samples lie on all sides of x.
/// Twelve: about two rings of samples on a surface, so that the noise of one falls to a third.
///
/// A place has no value where every sample that looks to its side is `reach` away or farther, nor where those that are
/// nearer have none.
///
/// @param normals  of any length; zero: no side, and samples of all sides count
/// @param reach    model units, > 0
/// \throw std::invalid_argument  a cloud without points, or without a normal and a value of every field for each of
/// them, or not as many normals as places; Cancelled
/// Cost: O(n log n). The result does not depend on the number of threads.
SurfaceFields fields_at(const OrientedPointCloud& cloud, const std::vector<Vec3>& places,
                        const std::vector<Vec3>& normals, double reach, const Context& context = {});

inline constexpr int kAveraged = 12;  ///< samples that a mean is taken over: two rings

}  // namespace umtet
