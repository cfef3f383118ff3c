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

/// One number, or three, per vertex or per tet.
using FieldValues =
    std::variant<std::vector<double>, std::vector<std::int64_t>, std::vector<std::uint8_t>, std::vector<Vec3>>;

/// A tet mesh with named data.
struct MeshFile {
  TetMesh mesh;
  std::map<std::string, FieldValues> point_data;  ///< one value per mesh.V
  std::map<std::string, FieldValues> cell_data;   ///< one value per mesh.C
  std::size_t n_unused_vertices = 0;              ///< read, but in no tet, and therefore dropped
  /// As read, where all tets have ten nodes; `mesh` holds their corners, which are its first
  /// vertices.
  std::optional<QuadraticTetMesh> quadratic = std::nullopt;
  std::map<std::string, FieldValues> quadratic_data = {};  ///< one value per quadratic->V
};

/// A file that is not what its name says or contradicts itself; what() holds the path, the place and the reason.
class MeshFileRefused : public std::runtime_error {
 public:
  MeshFileRefused(const std::filesystem::path& path, const std::string& place, const std::string& reason);
};

/// The mesh with the data every mesh of this project carries: point data `boundary` (0/1) and `background_vertex`,
/// cell data `mean_ratio` (-1 where it is not a number) and `background_tet`. Empty id vectors are left out.
/// \throw std::invalid_argument when a size does not match or an index is out of range
MeshFile with_standard_data(TetMesh mesh, std::vector<std::int64_t> background_vertex,
                            std::vector<std::int64_t> background_tet);

/// Reads .vtu (VTK XML), .msh (Gmsh 2.2 and 4.1, ascii or binary) or .mesh (MEDIT, ascii), by extension.
///
/// Tets only: other elements are skipped, of curved tets the four corners are taken, and beside them all ten nodes
/// where every tet has ten; vertices without a tet are dropped, the others keep their order (.msh: ascending node
/// number). Orientation is kept, inverted tets included; a tet with a corner twice, a vertex that is not finite and a
/// mid-side that is a corner elsewhere are refused by number. From .vtu also data with one component comes along:
/// floats as double, unsigned bytes as they are, other integers as 64 bits; and floats with three. Every count is
/// compared with the size of the file before memory is asked for. \throw std::system_error when the file cannot be
/// read, MeshFileRefused for its content
MeshFile read_tet_mesh(const std::filesystem::path& path);

/// VTK XML, inline base64 blocks with 64-bit headers, double coordinates, 32-bit connectivity where that is enough.
/// Written piece by piece, without a copy of the mesh; 60 bytes a tet.
/// \throw std::invalid_argument for data of the wrong size, std::system_error naming the path when writing fails
void write_vtu(const std::filesystem::path& path, const MeshFile& file);

/// The same of second order (VTK_QUADRATIC_TETRA): data of points are one value per node, corners and mid-sides.
void write_vtu(const std::filesystem::path& path, const QuadraticTetMesh& mesh,
               const std::map<std::string, FieldValues>& point_data,
               const std::map<std::string, FieldValues>& cell_data);

/// Points with data, one value each, as VTK XML polydata with a vertex cell per point; encoding as in write_vtu().
/// \throw std::invalid_argument for data of the wrong size, std::system_error naming the path when writing fails
void write_vtp(const std::filesystem::path& path, const std::vector<Vec3>& points,
               const std::map<std::string, FieldValues>& point_data);

}  // namespace umtet
