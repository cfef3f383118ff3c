#pragma once

#include <vector>

#include "mesh/core/tet_mesh.h"

namespace umtet {

// Partitions of the boundary faces F of a mesh with vertices V. Faces are treated as flat, and are counter-clockwise
// from outside.

/// Area (model units^2) and outward unit normal of every face; the normal of a face without area is zero.
struct FaceGeometry {
  std::vector<Vec3> centroid, normal;
  std::vector<double> area;
};
FaceGeometry face_geometry(const std::vector<Vec3>& V, const std::vector<Triangle>& F);

/// Smooth parts of the boundary, as a number per face, from 0, largest area first. Two faces are in one part if they
/// are connected by a path over edges at which the normals of both faces differ by at most `angle` degrees. 180: any
/// edge.
std::vector<int> smooth_pieces(const std::vector<Vec3>& V, const std::vector<Triangle>& F, double angle);

/// Absorbs small islands of labels. The connected component of faces with equal labels and least area, if this is below
/// `least` (model units^2), takes the label with which it has the longest border, until there is none left. Of equal
/// areas the component with the first face is taken, of equal borders the least label; a component without neighbours
/// stays.
/// \throw std::invalid_argument if there is not one label per face
void absorb_islands(const std::vector<Vec3>& V, const std::vector<Triangle>& F, double least, std::vector<int>& labels);

}  // namespace umtet
