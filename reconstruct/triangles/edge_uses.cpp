#include "reconstruct/triangles/edge_uses.h"

#include <algorithm>
#include <array>
#include <tuple>

namespace umtet {

std::vector<EdgeUse> edge_uses(const TriangleMesh& mesh, const std::vector<int>& corner) {
  std::vector<EdgeUse> uses;
  uses.reserve(3 * mesh.F.size());
  for (std::uint32_t f = 0; f < mesh.F.size(); ++f) {
    const std::array<int, 3> v = {corner[mesh.F[f][0]], corner[mesh.F[f][1]], corner[mesh.F[f][2]]};
    if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) continue;
    for (int k = 0; k < 3; ++k) {
      const int a = v[k], b = v[(k + 1) % 3];
      uses.push_back({std::min(a, b), std::max(a, b), f, a < b});
    }
  }
  std::sort(uses.begin(), uses.end(), [](const EdgeUse& x, const EdgeUse& y) {
    return std::tie(x.low, x.high, x.face) < std::tie(y.low, y.high, y.face);
  });
  return uses;
}

}  // namespace umtet
