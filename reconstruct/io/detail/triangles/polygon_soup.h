#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "reconstruct/io/detail/cloud_source.h"
#include "reconstruct/io/triangle_mesh_io.h"

namespace umtet::detail {

/// Maximum number of corners. Real polygons have few, and cutting takes time that grows like their square.
inline constexpr std::size_t kMostCorners = 500;

/// The element of PLY for TriangleMesh::lines. An element of another program, edge, often has all edges of a surface.
inline constexpr std::string_view kSharpEdges = "sharp_edge";

/// Assigns numbers to names in order of appearance.
class NameTable {
 public:
  int number_of(std::string_view name);
  const std::vector<std::string>& names() const { return names_; }

 private:
  std::vector<std::string> names_;
  std::unordered_map<std::string, int> numbers_;
};

/// Polygons collected by a reader.
struct PolygonSoup {
  std::vector<Vec3> V;
  std::vector<std::int64_t> corners;  ///< corners of all polygons, from 0
  std::vector<std::size_t> ends;      ///< end of each polygon in `corners`
  std::vector<int> labels;            ///< label of each polygon; or empty
  /// Pairs of indices into V. Those that are sides of triangles become lines of the mesh.
  std::vector<std::array<int, 2>> lines = {};

  std::size_t size() const { return ends.size(); }
  std::size_t begin(std::size_t polygon) const { return polygon == 0 ? 0 : ends[polygon - 1]; }
};

/// Triangulates a simple polygon in some plane by ear clipping: n - 2 triangles of its own corners; a fan if it is not
/// simple. @return corners as indices into `polygon`
std::vector<std::array<int, 3>> cut_polygon(const std::vector<Vec3>& polygon);

/// Checks the collected polygons and cuts them into triangles.
/// @param names  names of the labels. The labels become 1, 2 ... if there are several, but at most kMostGroups
/// \throw CloudRefused for no faces, too few or too many corners, an index out of range, or a coordinate that is not a
///        number
TriangleFile triangles_of(const CloudSource& source, PolygonSoup soup, std::string format,
                          const NameTable* names = nullptr);

/// Check the beginning of a file. \throw CloudRefused under the conditions of the readers
void check_stl_head(const CloudSource& head);
void check_obj_head(const CloudSource& head);
void check_off_head(const CloudSource& head);

/// One reader per format. \throw CloudRefused
TriangleFile read_stl(const CloudSource& source);
TriangleFile read_obj(const CloudSource& source);
TriangleFile read_off(const CloudSource& source);
TriangleFile read_ply_faces(const CloudSource& source);

/// True if there are at least a quarter as many faces as vertices. False for an invalid header.
bool ply_has_surface(const CloudSource& head);
/// True if the first word is OFF, COFF, NOFF ...
bool begins_as_off(const CloudSource& head);

}  // namespace umtet::detail
