#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "mesh/core/quadratic_tet_mesh.h"
#include "mesh/core/tet_mesh.h"
#include "mesh/io/tet_mesh_io.h"
#include "mesh/patches/named_part.h"

namespace umtet {

/// A mesh for solver files: tets with 4 or 10 nodes, and their boundary faces in named patches. Every boundary face is
/// in one patch and every tet in the body. The nodes of a patch are its node set; nodes on a border are in several.
///
/// A mesh of several regions has each tet in one of them instead (set_regions()). Its faces are those of the boundary,
/// then those between regions, which form the last patches.
struct SolverMesh {
  std::vector<Vec3> nodes;    ///< model units
  int nodes_per_tet = 4;      ///< 4 or 10
  std::vector<int> tets;      ///< nodes_per_tet ids each: corners, then the middles of 01 12 20 03 13 23 (VTK's order)
  std::vector<int> face_tet;  ///< the tet behind each boundary face
  std::vector<std::uint8_t> face_opposite;  ///< its corner opposite to that face: the row of kTetFace
  std::vector<int> face_patch;              ///< index into patches
  std::vector<MeshPart> patches;
  MeshPart body{"body", 1};
  std::vector<MeshPart> regions = {};  ///< empty: all tets are in the body
  std::vector<int> tet_region = {};    ///< index into regions of each tet; empty without regions
  /// The regions on both sides of each of the last patches: first that of face_tet.
  std::vector<std::array<int, 2>> interfaces = {};
  /// Sharp edges: sets of nodes, and lines in .msh. Formats without such sets omit them; so do tets with 10 nodes.
  std::vector<MeshCurve> curves;
  std::map<std::string, FieldValues> point_data;  ///< one value per node; formats that cannot store it omit it
  std::map<std::string, FieldValues> cell_data;   ///< one value per tet; formats that cannot store it omit it
  /// Values for boundary conditions: one value per node, NaN where unknown. Written as point_data, and to .msh, too.
  std::map<std::string, FieldValues> boundary_data;

  std::size_t n_tets() const { return tets.size() / static_cast<std::size_t>(nodes_per_tet); }
  std::size_t n_faces() const { return face_tet.size(); }
  int nodes_per_face() const { return nodes_per_tet == 4 ? 3 : 6; }
  /// The parts that contain the tets: the regions, or the body.
  std::vector<MeshPart> parts() const { return regions.empty() ? std::vector{body} : regions; }
  std::size_t part_of(std::size_t t) const { return regions.empty() ? 0 : static_cast<std::size_t>(tet_region[t]); }
  /// Whether a patch is between regions, and not on the boundary of the mesh.
  bool is_interface(int patch) const { return static_cast<std::size_t>(patch) + interfaces.size() >= patches.size(); }
  std::span<const int> tet(std::size_t t) const {
    return {tets.data() + t * static_cast<std::size_t>(nodes_per_tet), static_cast<std::size_t>(nodes_per_tet)};
  }
  /// nodes_per_face() ids: corners, counter-clockwise from outside, then the mid-sides of 01 12 20.
  std::array<int, 6> face(std::size_t f) const;
  /// The same for all faces, one after the other.
  std::vector<int> faces() const;
  std::vector<Triangle> triangles() const;  ///< the corners of all faces
};

/// Makes a solver mesh and finds its boundary faces, which form one patch "boundary", number 2.
/// \throw std::invalid_argument if nodes_per_tet is not 4 or 10, for an id out of range, or an incomplete last tet
SolverMesh solver_mesh(std::vector<Vec3> nodes, int nodes_per_tet, std::vector<int> tets);
SolverMesh solver_mesh(const TetMesh& mesh);
SolverMesh solver_mesh(const QuadraticTetMesh& mesh);

/// Checks a name. Returns an empty text for a name that every format keeps: at most 64 letters, digits, '_', '-', '.',
/// the first a letter.
/// (CalculiX cuts names at 80 and removes blanks, and a comma ends a name of Abaqus.)
std::string problem_of_name(const std::string& name);

/// Assigns the faces to patches. The body gets the least number that no patch has.
/// \throw std::invalid_argument if there is not one patch per face, for an index out of range, a problem of a name, a
///        number below 1, or two parts with the same number or with names that differ in case only (Abaqus does not
///        distinguish them)
void set_patches(SolverMesh& mesh, std::vector<int> face_patch, std::vector<MeshPart> patches);

/// The longest name of a region: CalculiX cuts names at 80 characters, and the name of an interface consists of two.
inline constexpr std::size_t kLongestRegionName = 39;
/// The patch of the boundary faces of region 0 in a mesh of several regions.
inline constexpr const char* kRegionWalls = "walls";

/// As problem_of_name(), for a region: its name is not longer than kLongestRegionName, nor that of another part.
std::string problem_of_region_name(const std::string& name);

/// The name of the faces between two regions: `bone|marrow` of regions 1 and 2; region 0, which surrounds the bodies,
/// comes last, as in `bone|outside`.
std::string interface_name(const std::vector<std::string>& names, int a, int b);

/// Divides the tets into regions, replaces all patches, and sets cell data `region` to the numbers of the regions.
///
/// Region 0 surrounds the bodies, if it has tets. The number of any other region is its index, and that of region 0 is
/// the number of names, since formats want numbers from 1. Regions without a tet are left out. Patches have the numbers
/// that follow:
/// - boundary faces of region 0 are `walls`, and those of region a `a|walls`; without tets of region 0, they are
///   `a|outside`, with the name of region 0;
/// - faces between two regions are called by interface_name(), and are faces of the region that it names first.
/// @param tet_region  region of each tet, 0 .. names.size() - 1
/// \throw std::invalid_argument if there is not one region per tet, for an index out of range, a problem of a name, or
///        two names that differ in case only
void set_regions(SolverMesh& mesh, const std::vector<int>& tet_region, const std::vector<std::string>& names);

/// The nodes of every patch, ascending.
std::vector<std::vector<int>> patch_nodes(const SolverMesh& mesh);
/// The nodes of a curve, ascending.
std::vector<int> curve_nodes(const MeshCurve& curve);
/// Sets the curves. \throw std::invalid_argument for a node that does not exist, a problem of a name, or a name of
///        another part, as set_patches()
void set_curves(SolverMesh& mesh, std::vector<MeshCurve> curves);
/// The nodes of the boundary: of all patches that are not between regions, ascending.
std::vector<int> boundary_nodes(const SolverMesh& mesh);
/// Checks a mesh. \throw std::invalid_argument for sizes or indices that contradict each other
void require_consistent(const SolverMesh& mesh);

}  // namespace umtet
