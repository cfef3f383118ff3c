#pragma once

#include <vector>

#include "mesh/core/tet_mesh.h"

namespace umtet {

/// Planar parts of a boundary with vertices V and faces F: for every face the number of its plane, from 0, largest area
/// first; -1 for faces in no plane.
///
/// Region growing begins at the flattest face. Faces join over edges while their normal is within `angle` of the
/// plane's normal, which is the mean over its faces; the faces are collected again until the set does not change. A
/// plane is kept if
/// - the faces at its inner vertices (with all their faces in the plane) have at least the area `least`: a single row
/// of
///   faces is flat on any round surface, too; and
/// - the root mean square of the angles between its faces and the plane is below angle / 3. An evenly curved surface
///   fills the tolerance, with angle / sqrt(3) on a cylinder and angle / sqrt(2) on a sphere.
///
/// A plane therefore ends at an edge, however rounded, where smooth_pieces() would continue around it. Afterwards,
/// parts without a plane that are smaller than `least` and lie in one plane are added to it, as in absorb_islands().
///
/// @param angle  degrees, in (0, 90)
/// @param least  model units^2
/// \throw std::invalid_argument for an angle out of range
/// Cost: a few microseconds per face.
std::vector<int> planar_pieces(const std::vector<Vec3>& V, const std::vector<Triangle>& F, double angle, double least);

}  // namespace umtet
