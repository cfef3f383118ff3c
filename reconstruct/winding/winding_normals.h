#pragma once

#include <cstddef>
#include <vector>

#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// Parameters of winding_normals().
struct WindingNormalsParams {
  int rounds = 6;          ///< >= 1; more change little
  double widest = 3;       ///< softening of the first round (fast_winding_number.h): sides spread over large parts; > 0
  double narrowest = 1.5;  ///< softening of the last round: thin walls separate; noise requires 2; > 0
};

/// Winding number normal consistency [Lin2024]: computes unit normals from points alone such that the winding number of
/// the samples is 1/2 at all of them. One round is a step of steepest descent, with exact line search, of
///
///     sum_i a_i (w(x_i) - 1/2)^2        over vectors v_i in place of normals, from v = 0               [Lin2022]
///
/// followed by v_i <- -|v_i| grad w(x_i) / |grad w(x_i)|, because the normals of a surface agree with its own field.
/// The method needs neither neighbourhoods nor initial normals, so there may be only a few samples across a part, and
/// two sheets may be one spacing apart.
///
/// @param areas  result of sample_areas(), with a sum > 0
/// \throw std::invalid_argument as FastWindingNumber
/// Cost: O(n log n), .1 ms per sample. The result does not depend on the number of threads.
std::vector<Vec3> winding_normals(const std::vector<Vec3>& points, const std::vector<double>& areas,
                                  const WindingNormalsParams& params = {});

/// Fraction of samples at which the winding number differs from a half by more than a quarter. It is below .02 where
/// all sides are right. It is higher where the sides of a part are wrong, and at thin parts, noise and the borders of
/// open surfaces.
/// @param softening  noise within its radius does not count
double off_a_half(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, const std::vector<double>& areas,
                  double softening = WindingNormalsParams{}.narrowest);

/// Fraction of patches at which the winding number is off a half, for samples with noise. Single samples are off
/// because they are not on the surface. But w - 1/2 is odd across the surface, so its mean over a patch that extends
/// through the noise vanishes if the sides are right.
///
/// For each sample, the mean of w / j is taken over the samples within hypot(3 noise, 1.5 s) whose normals are within
/// 90 degrees of its own; s is the root of the median area. j is the median jump of w across the samples, at least 1:
/// noise of the size of a spacing makes the samples' areas, which are computed from neighbours in space, up to twice as
/// large.
/// @param noise  standard deviation along the normal, model units
/// @return fraction of samples at which this mean differs from 1/2 by more than a quarter. It is below .02 if the
///         samples are all around a body and their normals point out of it, and about 1 for a single sheet, whose mean
///         is 0.
double patches_off_a_half(const std::vector<Vec3>& points, const std::vector<Vec3>& normals,
                          const std::vector<double>& areas, double noise);

/// Outward unit normals at given positions: -grad w / |grad w| for the winding_normals() of some samples, softened as
/// in its last round; zero where the field is zero.
/// @param points, areas  positions and areas of the samples
std::vector<Vec3> normals_by_winding(const std::vector<Vec3>& points, const std::vector<double>& areas,
                                     const std::vector<Vec3>& places, const WindingNormalsParams& params = {});

}  // namespace umtet
