#include "mesh/regions/periodic_match.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "mesh/certify/boundary_surface.h"

namespace umtet {

PeriodicMatch match_sides(const PeriodicMesh& mesh) {
  PeriodicMatch match;
  match.n_pairs = mesh.pairs.size();
  const TetMesh& tets = mesh.mesh.mesh;
  using Periods = std::array<int, 3>;
  // The vertex and the periods that each vertex is a copy of.
  std::vector<std::pair<int, Periods>> origin(tets.V.size());
  for (std::size_t v = 0; v < origin.size(); ++v) origin[v] = {static_cast<int>(v), {}};
  for (const PeriodicPair& pair : mesh.pairs) {
    origin[static_cast<std::size_t>(pair.copy)] = {pair.vertex, pair.periods};
    Vec3 shift;
    for (int a = 0; a < 3; ++a) shift[a] = pair.periods[a] * mesh.sides[a];
    const Vec3 off =
        tets.V[static_cast<std::size_t>(pair.copy)] - (tets.V[static_cast<std::size_t>(pair.vertex)] + shift);
    match.farthest = std::max(match.farthest, off.norm());
  }
  // A face up to whole periods: its vertices ascending, with their periods relative to the first.
  using Key = std::array<int, 12>;
  const auto key_of = [&](const Triangle& face, int& sign) {
    std::array<std::pair<int, Periods>, 3> c{};
    for (int k = 0; k < 3; ++k) c[k] = origin[static_cast<std::size_t>(face[k])];
    sign = 1;
    for (const auto& [i, j] : {std::pair(0, 1), std::pair(1, 2), std::pair(0, 1)})
      if (c[j] < c[i]) std::swap(c[i], c[j]), sign = -sign;
    Key key{};
    for (int k = 0; k < 3; ++k) {
      key[4 * k] = c[k].first;
      for (int a = 0; a < 3; ++a) key[4 * k + 1 + a] = c[k].second[a] - c[0].second[a];
    }
    return key;
  };
  struct AtPlace {
    int n_positive = 0, n_negative = 0;
    std::vector<Triangle> faces;
  };
  std::map<Key, AtPlace> at_place;  // boundary faces by their place on the torus
  for (Triangle f : boundary_faces(tets.C, tets.V.size()).triangles) {
    int sign = 0;
    AtPlace& at = at_place[key_of(f, sign)];
    ++(sign > 0 ? at.n_positive : at.n_negative);
    std::sort(f.begin(), f.end());
    at.faces.push_back(f);
  }
  for (const auto& [key, at] : at_place) {
    if (at.n_positive == 1 && at.n_negative == 1) {
      match.sides.insert(match.sides.end(), at.faces.begin(), at.faces.end());
    } else {
      match.n_unmatched += at.faces.size();
    }
  }
  std::sort(match.sides.begin(), match.sides.end());
  return match;
}

}  // namespace umtet
