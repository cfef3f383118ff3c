#pragma once

#include <Eigen/Geometry>
#include <array>
#include <vector>

#include "common/context.h"
#include "mesh/core/implicit_function.h"

namespace umtet {

/// Triangles near {psi = 0}, for pictures.
struct ZeroSurface {
  std::vector<Vec3> V;
  std::vector<std::array<int, 3>> F;  ///< counter-clockwise seen from outside, where psi > 0
};

/// Triangles of the zero set of the linear interpolant of psi on a grid of cubes that are cut into six tets each
/// (Kuhn). Two steps of Newton's method along grad psi then move the vertices, by at most `spacing` in total.
///
/// The surface is followed from cube to cube. It starts at the cubes that contain a point of `near`, and where psi
/// changes sign along an edge of a grid with four times the spacing. A component of psi = 0 with neither is missed; one
/// that reaches the wall of the box is open there. zero_set_topology() counts components without this restriction.
///
/// Cost: about ten values of psi per cut cube, and one per node of the coarse grid; threads over values. The result
/// does not depend on the number of threads.
/// @param spacing  edge of the cubes; reduced per axis so that a multiple of four fills the box
/// \throw std::invalid_argument for an empty or unbounded box, or spacing <= 0
/// \throw std::length_error for more than 2^20 cubes along an axis
/// \throw Cancelled
ZeroSurface zero_surface(ImplicitFunctionRef psi, const Eigen::AlignedBox3d& box, double spacing,
                         const std::vector<Vec3>& near = {}, const Context& context = {});

}  // namespace umtet
