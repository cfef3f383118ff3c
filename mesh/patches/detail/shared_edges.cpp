#include "mesh/patches/detail/shared_edges.h"

#include <algorithm>
#include <array>

namespace umtet::detail {

std::vector<SharedEdge> shared_edges(const std::vector<Triangle>& faces) {
  std::vector<std::array<int, 3>> uses;  // v, w, face
  uses.reserve(3 * faces.size());
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const Triangle& ids = faces[f];
    for (int k = 0; k < 3; ++k) {
      const auto [v, w] = std::minmax(ids[k], ids[(k + 1) % 3]);
      uses.push_back({v, w, static_cast<int>(f)});
    }
  }
  std::sort(uses.begin(), uses.end());
  std::vector<SharedEdge> edges;
  for (std::size_t i = 0, j = 0; i < uses.size(); i = j) {
    while (j < uses.size() && uses[j][0] == uses[i][0] && uses[j][1] == uses[i][1]) ++j;
    if (j - i == 2) edges.push_back({uses[i][0], uses[i][1], uses[i][2], uses[i + 1][2]});
  }
  return edges;
}

}  // namespace umtet::detail
