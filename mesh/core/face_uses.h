#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "mesh/core/tet_mesh.h"

namespace umtet {

/// A face of a tet, filed under its least vertex.
struct FaceUse {
  std::uint64_t rest;    ///< the other two vertices, ascending, 32 bits each
  std::uint64_t source;  ///< 2 (4 tet + local face), plus 1 if its orientation is opposite to ascending vertices

  bool reversed() const { return (source & 1) != 0; }
  std::size_t place() const { return source / 2; }  ///< 4 tet + local face
  int tet() const { return static_cast<int>(source / 8); }
  int low() const { return static_cast<int>(rest >> 32); }
  int high() const { return static_cast<int>(rest & 0xffffffffu); }
};

/// Appends the faces of a tet whose least vertex is v.
inline void add_faces(const Tet& tet, std::size_t t, int v, std::vector<FaceUse>& uses) {
  const auto own = std::find(tet.begin(), tet.end(), v) - tet.begin();
  for (int k = 0; k < 4; ++k) {
    if (k == own) continue;
    const auto& f = kTetFace[k];
    // The corners after v in the cyclic order of the face.
    const int at = f[0] == own ? 0 : f[1] == own ? 1 : 2;
    const int p = tet[f[(at + 1) % 3]], q = tet[f[(at + 2) % 3]];
    if (p < v || q < v) continue;
    const auto low = static_cast<std::uint64_t>(std::min(p, q)), high = static_cast<std::uint64_t>(std::max(p, q));
    uses.push_back({low << 32 | high, 2 * (4 * t + static_cast<std::uint64_t>(k)) + (p > q ? 1 : 0)});
  }
}

/// Sorts the faces under a vertex and calls f(uses of a face, tets ascending) for each.
template <class F>
void for_each_face(std::vector<FaceUse>& uses, const F& f) {
  std::sort(uses.begin(), uses.end(), [](const FaceUse& x, const FaceUse& y) {
    return x.rest != y.rest ? x.rest < y.rest : x.source < y.source;
  });
  for (std::size_t i = 0, j = 0; i < uses.size(); i = j) {
    while (j < uses.size() && uses[j].rest == uses[i].rest) ++j;
    f(std::span<const FaceUse>(uses).subspan(i, j - i));
  }
}

}  // namespace umtet
