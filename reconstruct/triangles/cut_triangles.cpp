#include "reconstruct/triangles/cut_triangles.h"

#include <utility>

namespace umtet {

TrianglePieces cut_triangles(const TriangleMesh& mesh, double most, std::size_t most_pieces) {
  TrianglePieces made{{mesh.V, {}, {}}, {}};
  std::vector<Vec3>& V = made.mesh.V;
  std::vector<std::pair<Triangle, std::uint32_t>> left;
  for (std::size_t f = mesh.F.size(); f-- > 0;) left.emplace_back(mesh.F[f], static_cast<std::uint32_t>(f));
  while (!left.empty()) {
    const auto [t, f] = left.back();
    left.pop_back();
    const auto edge2 = [&V, &t = t](int k) { return (V[t[k]] - V[t[(k + 1) % 3]]).squaredNorm(); };
    int longest = 0;
    for (int k = 1; k < 3; ++k)
      if (edge2(k) > edge2(longest)) longest = k;
    if (!(edge2(longest) > most * most) || made.mesh.F.size() + left.size() >= most_pieces) {
      made.mesh.F.push_back(t);
      made.of.push_back(f);
      continue;
    }
    const int a = t[longest], b = t[(longest + 1) % 3], c = t[(longest + 2) % 3], middle = static_cast<int>(V.size());
    V.push_back((V[a] + V[b]) / 2);
    left.push_back({{a, middle, c}, f});
    left.push_back({{middle, b, c}, f});
  }
  return made;
}

}  // namespace umtet
