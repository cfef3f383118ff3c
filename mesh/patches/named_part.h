#pragma once

#include <string>

namespace umtet {

/// A named part of a mesh. Formats without names use the number: Gmsh's physical group, MEDIT's reference, Nastran's
/// property.
struct MeshPart {
  std::string name;  ///< a letter, then letters, digits, '_', '-' and '.'; see problem_of_name()
  int number = 0;    ///< >= 1
};

/// The name of all patches together if there are several; no patch may then have this name.
inline constexpr const char* kWholeBoundary = "boundary";

}  // namespace umtet
