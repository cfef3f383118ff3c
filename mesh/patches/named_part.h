#pragma once

#include <array>
#include <string>
#include <vector>

namespace umtet {

/// A named part of a mesh. Formats without names use the number: Gmsh's physical group, MEDIT's reference, Nastran's
/// property.
struct MeshPart {
  std::string name;  ///< a letter, then letters, digits, '_', '-' and '.'; see problem_of_name()
  int number = 0;    ///< >= 1
};

/// A curve of edges in the boundary, between two patches. Its number counts among curves alone.
struct MeshCurve {
  MeshPart part;
  std::vector<std::array<int, 2>> edges;  ///< pairs of corners
};

/// The name of all patches together if there are several; no patch may then have this name.
inline constexpr const char* kWholeBoundary = "boundary";

}  // namespace umtet
