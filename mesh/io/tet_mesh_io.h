#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "mesh/core/quadratic_tet_mesh.h"
#include "mesh/core/tet_mesh.h"

namespace umtet {

/// Data of vertices or tets: one number, or three, for each.
using FieldValues =
    std::variant<std::vector<double>, std::vector<std::int64_t>, std::vector<std::uint8_t>, std::vector<Vec3>>;

/// A tet mesh with named data.
struct MeshFile {
  TetMesh mesh;
  std::map<std::string, FieldValues> point_data;  ///< one value per mesh.V
  std::map<std::string, FieldValues> cell_data;   ///< one value per mesh.C
  std::size_t n_unused_vertices = 0;              ///< vertices of the file that were dropped because no tet uses them
  /// The ten-node mesh as read, if all tets have ten nodes. Then `mesh` contains their corners, which are its first
  /// vertices.
  std::optional<QuadraticTetMesh> quadratic = std::nullopt;
  std::map<std::string, FieldValues> quadratic_data = {};  ///< one value per quadratic->V
  /// Names of the values of cell data `region`; empty if the file has no names.
  std::map<std::int64_t, std::string> region_names = {};
};

/// Error for a file whose content contradicts its name or itself; what() contains the path, the location and the
/// reason.
class MeshFileRefused : public std::runtime_error {
 public:
  MeshFileRefused(const std::filesystem::path& path, const std::string& place, const std::string& reason);
};

/// A mesh with the standard data of this project: point data `boundary` (0/1) and `background_vertex`, cell data
/// `mean_ratio` (-1 where it is not a number) and `background_tet`. Empty id vectors are omitted.
/// \throw std::invalid_argument if a size does not match or an index is out of range
MeshFile with_standard_data(TetMesh mesh, std::vector<std::int64_t> background_vertex,
                            std::vector<std::int64_t> background_tet);

/// Reads .vtu (VTK XML), .msh (Gmsh 2.2 and 4.1, ascii or binary), .mesh (MEDIT, ascii) or .inp (Abaqus and CalculiX,
/// with one part), by extension.
///
/// Elements and vertices:
/// - Only tets are read, other elements are skipped. Of curved tets the four corners are read, and all ten nodes if
///   every tet has ten.
/// - Vertices without a tet are dropped. The others keep their order (.msh: ascending node number).
/// - Orientation is kept, inverted tets included. A tet with a repeated corner, a vertex that is not finite and a
///   mid-side that is a corner elsewhere are rejected by number.
/// - From .vtu, data with one component are read, too: floats as double, unsigned bytes unchanged, other integers as 64
///   bits; and floats with three components. Field data NAME = number are the names of regions, if there is one for
///   each value of cell data `region`.
/// - From the other formats, tets that have several marks get cell data `region`: physical volumes of Gmsh, or its
///   entities if there are none; references of MEDIT; sets of elements of Abaqus, in the order of the file from 1. A
///   set of a *ELEMENT line marks its elements; *ELSETs replace these marks if each tet is in exactly one of them.
///
/// Every count is compared with the size of the file before memory is allocated.
/// \throw std::system_error if the file cannot be read, MeshFileRefused for invalid content
MeshFile read_tet_mesh(const std::filesystem::path& path);

/// Writes VTK XML: raw appended data with 64-bit headers, double coordinates, 32-bit connectivity if sufficient.
/// Written block by block, without a copy of the mesh; 45 bytes per tet.
/// \throw std::invalid_argument for data of the wrong size, std::system_error naming the path if writing fails
void write_vtu(const std::filesystem::path& path, const MeshFile& file);

/// Writes ten-node tets (VTK_QUADRATIC_TETRA); point data have one value per node, corners and mid-sides.
void write_vtu(const std::filesystem::path& path, const QuadraticTetMesh& mesh,
               const std::map<std::string, FieldValues>& point_data,
               const std::map<std::string, FieldValues>& cell_data);

/// Writes points with data, one value each, as VTK XML polydata with a vertex cell per point; encoding as in
/// write_vtu().
/// \throw std::invalid_argument for data of the wrong size, std::system_error naming the path if writing fails
void write_vtp(const std::filesystem::path& path, const std::vector<Vec3>& points,
               const std::map<std::string, FieldValues>& point_data);

}  // namespace umtet
