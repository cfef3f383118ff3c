#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/core/implicit_function.h"
#include "mesh/submesh/active_layer.h"

namespace umtet {

/// cos of the angle between a boundary face (counter-clockwise seen from outside) and psi = 0: its normal with grad psi
/// at the closest point of its centroid, or, where that says they agree, where a few steps along grad psi lead from it.
/// -1 for a face without area.
/// @param h  background edge length: a thousandth of it is near enough to the surface
/// @param evaluations  receives the number of values of psi
double normal_cosine(ImplicitFunctionRef psi, const Vec3& a, const Vec3& b, const Vec3& c, double h,
                     std::size_t& evaluations);

/// A face with a smaller normal_cosine() is misaligned: more than 60 degrees from psi = 0, and repair works on it.
/// Below 0 it is folded over: the certificate fails.
inline constexpr double kMisalignedCosine = .5;

/// The boundary face of a tet of omega_h, counter-clockwise seen from outside: that of its three outside vertices.
/// @param inside  per vertex
/// @return false if it has none
bool positive_face(const Tet& tet, const std::vector<std::uint8_t>& inside, Triangle& face);

/// What is wrong with a part of a mesh.
struct PatchState {
  double target = 0;                            ///< mean ratio below which a tet is below target
  double least = 1;                             ///< mean ratio
  std::size_t below_target = 0;                 ///< tets
  double least_cosine = 1;                      ///< of boundary faces
  std::size_t misaligned = 0, folded_over = 0;  ///< faces; folded over ones are misaligned, too

  bool is_perfect() const { return below_target == 0 && misaligned == 0; }
  /// None of the five is worse; what is above the target, or above kMisalignedCosine, is good enough. Where fewer faces
  /// are misaligned, and no more folded over, the worst of them may be misaligned more: on the way from several
  /// misaligned faces to none the last one often gets worse before it gets better.
  bool is_no_worse_than(const PatchState& other) const;
  /// Fewer folded over faces, or as many and fewer misaligned faces and below target tets, or as many of all and better
  /// worst ones.
  bool is_better_than(const PatchState& other) const;
};

/// Of all tets of the layer; faces are not looked at.
PatchState tet_state(const ActiveLayer& layer, double target);

/// Of all tets of the layer and all their boundary faces.
PatchState patch_state(const ActiveLayer& layer, const std::vector<std::uint8_t>& inside, ImplicitFunctionRef psi,
                       double target, std::size_t& evaluations);

}  // namespace umtet
