#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "mesh/io/tet_mesh_io.h"

namespace umtet {

/// The regions of a mesh from a file.
struct FileRegions {
  std::string source;               ///< the cell data that contain the marks
  std::vector<int> of_tet;          ///< 0 .. names.size() - 1
  std::vector<std::string> names;   ///< by region, printable; of a mark without a name: its digits
  std::vector<std::int64_t> marks;  ///< by region, as the file has them
  bool has_outside = false;         ///< whether region 0 has tets
};

/// The name of the region that surrounds the bodies.
inline constexpr const char* kOutside = "outside";

/// Returns the regions of a mesh whose tets have several marks; empty if they have one or none.
///
/// The marks are cell data `region`, or the first of these that has whole numbers: `gmsh:physical`, `medit:ref`,
/// `cell_tags`, `MaterialIds`, `Material`, `material`, `label`, `labels`, `subdomain`. Region 0 is the one that is
/// called `outside`, or else has mark 0; the others follow from 1, by ascending marks. Without such a region, region 0
/// is called `outside` and has no tets.
std::optional<FileRegions> file_regions(const MeshFile& file);

}  // namespace umtet
