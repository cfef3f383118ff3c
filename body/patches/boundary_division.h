#pragma once

#include <map>
#include <string>
#include <vector>

#include "common/vec3.h"
#include "mesh/core/tet_mesh.h"
#include "mesh/patches/named_part.h"
#include "reconstruct/cloud/point_cloud.h"

namespace umtet {

/// How a boundary is divided: by the labels of the samples if they have any; otherwise by `planar` or else by `angle`
/// if set; otherwise into the patches of a body with sharp edges; otherwise into connected components.
struct PatchOptions {
  double angle = 0;   ///< degrees in [0, 180]: patches end where faces meet at more; 0: where the surface ends
  double planar = 0;  ///< degrees in [0, 90): patches are the parts that are flat within this, and the rest; 0: off
  /// Area, model units^2: smaller islands of a label take the label around them. Negative: the area of as many samples
  /// as outvote a face.
  double label_min_area = -1;
  std::map<int, std::string> names = {};  ///< by label; a label without a name is patch_LABEL
};

/// The patch of each boundary face.
struct BoundaryDivision {
  std::vector<int> face_patch;  ///< index into `patches`
  /// The number of a patch is its label if that is positive. Other labels get the numbers after the largest label, and
  /// patches without labels those from 2 on, because the body has the number 1 then.
  std::vector<MeshPart> patches;
  std::vector<std::string> notices;  ///< differences from the request: labels without faces, and no flat part
  /// The edges between the patches of a body with sharp edges, if it is divided into them.
  std::vector<MeshCurve> curves = {};
};

/// Divides the boundary faces F of a mesh with vertices V. A patch without a name is patch_LABEL, region_N, plane_N
/// (and rest) or boundary_N, or "boundary" if it is the only one. Patch k of a body with sharp edges is patch_k, from
/// 1, and faces without such a patch are rest. Faces at walls are separate patches: "walls", or walls_1, walls_2 ... by
/// angle or plane.
/// @param at_wall  flags of faces at the walls of a box; empty: none
/// @param cloud    samples, in the coordinates of V; their labels count
/// @param of_body  patch of each face in a body with sharp edges, from 0; -1: none. Empty: a smooth body
/// @param labels   label of each of these patches; 0: the samples decide. Empty: they decide on all
/// \throw the exceptions of require_patches()
BoundaryDivision divide_boundary(const std::vector<Vec3>& V, const std::vector<Triangle>& F,
                                 const std::vector<char>& at_wall, const OrientedPointCloud& cloud,
                                 const PatchOptions& options, const std::vector<int>& of_body = {},
                                 const std::vector<int>& labels = {});

/// Checks the options, before there is a mesh.
/// \throw std::invalid_argument  an angle out of range
/// \throw UsageError  a label of the cloud that cannot be a number in files
void require_patches(const OrientedPointCloud& cloud, const PatchOptions& options);

/// Moves the faces of holes to the patch "closed_holes". Its number follows the numbers of all patches and of
/// the body, which do not change: the body has the least number that no patch has. A patch that loses all its faces is
/// removed, and a notice reports it. A patch "boundary" becomes "boundary_1", because "boundary" names all patches
/// together if there are several. Nothing changes without holes.
/// @param in_holes  flags of faces in closed holes; empty: none
void take_holes(const std::vector<char>& in_holes, BoundaryDivision& division);

/// Names of these patches.
inline constexpr const char *kWalls = "walls", *kClosedHoles = "closed_holes";

/// The labels of the samples, ascending, each once.
std::vector<int> distinct_labels(const OrientedPointCloud& cloud);

/// The name of the patch of a label.
std::string patch_name(int label, const std::map<int, std::string>& names);

}  // namespace umtet
