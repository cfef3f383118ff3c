#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/core/implicit_function.h"
#include "mesh/submesh/active_layer.h"

namespace umtet {

/// Cosine of the angle between the normal of a boundary face (counter-clockwise seen from outside) and grad psi.
///
/// The gradient is taken where a few steps along grad psi lead from the face's centroid. If the angle there is not
/// small, it is taken at the closest point of the centroid instead. The result is -1 for a face without area.
/// @param h  background edge length; a point within a thousandth of it counts as on the surface
/// @param evaluations  receives the number of evaluations of psi
double normal_cosine(ImplicitFunctionRef psi, const Vec3& a, const Vec3& b, const Vec3& c, double h,
                     std::size_t& evaluations);

/// A face with a smaller normal_cosine() is misaligned: its normal is more than 60 degrees from grad psi, and repair
/// works on it. Below 0 the face is folded over, and the certificate fails.
inline constexpr double kMisalignedCosine = .5;

/// Finds the boundary face of a tet of omega_h, counter-clockwise seen from outside: the face of its three outside
/// vertices.
/// @param inside  per vertex
/// @return false if the tet has no such face
bool positive_face(const Tet& tet, const std::vector<std::uint8_t>& inside, Triangle& face);

/// Quality defects of a part of a mesh.
struct PatchState {
  double target = 0;                            ///< mean ratio; tets with a lower one count as below target
  double least = 1;                             ///< least mean ratio
  std::size_t below_target = 0;                 ///< number of tets
  double least_cosine = 1;                      ///< least normal_cosine() of the boundary faces
  std::size_t misaligned = 0, folded_over = 0;  ///< numbers of faces; folded over faces are misaligned, too

  bool is_perfect() const { return below_target == 0 && misaligned == 0; }
  /// True if none of the five measures is worse. A value above the target, or above kMisalignedCosine, is good enough.
  /// If fewer faces are misaligned and no more are folded over, the least cosine may be worse: on the way from several
  /// misaligned faces to none the last one often gets worse before it gets better.
  bool is_no_worse_than(const PatchState& other) const;
  /// True if there are fewer folded over faces; or as many of these, and fewer misaligned faces and tets below target
  /// together; or as many of both, and better least values.
  bool is_better_than(const PatchState& other) const;
};

/// State of all tets of the layer; faces are not examined.
PatchState tet_state(const ActiveLayer& layer, double target);

/// State of all tets of the layer and of all their boundary faces.
PatchState patch_state(const ActiveLayer& layer, const std::vector<std::uint8_t>& inside, ImplicitFunctionRef psi,
                       double target, std::size_t& evaluations);

}  // namespace umtet
