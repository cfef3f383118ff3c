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

/// Real polygons have a handful of corners. Cutting them takes time that grows like their square.
inline constexpr std::size_t kMostCorners = 500;

/// Numbers for names, in the order in which they come.
class NameTable {
 public:
  int number_of(std::string_view name);
  const std::vector<std::string>& names() const { return names_; }

 private:
  std::vector<std::string> names_;
  std::unordered_map<std::string, int> numbers_;
};

/// What a reader of polygons has collected so far.
struct PolygonSoup {
  std::vector<Vec3> V;
  std::vector<std::int64_t> corners;  ///< of all polygons, from 0
  std::vector<std::size_t> ends;      ///< of each in `corners`
  std::vector<int> labels;            ///< of each; or empty

  std::size_t size() const { return ends.size(); }
  std::size_t begin(std::size_t polygon) const { return polygon == 0 ? 0 : ends[polygon - 1]; }
};

/// Corners of a simple polygon in some plane, cut into n - 2 triangles of its own corners, by clipping ears; fans where
/// it is not simple. @return corners by their place in `polygon`
std::vector<std::array<int, 3>> cut_polygon(const std::vector<Vec3>& polygon);

/// Checks what was collected and cuts it into triangles.
/// @param names  the labels are their numbers, and become 1, 2 ... if there are several, not more than kMostGroups
/// \throw CloudRefused  no faces, too few or too many corners, an index out of range, a coordinate that is no number
TriangleFile triangles_of(const CloudSource& source, PolygonSoup soup, std::string format,
                          const NameTable* names = nullptr);

/// What the beginning of a file is enough for. \throw CloudRefused  as the readers
void check_stl_head(const CloudSource& head);
void check_obj_head(const CloudSource& head);
void check_off_head(const CloudSource& head);

/// One reader a format. \throw CloudRefused
TriangleFile read_stl(const CloudSource& source);
TriangleFile read_obj(const CloudSource& source);
TriangleFile read_off(const CloudSource& source);
TriangleFile read_ply_faces(const CloudSource& source);

/// Has it at least a quarter as many faces as vertices? False for a header that is none.
bool ply_has_surface(const CloudSource& head);
/// OFF, COFF, NOFF ... by its first word.
bool begins_as_off(const CloudSource& head);

}  // namespace umtet::detail
