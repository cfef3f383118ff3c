#pragma once

#include "mesh/background/background_mesh.h"
#include "mesh/core/tet_mesh.h"

namespace umtet {

/// A15 mesh of a box with flat walls, clipped along mirror planes of A15.
///
/// Planes between cells are mirror planes of A15: a tet across such a plane has an edge that crosses it at a right
/// angle with its midpoint in the plane. The tet is halved there by moving the outer end of this edge to the plane.
/// Halved tets have dihedral angles of exactly 90 degrees and Q >= .706 in cubic cells. All other tets, beyond a
/// quarter of a cell from the walls, are acute. The cells have edge length h, stretched along each axis so that whole
/// cells fill the box.
/// @param h  mean edge length of whole cells, model units
/// @return vertices in (z, y, x) order
/// \throw std::invalid_argument for h <= 0, an empty box, or more than 2^31 - 1 tets
TetMesh a15_box(const Box& box, double h);

}  // namespace umtet
