#pragma once

#include <vector>

#include "mesh/io/solver_mesh.h"

namespace umtet {

/// Divisions of the boundary faces of a mesh. Faces are flat here, whatever the number of their nodes.

/// Area (model units^2) and outward unit normal of every face; the normal of a face without area is zero.
struct FaceGeometry {
  std::vector<Vec3> centroid, normal;
  std::vector<double> area;
};
FaceGeometry face_geometry(const SolverMesh& mesh);

/// A piece of every face, from 0, largest area first: faces are of one piece when a way leads from one to the other
/// over edges at which the normals of both faces differ by at most `angle` degrees; 180: every edge.
std::vector<int> smooth_pieces(const SolverMesh& mesh, double angle);

/// Islands go: the connected piece of faces with equal labels of the least area, if that is below `least` (model
/// units^2), takes the label with which it has the longest border, until there is none. Of equal areas the piece with
/// the first face, of equal borders the least label; what has no neighbour stays.
/// \throw std::invalid_argument  not one label a face
void absorb_islands(const SolverMesh& mesh, double least, std::vector<int>& labels);

}  // namespace umtet
