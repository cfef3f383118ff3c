#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mesh/io/solver_mesh.h"
#include "mesh/io/tet_mesh_io.h"
#include "pipeline/case/label_names.h"
#include "pipeline/case/parameters.h"
#include "body/fidelity/closed_hole.h"
#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// What the user should know of patches that did not come out as asked for.
using Warn = std::function<void(const std::string&)>;

/// Boundary faces that are patches of their own, whatever the others are: 1 for them, 0 for others. Empty: none.
struct MarkedFaces {
  std::vector<char> at_wall;   ///< at the walls of a box
  std::vector<char> in_holes;  ///< of closed_holes
};

/// Of a mesh and its file, which has `wall` and `support` where they are known.
/// @param support  of the certificate of the mesh
MarkedFaces marked_faces(const SolverMesh& mesh, const MeshFile& file, const std::optional<SupportReport>& support);

/// Makes the faces of holes the patch "closed_holes". It has the number after all that are there, patches and body,
/// which keep theirs. A patch that it leaves without faces is gone, which is said. A patch "boundary" becomes
/// "boundary_1": where there are several, all of them together have that name. Nothing changes without holes.
void take_holes(SolverMesh& mesh, const std::vector<char>& in_holes, const Warn& warn);

/// Puts the boundary faces into patches: by the labels of the cloud where it has any (the votes of the nearest samples,
/// then islands below output.label_min_area go), else by output.patch_planar or else output.patch_angle where set,
/// else by connected pieces. A positive label is the number of its patch, others get the numbers after the largest; a
/// patch without a name is patch_LABEL, region_N, plane_N (and rest) or boundary_N. Labels that no face has are said,
/// and that nothing is flat. Faces at walls are patches of their own: "walls", or by angle or plane walls_1, walls_2
/// ...
/// Then take_holes().
/// \throw UsageError  as parse_label_names(), or a name for a label that the cloud does not have, or that of the walls
/// or holes
/// @param names_of_file  of label 1, 2 ..., where output.label_names has none
void divide_boundary(SolverMesh& mesh, const MarkedFaces& marked, const OrientedPointCloud& cloud,
                     const Parameters& parameters, const Warn& warn,
                     const std::vector<std::string>& names_of_file = {});

}  // namespace umtet
