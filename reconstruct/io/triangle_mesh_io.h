#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "reconstruct/io/point_cloud_io.h"
#include "reconstruct/triangles/triangle_mesh.h"

namespace umtet {

/// What was found in a file of triangles besides them.
struct TriangleFileReport {
  std::string format;                    ///< "stl binary", "obj" ...
  std::size_t n_vertices = 0;            ///< as the file counts them; three a triangle in STL
  std::size_t n_faces = 0;               ///< as the file counts them
  std::size_t n_polygons = 0;            ///< of these, with more than three corners: cut into triangles
  std::vector<std::string> label_names;  ///< of label 1, 2 ...: solids, groups or materials; empty without
  std::size_t n_groups_ignored = 0;      ///< more than kMostGroups: they are no parts of a boundary
};

struct TriangleFile {
  TriangleMesh mesh;
  TriangleFileReport report;
};

/// More different groups or materials than this are ignored.
inline constexpr std::size_t kMostGroups = 64;

/// What a PLY with faces is: a surface, or the cloud of its vertices.
enum class PlyFaces { Surface, Ignored };

/// Is a file one of triangles: STL, OBJ or OFF by its extension, OFF or PLY by its first line? A PLY is one if it has
/// at least a quarter as many faces as vertices; with fewer its points are the scan. Reads the beginning only.
///
/// \throw std::system_error  the file cannot be opened or read; names it
bool holds_triangles(const std::filesystem::path& file, PlyFaces faces = PlyFaces::Surface);

/// Reads STL (ascii, binary), OBJ, OFF (ascii) and PLY with faces. Double precision throughout.
///
/// STL: binary by its size, whatever it begins with; several solids. OBJ: v and f with negative and all other kinds of
/// indices, lines that go on behind a backslash; lines, curves and texture coordinates are stepped over, materials are
/// names: no other file is opened. OFF: also with colours, normals, texture coordinates. PLY: as read_scan(), and the
/// list vertex_indices or vertex_index.
/// Polygons are cut into triangles inside of them, concave ones too. Vertices that no face uses are left out.
///
/// Labels are 1, 2 ... in the order in which they come: solids of STL; of OBJ the groups (g), else the materials
/// (usemtl), else the objects (o), whichever there are several of. PLY: property `label` (or `patch`) of the faces, as
/// it is, without names. Normals of files are not looked at: the order of corners says the same.
///
/// No count is believed before it is compared with the size of the file, and no index before it is compared with the
/// number of vertices.
///
/// \throw CloudRefused         malformed, cut short, no faces, an index or a coordinate that is none, or all within a
///                             plane
/// \throw std::system_error    the file cannot be opened or read; names it
TriangleFile read_triangles(const std::filesystem::path& file);

/// Refuses by its first megabyte what read_triangles() would refuse for what is there. \throw  as read_triangles()
void check_triangles_head(const std::filesystem::path& file);

/// Binary little-endian PLY with double x y z, vertex_indices of int and, where there are any, int label;
/// read_triangles() gives the same back. The caller owns the stream and checks it.
void write_ply(std::ostream&, const TriangleMesh&);

}  // namespace umtet
