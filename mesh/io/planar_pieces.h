#pragma once

#include <vector>

#include "mesh/io/solver_mesh.h"

namespace umtet {

/// The flat parts of a boundary: for every face the number of its plane, from 0, largest area first; -1: of none.
///
/// From the flattest face on, faces join over edges while their normal is within `angle` of the plane's, which is the
/// mean of its faces; they are collected anew until it stays. A plane is kept when
/// - the faces at those of its vertices that have all their faces in it have the area `least`: a row of faces is flat,
///   too, on anything round, and
/// - the root mean square of the angles between its faces and it is below angle / 3: what bends evenly fills the
///   tolerance, with angle / sqrt(3) on a cylinder, angle / sqrt(2) on a sphere.
/// So a plane ends at an edge however round it is, where smooth_pieces() goes on round it.
/// Afterwards parts of no plane below `least` that lie in one go to it, as in absorb_islands().
///
/// @param angle  degrees, in (0, 90)
/// @param least  model units^2
/// \throw std::invalid_argument  an angle out of range
/// Cost: a few microseconds a face.
std::vector<int> planar_pieces(const SolverMesh& mesh, double angle, double least);

}  // namespace umtet
