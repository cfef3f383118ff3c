#pragma once

#include <cstdint>

#include "mesh/core/tet_mesh.h"

namespace umtet {

/// Rule for the direction of relaxation, rdirfunc of Algorithm 2.
enum class DirectionRule {
  AxesInTurn,  ///< e_x, e_y, e_z in successive iterations                         [Rangarajan2018, Section 3.2]
  Random,      ///< a unit vector per vertex and iteration                         [Rangarajan2018, Section 3.8(d)]
};

/// A random unit vector, uniform on the sphere, determined by the arguments alone: threads and loop order do not change
/// it. It is computed with integer arithmetic, products and one square root, so the bits are the same on every machine
/// with IEEE doubles.
Vec3 random_unit_vector(std::uint64_t seed, std::uint64_t iteration, std::int64_t vertex);

/// Direction d_i in relaxation iteration r = 0, 1, ... of the vertex with this background id.
Vec3 relaxation_direction(DirectionRule rule, std::uint64_t seed, int iteration, std::int64_t vertex);

}  // namespace umtet
