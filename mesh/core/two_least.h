#pragma once

#include <algorithm>

#include "mesh/core/tet_mesh.h"

namespace umtet {

/// The two least vertices of a tet. If each face is filed under its least vertex, a tet has faces under these two only:
/// three and one.
struct TwoLeast {
  int first, second;

  explicit TwoLeast(const Tet& t) {
    const int a = std::min(t[0], t[1]), b = std::max(t[0], t[1]), c = std::min(t[2], t[3]), d = std::max(t[2], t[3]);
    first = std::min(a, c);
    second = std::min(std::max(a, c), std::min(b, d));
  }
};

}  // namespace umtet
