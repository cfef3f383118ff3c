#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "reconstruct/cloud/covering.h"
#include "reconstruct/cloud/neighbourhoods.h"
#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// What the winding number said of a cloud's normals, and how sure it is.
struct WindingReport {
  enum class Verdict {
    Agrees,     ///< with the normals as they are: nothing was tried
    Uncertain,  ///< its own normals are off as much, or less consistent and those of the cloud bound a body: these stay
    NotBetter,  ///< held-out samples are explained better by the cloud's, which stay
    Taken,      ///< its own normals decided
  };
  Verdict verdict = Verdict::Agrees;
  bool restored = false;  ///< the others were off at fewer samples than the cloud's, which they replaced before
  double off_before = 0, off_after = 0;  ///< patches_off_a_half of a part of the samples; off_after: of the normals
                                         ///< that the cloud is left with
  double off_tried = 0;                  ///< of the best of its own normals, if there were any
  double consistency_before = 0, consistency_tried = 0;  ///< consistency() of the cloud's normals and of the best of
                                                         ///< its own; 0 where none were tried
  std::size_t n_turned = 0;                              ///< normals on whose side it decided otherwise
  std::size_t n_replaced = 0;                            ///< normals whose direction it gave, too

  /// The samples are all round a body, and the normals point out of it.
  bool is_closed() const;
};

/// Samples that are fitted, and others that tell how well.
struct SplitCloud {
  OrientedPointCloud known, held_out;
};

struct OrientByWinding {
  bool directions_may_change = false;  ///< or signs alone
  const std::vector<Vec3>* others =
      nullptr;                           ///< that the cloud had before: taken back if they are off at fewer samples
  bool only_others = false;              ///< winding_normals is not tried
  const Neighbourhoods* near = nullptr;  ///< of the cloud, over OrientationParams::neighbours; null: searched
  const Covering* covering = nullptr;    ///< of the cloud; null: it is sampled evenly
  /// Whether the second of two splits of the same samples, whose normals the winding number of the known ones gives,
  /// explains the held-out samples better than the first, which has the cloud's. Where the winding number is not
  /// certain, the first must also bound no body, and the second must bound one. Null: nothing is compared, and only
  /// certain normals are taken.
  std::function<bool(const SplitCloud& former, const SplitCloud& proposed, bool is_certain)> explains_better = nullptr;
};

/// Checks normals by the winding number of at most 4000 samples, and overrules them where it is certain.
///
/// 1. Normals stay if it is off a half at no more than one sample in 50, or at one patch in 50, whatever the noise.
/// 2. Else winding_normals are tried. Noise leads them astray: they turn samples that lie off the surface so that w is
///    1/2 there, too. They are certain if
///      - they are off at a quarter fewer patches, and
///      - no less consistent with one another than the cloud's are (consistency()), or the cloud's are off at more than
///        half of the patches, so that they bound nothing, and these at less than one in 25, with a consistency of .95
///        or more.
/// 3. They are taken if they explain samples better that neither they nor the fit knew: how.explains_better. Normals
///    that are off at a quarter fewer patches but are not certain are taken if the cloud's bound no body besides.
///
/// Then they decide over the signs of all normals; over directions, if these may change, on a cloud that is sparse
/// (4000 samples or fewer), and where the two differ by more than 45 degrees.
/// Zero normals stay. A cloud that passes the check is left alone, for a few hundredths of a second.
/// @param cloud  sorted in space (morton_order.h): every m-th of its points are spread evenly
/// \throw std::invalid_argument  as FastWindingNumber; fewer than two distinct places; not as many others as points
/// The result does not depend on the number of threads.
WindingReport orient_by_winding(OrientedPointCloud& cloud, const OrientByWinding& how);

}  // namespace umtet
