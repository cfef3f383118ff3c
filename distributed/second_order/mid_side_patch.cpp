#include "distributed/second_order/mid_side_patch.h"

#include <algorithm>
#include <utility>

#include "mesh/second_order/mid_side_numbers.h"
#include "mesh/second_order/mid_side_relaxation.h"

namespace umtet {
namespace {

std::array<std::int64_t, 2> edge_of(const SentTet& tet, int k) {
  const std::int64_t a = tet.corner[kMidSideEdge[k][0]], b = tet.corner[kMidSideEdge[k][1]];
  return {std::min(a, b), std::max(a, b)};
}

template <class T>
void sort_once(std::vector<T>& list) {
  std::sort(list.begin(), list.end());
  list.erase(std::unique(list.begin(), list.end()), list.end());
}

}  // namespace

void MidSidePatch::add_ring(const std::vector<SentTet>& tets) {
  for (const SentTet& tet : tets) tets_.try_emplace(tet.id, Member{tet, n_rings_});
  ++n_rings_;
}

std::vector<std::array<std::int64_t, 2>> MidSidePatch::edges() const {
  std::vector<std::array<std::int64_t, 2>> all;
  all.reserve(6 * tets_.size());
  for (const auto& [id, member] : tets_) {
    for (int k = 0; k < 6; ++k) all.push_back(edge_of(member.tet, k));
  }
  sort_once(all);
  return all;
}

MidSidePatch::Relaxed MidSidePatch::relaxed(ImplicitFunctionRef psi, double h, const SecondOrderParams& params) const {
  // Local numbers ascend with the ids, so that the order of all work is the order of the whole mesh.
  std::vector<std::int64_t> ids;
  for (const auto& [id, member] : tets_) ids.insert(ids.end(), member.tet.corner, member.tet.corner + 4);
  sort_once(ids);
  TetMesh corners;
  corners.V.resize(ids.size());
  std::vector<char> at_rim;
  std::vector<int> below;
  for (const auto& [id, member] : tets_) {
    if (member.ring == 0) below.push_back(static_cast<int>(corners.C.size()));
    at_rim.push_back(member.ring == n_rings_ - 1);
    Tet& tet = corners.C.emplace_back();
    for (int k = 0; k < 4; ++k) {
      const auto at = std::lower_bound(ids.begin(), ids.end(), member.tet.corner[k]);
      tet[k] = static_cast<int>(at - ids.begin());
      corners.V[tet[k]] = Vec3(member.tet.place[k]);
    }
  }
  const MidSideNumbers number(corners.C, ids.size());
  QuadraticTetMesh mesh = number.straight_mesh(corners);
  std::vector<MidSide> kind(number.n_edges());
  std::vector<std::array<std::int64_t, 2>> edge(kind.size());
  std::size_t t = 0;
  for (const auto& [id, member] : tets_) {
    for (int k = 0; k < 6; ++k) {
      const int node = mesh.C[t][4 + k];
      const std::size_t m = static_cast<std::size_t>(node) - ids.size();
      mesh.V[node] = Vec3(member.tet.place[4 + k]);
      kind[m] = static_cast<MidSide>(member.tet.kind[k]);
      edge[m] = edge_of(member.tet, k);
    }
    ++t;
  }
  const std::vector<Vec3> before = mesh.V;
  const std::vector<MidSide> kind_before = kind;
  MidSideRelaxation relaxation(mesh, ids.size(), kind, psi, h, params, &at_rim);
  relaxation.relax(below, {});
  relaxation.retreat(below);
  Relaxed made;
  made.has_met_rim = relaxation.has_met_rim();
  for (std::size_t m = 0; m < kind.size(); ++m) {
    const Vec3& x = mesh.V[ids.size() + m];
    const bool is_elsewhere = x != before[ids.size() + m];
    made.n_slid += is_elsewhere && kind[m] == MidSide::Surface;
    made.n_relaxed += is_elsewhere && kind[m] == MidSide::Free;
    if (is_elsewhere || kind[m] != kind_before[m])
      made.moved.push_back({edge[m], static_cast<std::int64_t>(kind[m]), {x.x(), x.y(), x.z()}});
  }
  return made;
}

}  // namespace umtet
