#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "body/body.h"
#include "body/fidelity/closed_hole.h"
#include "mesh/io/solver_mesh.h"
#include "mesh/io/tet_mesh_io.h"
#include "pipeline/case/label_names.h"
#include "pipeline/case/parameters.h"
#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// Receives a message for the user about patches that differ from the request.
using Warn = std::function<void(const std::string&)>;

/// Boundary faces that form separate patches, independent of the others: 1 for such faces, 0 for others. Empty: none.
struct MarkedFaces {
  std::vector<char> at_wall;   ///< flags of faces at the walls of a box
  std::vector<char> in_holes;  ///< flags of faces in closed_holes
  /// Patch of Domain::piecewise of each face, from 0; -1: none. Empty for a smooth body.
  std::vector<int> of_body = {};
  std::vector<int> labels = {};  ///< PiecewiseBody::labels of these patches
};

/// Returns the marked faces of a mesh from its file, which contains `wall` and `support` if they are known.
/// @param support  support of the certificate of the mesh
MarkedFaces marked_faces(const SolverMesh& mesh, const MeshFile& file, const std::optional<SupportReport>& support);

/// Sets MarkedFaces::of_body and labels for a mesh of a body with sharp edges; else it does nothing.
/// @param V  vertices of the faces, working coordinates
/// @param h  edge length of the mesh
void mark_patches(const Domain& domain, const SolverMesh& mesh, const std::vector<Vec3>& V, double h,
                  MarkedFaces& marked);

/// Moves the faces of holes to the patch "closed_holes", as take_holes() of body does. Nothing changes without holes.
void take_holes(SolverMesh& mesh, const std::vector<char>& in_holes, const Warn& warn);

/// Divides the boundary faces into patches by divide_boundary() of body: by the labels of the cloud; otherwise by
/// output.patch_planar or else output.patch_angle if set; otherwise into the patches of a body with sharp edges, with
/// the edges between them as curves; otherwise into connected components. `warn` reports labels without faces, and a
/// boundary without flat parts. Then calls take_holes().
/// \throw UsageError  the exceptions of parse_label_names(), a name for a label that the cloud does not have, or a name
///   that is reserved for walls or holes
/// @param names_of_file  names of labels 1, 2 ... without a name in output.label_names
void divide_boundary(SolverMesh& mesh, const MarkedFaces& marked, const OrientedPointCloud& cloud,
                     const Parameters& parameters, const Warn& warn,
                     const std::vector<std::string>& names_of_file = {});

}  // namespace umtet
