#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "reconstruct/cloud/cleaning/covering.h"
#include "reconstruct/cloud/neighbours/neighbourhoods.h"
#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// Result of checking a cloud's normals by the winding number, with its certainty.
struct WindingReport {
  enum class Verdict {
    Agrees,     ///< the winding number agrees with the normals; nothing was tried
    Uncertain,  ///< its own normals are off at as many places, or less consistent, and the cloud's normals bound a
                ///< body; these stay
    NotBetter,  ///< the cloud's normals explain held-out samples better; they stay
    Taken,      ///< its own normals decided
  };
  Verdict verdict = Verdict::Agrees;
  bool restored = false;  ///< `others` were off at fewer samples than the cloud's normals, and replaced them first
  double off_before = 0, off_after = 0;  ///< patches_off_a_half() of some samples, before and with the final normals
  /// patches_off_a_half() with the best normals that it proposed, if there were any.
  double off_tried = 0;
  double consistency_before = 0, consistency_tried = 0;  ///< consistency() of the cloud's normals and of the best of
                                                         ///< its own; 0 if none were tried
  std::size_t n_turned = 0;                              ///< normals whose side it changed
  std::size_t n_replaced = 0;                            ///< normals whose direction it changed, too

  /// True if the samples are all around a body, and the normals point out of it.
  bool is_closed() const;
};

/// Samples for a fit, and held-out samples that judge it.
struct SplitCloud {
  OrientedPointCloud known, held_out;
};

/// Options of orient_by_winding().
struct OrientByWinding {
  bool directions_may_change = false;  ///< true: directions; false: signs alone
  const std::vector<Vec3>* others =
      nullptr;                           ///< former normals of the cloud: restored if they are off at fewer samples
  bool only_others = false;              ///< winding_normals() is not tried
  const Neighbourhoods* near = nullptr;  ///< neighbourhoods with OrientationParams::neighbours; null: searched
  const Covering* covering = nullptr;    ///< covering of the cloud; null: it is sampled evenly
  /// Returns whether the second split explains the held-out samples better than the first. Both splits contain the same
  /// samples; the first has the cloud's normals, the second those from the winding number of the known samples. If
  /// the winding number is not certain, the first must also bound no body, and the second must bound one. Null: nothing
  /// is compared, and only certain normals are accepted.
  std::function<bool(const SplitCloud& former, const SplitCloud& proposed, bool is_certain)> explains_better = nullptr;
};

/// Checks normals by the winding number of at most 4000 samples, and replaces them if the result is certain.
///
/// 1. The normals stay if w is off a half at no more than one sample in 50, or at one patch in 50, at any noise. Normals
///    whose directions may change stay only if fewer than one in 250 samples or patches are off: one thin part can have
///    wrong sides. The next step then requires a quarter of the patches instead of three quarters.
/// 2. Otherwise winding_normals() are tried. Noise can mislead them: they turn samples off the surface so that w is 1/2
///    there, too. They are certain if
///      - they are off at a quarter fewer patches, and
///      - they are no less consistent with one another than the cloud's normals (consistency()). This condition is
///        replaced if the cloud's normals are off at more than half of the patches, so that they bound nothing: then
///        these must be off at less than one in 25 patches, with a consistency of .95 or more.
/// 3. They are accepted if they explain samples better that neither they nor the fit used: how.explains_better. Normals
///    that are off at a quarter fewer patches but are not certain are accepted only if the cloud's bound no body.
///
/// They then determine the signs of all normals. They determine directions, if these may change, on a sparse cloud
/// (4000 samples or fewer), and where both differ by more than 45 degrees. Zero normals stay. A cloud that passes the
/// check is unchanged; the check takes a few hundredths of a second.
/// @param cloud  sorted in space (morton_order.h), so that every m-th of its points are spread evenly
/// \throw std::invalid_argument as FastWindingNumber, for fewer than two distinct positions, or if `others` and points
///        differ in number
/// The result does not depend on the number of threads.
WindingReport orient_by_winding(OrientedPointCloud& cloud, const OrientByWinding& how);

}  // namespace umtet
