#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "reconstruct/patches/patch_fit.h"

namespace umtet {

/// A corner has at most this many patches.
inline constexpr std::size_t kMostPatchesAtCorner = 8;

/// The surfaces f_p = 0 of the patches of a cloud, the curves where two of them meet, and their common points.
class PatchZeroSets {
 public:
  /// @param fits     the functions of the patches; they must outlive this object
  /// @param spacing  of the samples
  PatchZeroSets(const std::vector<PatchFit>& fits, double spacing) : fits_(fits), s_(spacing) {}

  /// Returns f_p / |grad f_p|, and the unit gradient.
  double distance(int p, const Vec3& x, Vec3& normal) const;

  /// Moves x to f_p = 0 for all patches by Gauss and Newton's method, with the shortest steps.
  /// @param patches   at most 2 kMostPatchesAtCorner
  /// @param farthest  largest distance from the start
  /// @param off       receives the largest |f_p| / |grad f_p|, if it is not null
  /// @return whether the method converges, and the normals are not nearly in a plane (of two patches: on a line)
  bool correct(std::span<const int> patches, Vec3& x, double farthest, double* off = nullptr) const;

  /// Returns the dihedral angle of the body where two patches meet, in (0, 360) degrees.
  double angle_deg(const std::array<int, 2>& pair, const Vec3& x, bool is_convex) const;

  /// Returns the unit tangent of the curve where two patches meet; none if they are nearly parallel.
  std::optional<Vec3> tangent(const std::array<int, 2>& pair, const Vec3& x) const;

 private:
  const std::vector<PatchFit>& fits_;
  double s_;
};

}  // namespace umtet
