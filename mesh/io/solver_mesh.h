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
struct SolverMesh {
  std::vector<Vec3> nodes;    ///< model units
  int nodes_per_tet = 4;      ///< 4 or 10
  std::vector<int> tets;      ///< nodes_per_tet ids each: corners, then the middles of 01 12 20 03 13 23 (VTK's order)
  std::vector<int> face_tet;  ///< the tet behind each boundary face
  std::vector<std::uint8_t> face_opposite;  ///< its corner opposite to that face: the row of kTetFace
  std::vector<int> face_patch;              ///< index into patches
  std::vector<MeshPart> patches;
  MeshPart body{"body", 1};
  /// Sharp edges: sets of nodes, and lines in .msh. Formats without such sets omit them; so do tets with 10 nodes.
  std::vector<MeshCurve> curves;
  std::map<std::string, FieldValues> point_data;  ///< one value per node; formats that cannot store it omit it
  std::map<std::string, FieldValues> cell_data;   ///< one value per tet; formats that cannot store it omit it
  /// Values for boundary conditions: one value per node, NaN where unknown. Written as point_data, and to .msh, too.
  std::map<std::string, FieldValues> boundary_data;

  std::size_t n_tets() const { return tets.size() / static_cast<std::size_t>(nodes_per_tet); }
  std::size_t n_faces() const { return face_tet.size(); }
  int nodes_per_face() const { return nodes_per_tet == 4 ? 3 : 6; }
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

/// The nodes of every patch, ascending.
std::vector<std::vector<int>> patch_nodes(const SolverMesh& mesh);
/// The nodes of a curve, ascending.
std::vector<int> curve_nodes(const MeshCurve& curve);
/// Sets the curves. \throw std::invalid_argument for a node that does not exist, a problem of a name, or a name of
///        another part, as set_patches()
void set_curves(SolverMesh& mesh, std::vector<MeshCurve> curves);
/// The nodes of all patches, ascending.
std::vector<int> boundary_nodes(const SolverMesh& mesh);
/// Checks a mesh. \throw std::invalid_argument for sizes or indices that contradict each other
void require_consistent(const SolverMesh& mesh);

}  // namespace umtet
