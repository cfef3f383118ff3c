#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "reconstruct/io/input_file.h"
#include "reconstruct/io/point_cloud_io.h"
#include "reconstruct/triangles/triangle_mesh.h"

namespace umtet {

/// Properties of a triangle file besides the triangles.
struct TriangleFileReport {
  std::string format;                    ///< "stl binary", "obj" ...
  std::size_t n_vertices = 0;            ///< number in the file; three per triangle in STL
  std::size_t n_faces = 0;               ///< number in the file
  std::size_t n_polygons = 0;            ///< faces with more than three corners, which were cut into triangles
  std::vector<std::string> label_names;  ///< names of labels 1, 2 ...: solids, groups or materials; empty without names
  std::size_t n_lines = 0;               ///< edges of the surface that the file names as lines
  std::size_t n_lines_ignored = 0;       ///< places where lines of the file leave the edges of the triangles
  std::size_t n_groups_ignored = 0;      ///< number of groups if above kMostGroups: they are not parts of a boundary
};

/// A triangle mesh read from a file.
struct TriangleFile {
  TriangleMesh mesh;
  TriangleFileReport report;
};

/// Maximum number of different groups or materials; more are ignored.
inline constexpr std::size_t kMostGroups = 64;

/// Interpretation of a PLY file with faces: a surface, or the cloud of its vertices.
enum class PlyFaces { Surface, Ignored };

/// Tests whether a file contains triangles: STL, OBJ or OFF by its extension, OFF or PLY by its first line. A PLY file
/// does if it has at least a quarter as many faces as vertices; with fewer, its points are the scan. Reads the
/// beginning only.
///
/// \throw std::system_error naming the file, if it cannot be opened or read
bool holds_triangles(const InputFile& file, PlyFaces faces = PlyFaces::Surface);
bool holds_triangles(const std::filesystem::path& file, PlyFaces faces = PlyFaces::Surface);

/// Reads a triangle mesh in STL (ascii, binary), OBJ, OFF (ascii) or PLY with faces. All numbers are in double
/// precision.
///
/// - STL: binary is detected by the file size, whatever the first bytes; there may be several solids.
/// - OBJ: v and f with negative and all other kinds of indices, and lines continued after a backslash. Statements l
///   that run along edges of the triangles become lines of the mesh. Curves and texture coordinates are skipped.
///   Materials are only names: no other file is opened.
/// - OFF: also with colours, normals and texture coordinates.
/// - PLY: as read_scan(), and the list vertex_indices or vertex_index. An element sharp_edge with vertex1 and vertex2
///   becomes lines of the mesh.
///
/// Polygons, also concave ones, are cut into triangles inside of them. Vertices without a face are dropped.
///
/// Labels are 1, 2 ... in order of appearance: solids of STL; for OBJ the groups (g), else the materials (usemtl), else
/// the objects (o), the first of these of which there are several. For PLY they are the property `label` (or `patch`)
/// of the faces, unchanged and without names. Normals in files are ignored, because the order of corners gives the
/// orientation.
///
/// Every count is compared with the size of the file, and every index with the number of vertices, before it is used.
///
/// \throw CloudRefused for a file that is malformed or truncated, no faces, an invalid index or coordinate, or corners
///        that are all in a plane
/// \throw std::system_error naming the file, if it cannot be opened or read
TriangleFile read_triangles(const InputFile& file);
TriangleFile read_triangles(const std::filesystem::path& file);

/// Checks the first megabyte of a file, and rejects what read_triangles() would reject there. \throw CloudRefused
void check_triangles_head(const InputFile& file);

/// Writes binary little-endian PLY: double x y z, vertex_indices of int and, if present, int label and an element
/// sharp_edge. read_triangles() returns the same mesh. The caller owns the stream and checks it.
void write_ply(std::ostream&, const TriangleMesh&);

}  // namespace umtet
