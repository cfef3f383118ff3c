#include "mesh/shell.h"

#include <cstddef>

namespace umtet {

void list_rings(Shell& shell) {
  shell.ring_begin.assign(shell.V.size() + 1, 0);
  for (const Tet& tet : shell.C) {
    for (const int v : tet) ++shell.ring_begin[v + 1];
  }
  for (std::size_t v = 0; v < shell.V.size(); ++v) shell.ring_begin[v + 1] += shell.ring_begin[v];
  shell.ring.resize(4 * shell.C.size());
  std::vector<int> next(shell.ring_begin.begin(), shell.ring_begin.end() - 1);
  for (int t = 0; t < static_cast<int>(shell.C.size()); ++t) {
    for (const int v : shell.C[t]) shell.ring[next[v]++] = t;
  }
}

}  // namespace umtet
