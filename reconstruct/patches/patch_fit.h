#pragma once

#include <memory>
#include <vector>

#include "common/context.h"
#include "common/vec3.h"
#include "reconstruct/patches/sample_patches.h"

namespace umtet {

/// The samples of one patch, and what is known of the cloud.
struct PatchSamples {
  std::vector<Vec3> points;
  std::vector<Vec3> normals;  ///< unit, outward
  double spacing = 0;         ///< s of the cloud, model units; > 0
  double noise = 0;           ///< rms of positions along the normal, model units
};

/// The function of a smooth patch, fitted to its samples alone. With lengths in units of s it is the least of
///
///     E[f] = sum_i f(x_i)^2 + w_n sum_i |grad f(x_i) - n_i|^2 + lambda int |D^3 f|^2 dV + epsilon int |D^2 f|^2 dV
///
/// The energy of third derivatives has the quadrics as its null space: planes, balls, cylinders and cones go on beyond
/// the border of their samples, where patches meet. The last term decides only what the others leave open.
///
/// f is the simplest function whose residuals are noise: a plane, a quadric, then uniform tricubic B-splines
/// (spline_band.h) with lambda = 1e4, 1e3, ... .1. Residuals r_i = f / |grad f| are noise if their means over twelve
/// neighbours are no larger than the means of independent numbers are: the 90th percentile of |mean| is at most
/// 1.9 sqrt(sigma^2 / 12 + .01^2) with sigma^2 half of the mean square difference between neighbouring residuals.
///
/// Beyond the band of cells f is its Taylor polynomial of degree two at the nearest sample. Immutable; thread-safe.
class PatchFit {
 public:
  enum class Kind { Plane, Quadric, Splines };

  /// \throw std::invalid_argument for no samples, arrays of different length, or a spacing that is not > 0
  explicit PatchFit(const PatchSamples& samples);
  ~PatchFit();
  PatchFit(PatchFit&&) noexcept;
  PatchFit& operator=(PatchFit&&) noexcept;

  /// f at any point; derivatives are written to pointers that are not null. |grad f| is about 1 at the samples.
  double evaluate(const Vec3& x, Vec3* gradient, Mat3* hessian) const;

  Kind kind() const;
  double weight() const;    ///< lambda of the splines; infinite for a plane or quadric
  double misfit() const;    ///< the 90th percentile above, as a share of what is allowed
  double residual() const;  ///< root mean square of r_i, model units

 private:
  struct Parts;
  std::unique_ptr<const Parts> parts_;
};

/// The functions of all patches of a cloud, by number. The result does not depend on the number of threads.
/// @param points  of the cloud; `patches` contains the normals
/// \throw std::invalid_argument as PatchFit, also if a patch has no samples; Cancelled
std::vector<PatchFit> fit_patches(const std::vector<Vec3>& points, const SamplePatches& patches,
                                  const Context& context = {});

}  // namespace umtet
