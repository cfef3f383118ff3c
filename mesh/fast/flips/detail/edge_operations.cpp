#include "mesh/fast/flips/detail/edge_operations.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace umtet::detail {
namespace {

using Operation = FlipCandidate::Operation;
using Stratum = VertexStratum;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Whether the boundary faces (a, b, c) and (a, b, d), and those that replace them, are on one patch.
bool lies_on_one_patch(const ChangingMesh& mesh, int a, int b, int c, int d) {
  const int patch = mesh.patch_of(a, b, c);
  return patch >= -1 && mesh.patch_of(a, b, d) == patch && mesh.patch_of(a, c, d) == patch &&
         mesh.patch_of(b, c, d) == patch;
}

/// Whether boundary vertex a may collapse into b as far as their strata are concerned.
bool keeps_patches(const ChangingMesh& mesh, int a, int b, const EdgeRing& ring) {
  const BoundaryStrata& strata = *mesh.stratified->strata;
  const std::vector<int>& of = mesh.stratified->of;
  const int dimension = strata[of[a]].dimension;
  if (dimension == 0 || !strata.is_in_closure(of[b], of[a])) return false;
  if (dimension == 1) {
    // The edge has to be one of the curve: its faces are on both patches.
    const int left = mesh.patch_of(a, b, ring.vertices.front()), right = mesh.patch_of(a, b, ring.vertices.back());
    if (left < 0 || right < 0 || left == right) return false;
  }
  std::vector<Triangle> faces;  // at a, from all tets, sorted
  for (const int t : mesh.incidence.of(a)) {
    for (const auto& f : kTetFace) {
      Triangle face = {mesh.C[t][f[0]], mesh.C[t][f[1]], mesh.C[t][f[2]]};
      if (std::find(face.begin(), face.end(), a) == face.end()) continue;
      if (std::any_of(face.begin(), face.end(), [&](int v) { return mesh.stratum[v] == Stratum::Inner; })) continue;
      std::sort(face.begin(), face.end());
      faces.push_back(face);
    }
  }
  std::sort(faces.begin(), faces.end());
  for (std::size_t k = 0; k < faces.size(); ++k) {
    const Triangle& f = faces[k];
    const bool is_twin = (k > 0 && faces[k - 1] == f) || (k + 1 < faces.size() && faces[k + 1] == f);
    if (is_twin || std::find(f.begin(), f.end(), b) != f.end()) continue;
    Triangle moved = f;
    std::replace(moved.begin(), moved.end(), a, b);
    const int patch = mesh.patch_of(f[0], f[1], f[2]);
    if (patch < -1 || mesh.patch_of(moved[0], moved[1], moved[2]) != patch) return false;
  }
  return true;
}

/// Offers the triangulation of a ring whose worst tet is best [Klincsek1980], [Shewchuk2002].
void offer_removal(const ChangingMesh& mesh, int a, int b, const std::vector<int>& tets, const EdgeRing& ring,
                   std::vector<FlipCandidate>& candidates) {
  const std::vector<Stratum>& stratum = mesh.stratum;
  const std::vector<int>& r = ring.vertices;
  const auto n = static_cast<int>(r.size());
  if (n < 3) return;
  if (!ring.is_closed) {
    if (stratum[a] != Stratum::Boundary || stratum[b] != Stratum::Boundary) return;
    if (stratum[r.front()] != Stratum::Boundary || stratum[r.back()] != Stratum::Boundary) return;
    if (mesh.are_neighbours(r.front(), r.back())) return;
    if (mesh.stratified && !lies_on_one_patch(mesh, a, b, r.front(), r.back())) return;
  }
  std::array<std::array<double, kMostRing + 1>, kMostRing + 1> best{};
  std::array<std::array<int, kMostRing + 1>, kMostRing + 1> middle{};
  for (int i = 0; i + 1 < n; ++i) best[i][i + 1] = kInfinity;
  for (int width = 2; width < n; ++width) {
    for (int i = 0; i + width < n; ++i) {
      const int j = i + width;
      best[i][j] = -kInfinity;
      for (int k = i + 1; k < j; ++k) {
        double q = std::min(best[i][k], best[k][j]);
        if (q <= best[i][j]) continue;
        q = std::min({q, mean_ratio_of(mesh.V, {a, r[i], r[k], r[j]}), mean_ratio_of(mesh.V, {b, r[i], r[j], r[k]})});
        if (q > best[i][j]) best[i][j] = q, middle[i][j] = k;
      }
    }
  }
  FlipCandidate c{Operation::RemoveEdge, a, b, best[0][n - 1], tets, {}};
  std::sort(c.old_tets.begin(), c.old_tets.end());
  if (!(c.least > 0)) return;
  std::vector<std::pair<int, int>> open = {{0, n - 1}};
  while (!open.empty()) {
    const auto [i, j] = open.back();
    open.pop_back();
    if (j - i < 2) continue;
    const int k = middle[i][j];
    c.new_tets.push_back({a, r[i], r[k], r[j]});
    c.new_tets.push_back({b, r[i], r[j], r[k]});
    open.emplace_back(i, k);
    open.emplace_back(k, j);
  }
  candidates.push_back(std::move(c));
}

/// Offers the collapse of vertex a into b.
void offer_collapse(const ChangingMesh& mesh, int a, int b, const std::vector<int>& around, const EdgeRing& ring,
                    std::vector<FlipCandidate>& candidates) {
  const std::vector<Stratum>& stratum = mesh.stratum;
  if (stratum[a] == Stratum::Fixed) return;
  if (stratum[a] == Stratum::Boundary && (ring.is_closed || stratum[b] != Stratum::Boundary)) return;
  if (stratum[a] == Stratum::Boundary && mesh.stratified && !keeps_patches(mesh, a, b, ring)) return;
  FlipCandidate c{Operation::Collapse, a, b, kInfinity, {}, {}};
  for (const int t : mesh.incidence.of(a)) {
    c.old_tets.push_back(t);
    if (contains(mesh.C[t], b)) continue;
    Tet moved = mesh.C[t];
    std::replace(moved.begin(), moved.end(), a, b);
    c.least = std::min(c.least, mean_ratio_of(mesh.V, moved));
    if (!(c.least > 0)) return;
    c.new_tets.push_back(moved);
  }
  if (c.new_tets.empty()) return;
  std::sort(c.old_tets.begin(), c.old_tets.end());
  // The link condition [Dey1999]: a neighbour of both vertices lies around their edge.
  for (const int t : mesh.incidence.of(a)) {
    for (const int v : mesh.C[t]) {
      if (v == a || v == b || std::find(ring.vertices.begin(), ring.vertices.end(), v) != ring.vertices.end()) continue;
      if (std::any_of(around.begin(), around.end(), [&](int s) { return contains(mesh.C[s], v); })) continue;
      if (mesh.are_neighbours(v, b)) return;
    }
  }
  candidates.push_back(std::move(c));
}

}  // namespace

std::vector<FlipCandidate> edge_operations(const ChangingMesh& mesh, int tet, double promising, std::size_t most) {
  std::vector<FlipCandidate> candidates;
  const Tet corners = mesh.C[tet];
  for (int i = 0; i < 4; ++i) {
    for (int j = i + 1; j < 4; ++j) {
      const int a = corners[i], b = corners[j];
      const std::vector<int> tets = mesh.tets_at(a, b);
      const EdgeRing ring = mesh.ring_of(a, b, tets);
      if (ring.vertices.empty()) continue;
      offer_removal(mesh, a, b, tets, ring, candidates);
      offer_collapse(mesh, a, b, tets, ring, candidates);
      offer_collapse(mesh, b, a, tets, ring, candidates);
    }
  }
  const double bar = promising * mean_ratio_of(mesh.V, corners);
  std::erase_if(candidates, [&](const FlipCandidate& c) { return c.least < bar; });
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const FlipCandidate& x, const FlipCandidate& y) { return x.least > y.least; });
  if (candidates.size() > most) candidates.resize(most);
  return candidates;
}

FlipCandidate smoothing_around(const ChangingMesh& mesh, int tet) {
  FlipCandidate c;
  for (const int v : mesh.C[tet])
    for (const int t : mesh.incidence.of(v)) c.old_tets.push_back(t);
  std::sort(c.old_tets.begin(), c.old_tets.end());
  c.old_tets.erase(std::unique(c.old_tets.begin(), c.old_tets.end()), c.old_tets.end());
  for (const int t : c.old_tets) c.new_tets.push_back(mesh.C[t]);
  return c;
}

}  // namespace umtet::detail
