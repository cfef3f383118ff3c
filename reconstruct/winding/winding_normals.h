#pragma once

#include <cstddef>
#include <vector>

#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

struct WindingNormalsParams {
  int rounds = 6;          ///< >= 1; more change little
  double widest = 3;       ///< softening of the first round (fast_winding_number.h): sides spread over large parts; > 0
  double narrowest = 1.5;  ///< of the last: thin walls come apart; noise asks for 2; > 0
};

/// Unit normals for which the winding number of the samples is 1/2 at all of them, from points alone. Winding number
/// normal consistency [Lin2024]: one round is a step of steepest descent, with exact line search, of
///
///     sum_i a_i (w(x_i) - 1/2)^2        over vectors v_i in place of normals, from v = 0               [Lin2022]
///
/// and then v_i <- -|v_i| grad w(x_i) / |grad w(x_i)|, because the normals of a surface are those of its own field. It
/// needs neither neighbourhoods nor a start, so samples may be a few across a part, and two sheets one spacing apart.
///
/// @param areas  of sample_areas, > 0 in sum
/// \throw std::invalid_argument  as FastWindingNumber
/// Cost: O(n log n), .1 ms a sample. The result does not depend on the number of threads.
std::vector<Vec3> winding_normals(const std::vector<Vec3>& points, const std::vector<double>& areas,
                                  const WindingNormalsParams& params = {});

/// Share of samples at which the winding number is no half: off by more than a quarter. Below .02 where all sides are
/// right; above where those of a part are wrong, and at thin parts, noise and the borders of open surfaces.
/// @param softening  noise within its reach does not count
double off_a_half(const std::vector<Vec3>& points, const std::vector<Vec3>& normals, const std::vector<double>& areas,
                  double softening = WindingNormalsParams{}.narrowest);

/// The same of patches, for samples with noise: single ones are off because they do not lie on the surface, but w - 1/2
/// is odd across it, so its mean over a patch that reaches through the noise vanishes where the sides are right.
///
/// For each sample the mean of w / j over the samples within hypot(3 noise, 1.5 s) whose normals are within 90 degrees
/// of its own; s is the root of the median area. j is the median jump of w across the samples, at least 1: noise of a
/// spacing makes areas behind samples, which are those of neighbours in space, up to twice as large.
/// @param noise  standard deviation along the normal, model units
/// @return the share of samples at which that mean is off 1/2 by more than a quarter. Below .02 where the samples are
///         all round a body and their normals point out of it; about 1 of a single sheet, whose mean is 0.
double patches_off_a_half(const std::vector<Vec3>& points, const std::vector<Vec3>& normals,
                          const std::vector<double>& areas, double noise);

/// Outward unit normals at places: -grad w / |grad w| of winding_normals() of some samples, softened as in its last
/// round; zero where the field is. @param points, areas  of the samples
std::vector<Vec3> normals_by_winding(const std::vector<Vec3>& points, const std::vector<double>& areas,
                                     const std::vector<Vec3>& places, const WindingNormalsParams& params = {});

}  // namespace umtet
