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

/// The tets of one region around an edge: those between the vertices of a part of its ring.
struct Fan {
  std::vector<int> vertices;
  int region = 0;
};

/// The fans of a ring, each from one face between two regions to the next; one fan where all tets are of one region.
std::vector<Fan> fans_of(const ChangingMesh& mesh, const EdgeRing& ring) {
  const auto n = ring.tets.size();
  std::size_t first = 0;
  if (ring.is_closed)
    for (std::size_t k = 1; k < n && first == 0; ++k)
      if (mesh.region_of(ring.tets[k]) != mesh.region_of(ring.tets[k - 1])) first = k;
  std::vector<Fan> fans;
  for (std::size_t k = first; k < first + n; ++k) {
    const int region = mesh.region_of(ring.tets[k % n]);
    if (fans.empty() || fans.back().region != region) fans.push_back({{ring.vertices[k % n]}, region});
    fans.back().vertices.push_back(ring.vertices[(k + 1) % ring.vertices.size()]);
  }
  // A closed ring of one region is the polygon of its vertices, without the first one again.
  if (fans.size() == 1 && ring.is_closed) fans.front().vertices.pop_back();
  return fans;
}

/// Adds the tets of the best triangulation of a polygon around (a, b), and lowers `least` of the candidate to the worst
/// of them [Klincsek1980], [Shewchuk2002].
void triangulate(const ChangingMesh& mesh, const Fan& fan, FlipCandidate& c) {
  const std::vector<int>& r = fan.vertices;
  const auto n = static_cast<int>(r.size());
  if (n < 3) return;
  const int a = c.a, b = c.b;
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
  c.least = std::min(c.least, best[0][n - 1]);
  if (!(c.least > 0)) return;
  std::vector<std::pair<int, int>> open = {{0, n - 1}};
  while (!open.empty()) {
    const auto [i, j] = open.back();
    open.pop_back();
    if (j - i < 2) continue;
    const int k = middle[i][j];
    c.new_tets.push_back({a, r[i], r[k], r[j]});
    c.new_tets.push_back({b, r[i], r[j], r[k]});
    if (mesh.has_regions()) c.new_regions.insert(c.new_regions.end(), 2, fan.region);
    open.emplace_back(i, k);
    open.emplace_back(k, j);
  }
}

/// Whether the faces (a, b, p) and (a, b, q) of a boundary or an interface may become (a, p, q) and (b, p, q).
bool may_swap_faces(const ChangingMesh& mesh, int a, int b, int p, int q) {
  for (const int v : {a, b, p, q})
    if (mesh.stratum[v] != Stratum::Boundary) return false;
  if (mesh.has_regions()) return !mesh.is_on_interface(p, q);
  if (mesh.are_neighbours(p, q)) return false;
  return !mesh.stratified || lies_on_one_patch(mesh, a, b, p, q);
}

/// Offers the removal of the edge (a, b): the best triangulation of its ring, or of each of the two parts of the ring
/// where the edge lies between two regions.
void offer_removal(const ChangingMesh& mesh, int a, int b, const std::vector<int>& tets, const EdgeRing& ring,
                   std::vector<FlipCandidate>& candidates) {
  if (ring.vertices.size() < 3) return;
  const std::vector<Fan> fans = fans_of(mesh, ring);
  if (ring.is_closed ? fans.size() > 2 : mesh.has_regions()) return;
  if (!ring.is_closed || fans.size() == 2) {
    const std::vector<int>& r = fans.front().vertices;
    if (!may_swap_faces(mesh, a, b, r.front(), r.back())) return;
    // The new edge may be in the mesh already where a single tet was between the two faces.
    const bool has_edge = fans.size() == 2 && fans[0].vertices.size() > 2 && fans[1].vertices.size() > 2 &&
                          mesh.are_neighbours(r.front(), r.back());
    if (has_edge) return;
  }
  FlipCandidate c{Operation::RemoveEdge, a, b, kInfinity, tets, {}, {}};
  std::sort(c.old_tets.begin(), c.old_tets.end());
  for (const Fan& fan : fans) {
    triangulate(mesh, fan, c);
    if (!(c.least > 0)) return;
  }
  candidates.push_back(std::move(c));
}

/// Whether a vertex between regions may collapse into b: the edge is one of its sheet or curve, which contains b, and
/// no other vertex is joined to both of them by edges of interfaces.
bool keeps_interface(const ChangingMesh& mesh, int a, int b, const EdgeRing& ring) {
  if (!ring.is_closed) return false;
  const std::vector<Fan> fans = fans_of(mesh, ring);
  const int dimension = mesh.dimension(a);
  if (dimension == 0 || (dimension == 2 ? fans.size() != 2 : fans.size() < 3)) return false;
  if (mesh.stratified && !mesh.stratified->strata->is_in_closure(mesh.stratified->of[b], mesh.stratified->of[a]))
    return false;
  return std::none_of(ring.vertices.begin(), ring.vertices.end(), [&](int v) {
    const bool is_between =
        std::any_of(fans.begin(), fans.end(), [&](const Fan& fan) { return fan.vertices.front() == v; });
    return !is_between && mesh.is_on_interface(a, v) && mesh.is_on_interface(b, v);
  });
}

/// Offers the collapse of vertex a into b.
void offer_collapse(const ChangingMesh& mesh, int a, int b, const std::vector<int>& around, const EdgeRing& ring,
                    std::vector<FlipCandidate>& candidates) {
  const std::vector<Stratum>& stratum = mesh.stratum;
  if (stratum[a] == Stratum::Fixed) return;
  if (stratum[a] == Stratum::Boundary) {
    if (stratum[b] != Stratum::Boundary) return;
    if (mesh.has_regions() ? !keeps_interface(mesh, a, b, ring) : ring.is_closed) return;
  }
  if (stratum[a] == Stratum::Boundary && mesh.stratified && !mesh.has_regions() && !keeps_patches(mesh, a, b, ring))
    return;
  FlipCandidate c{Operation::Collapse, a, b, kInfinity, {}, {}, {}};
  for (const int t : mesh.incidence.of(a)) {
    c.old_tets.push_back(t);
    if (contains(mesh.C[t], b)) continue;
    Tet moved = mesh.C[t];
    std::replace(moved.begin(), moved.end(), a, b);
    c.least = std::min(c.least, mean_ratio_of(mesh.V, moved));
    if (!(c.least > 0)) return;
    c.new_tets.push_back(moved);
    if (mesh.has_regions()) c.new_regions.push_back(mesh.region[t]);
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
  for (const int t : c.old_tets) {
    c.new_tets.push_back(mesh.C[t]);
    if (mesh.has_regions()) c.new_regions.push_back(mesh.region[t]);
  }
  return c;
}

}  // namespace umtet::detail
