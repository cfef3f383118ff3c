#pragma once

#include <array>
#include <vector>

#include "common/context.h"
#include "common/vec3.h"
#include "mesh/background/background_mesh.h"
#include "mesh/regions/region_domain.h"
#include "mesh/regions/region_mesh.h"

namespace umtet {

/// A vertex on one side of a periodic mesh, and its copy on another side: to the bit
/// V[copy] = V[vertex] + periods * sides, component by component.
struct PeriodicPair {
  int vertex = 0, copy = 0;
  std::array<int, 3> periods{};  ///< -1, 0 or 1 along each axis, not all 0
};

/// A mesh of one period. Its copies, shifted by whole sides, fill space without gaps or overlaps.
struct PeriodicMesh {
  RegionMesh mesh;
  Vec3 sides = Vec3::Zero();  ///< sides of the period, model units
  std::vector<PeriodicPair>
      pairs;  ///< by vertex and copy; every vertex with several copies is the `vertex` of all others
};

/// Largest relative difference between a function at a point and one period away that counts as rounding.
inline constexpr double kPeriodicTolerance = 1e-9;

/// Makes the mesh of all regions of a domain that repeats in a box.
///
/// The background is A15 on the torus of the box: whole cells, stretched along each axis by a few per cent so that they
/// fill it. Labels are chosen on the torus. For projection, smoothing and flips, the torus is cut open along three
/// planes, vertices on the cut stay, and the rest is treated as in make_region_mesh(); this is repeated with the cut a
/// quarter of a period farther, four times, so that each point is away from the planes of one cut. The mesh that
/// is returned is cut open near the sides of the box; the cut follows faces of tets, and no vertex is projected on a
/// side.
///
/// @param box    one period, model units
/// @param h      mean edge length, model units; the number of cells is rounded
/// \throw std::invalid_argument  a function does not repeat within kPeriodicTolerance, h leaves fewer than four cells
///   along an axis, or as make_region_mesh()
/// \throw Cancelled
PeriodicMesh make_periodic_region_mesh(const RegionDomain& domain, const Box& box, double h,
                                       const RegionMeshParams& params = {}, const Context& context = {});

}  // namespace umtet
