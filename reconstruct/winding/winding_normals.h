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

/// What the winding number said of a cloud's normals.
struct WindingReport {
  double off_before = 0, off_after = 0;  ///< off_a_half of a part of the samples
  /// The samples are all round a body, and the normals point out of it.
  bool is_closed() const;
  bool restored = false;       ///< the others were off at fewer samples than the cloud's, which they replaced
  bool taken = false;          ///< winding_normals did better, and decided
  std::size_t n_turned = 0;    ///< normals on whose side it decided otherwise
  std::size_t n_replaced = 0;  ///< normals whose direction it gave, too
};

struct OrientByWinding {
  bool directions_may_change = false;  ///< or signs alone
  const std::vector<Vec3>* others =
      nullptr;               ///< that the cloud had before: taken back if they are off at fewer samples
  bool only_others = false;  ///< winding_normals is not tried
};

/// Checks normals by the winding number of at most 4000 samples. Where it is off a half at more than one sample in 50,
/// softened by noise, too, winding_normals is tried, and decides over all normals if it is off at a quarter fewer:
/// signs everywhere; directions, if these may change, on a cloud that is sparse, and where they contradict it by more
/// than 45 degrees. Zero normals stay. A cloud that passes the check is left alone, for a few hundredths of a second.
/// @param cloud  sorted in space (morton_order.h): every m-th of its points are spread evenly
/// \throw std::invalid_argument  as FastWindingNumber; fewer than two distinct places; not as many others as points
WindingReport orient_by_winding(OrientedPointCloud& cloud, const OrientByWinding& how);

}  // namespace umtet
