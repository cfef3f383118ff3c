#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "mesh/core/tet_mesh.h"
#include "mesh/core/tet_quality.h"
#include "mesh/fast/flips/local_flips.h"

namespace umtet::detail {

inline bool contains(const Tet& t, int v) { return t[0] == v || t[1] == v || t[2] == v || t[3] == v; }

inline double mean_ratio_of(const std::vector<Vec3>& V, const Tet& t) {
  return mean_ratio(V[t[0]], V[t[1]], V[t[2]], V[t[3]]);
}

/// The tets around each vertex of a mesh whose tets come and go.
class Incidence {
 public:
  Incidence(std::size_t n_vertices, const std::vector<Tet>& C);

  std::span<const int> of(int v) const {
    if (list_of_[v] >= 0) return lists_[list_of_[v]];
    return {tets_.data() + begin_[v], begin_[v + 1] - begin_[v]};
  }
  void add(int v, int tet) { list(v).push_back(tet); }
  void remove(int v, int tet) { std::erase(list(v), tet); }

 private:
  std::vector<int>& list(int v);

  std::vector<std::size_t> begin_;
  std::vector<int> tets_, list_of_;
  std::vector<std::vector<int>> lists_;  ///< lists of the vertices whose tets have changed
};

/// Most tets around an edge that is removed: with nine or more tets, the best triangulation is rarely better than the
/// ring.
inline constexpr int kMostRing = 8;

/// The vertices around an edge (a, b), in cyclic order.
struct EdgeRing {
  std::vector<int> vertices;  ///< counter-clockwise seen from b
  bool is_closed = false;  ///< otherwise the edge and its faces with the first and the last vertex are on the boundary
  std::vector<int> tets;  ///< tet k contains vertices k and k + 1, the last one of a closed ring the last and the first
};

/// A tet mesh whose tets come and go.
struct ChangingMesh {
  /// Keeps references to the strata.
  /// @param patches     null for a smooth boundary
  /// @param tet_region  per tet, or empty for a mesh of one region
  ChangingMesh(std::vector<Vec3> positions, std::vector<Tet> tets, const std::vector<VertexStratum>& strata,
               const StratifiedVertices* patches = nullptr, std::vector<int> tet_region = {})
      : V(std::move(positions)),
        C(std::move(tets)),
        region(std::move(tet_region)),
        incidence(V.size(), C),
        stratum(strata),
        stratified(patches) {}

  /// The tets with the edge (a, b).
  std::vector<int> tets_at(int a, int b) const;
  /// The ring of the edge (a, b). It is empty if the tets form no ring or are more than kMostRing.
  /// @param tets  tets_at(a, b)
  EdgeRing ring_of(int a, int b, const std::vector<int>& tets) const;
  bool are_neighbours(int a, int b) const;
  bool has_regions() const { return !region.empty(); }
  int region_of(int tet) const { return region.empty() ? 0 : region[tet]; }
  /// Whether two tets of different regions share a face with the edge (a, b), or a face of one tet only has it.
  bool is_on_interface(int a, int b) const;
  /// The patch of a face whose corners are on the boundary (BoundaryStrata::patch_of()); 0 for a smooth boundary.
  int patch_of(int a, int b, int c) const {
    return stratified ? stratified->strata->patch_of(stratified->of[a], stratified->of[b], stratified->of[c]) : 0;
  }
  int dimension(int v) const { return stratified ? (*stratified->strata)[stratified->of[v]].dimension : 2; }
  /// Whether a vertex may move.
  bool moves(int v) const {
    return stratum[v] != VertexStratum::Fixed && (stratum[v] == VertexStratum::Inner || dimension(v) > 0);
  }
  /// The function of a boundary face's patch, at x. Not inlined, as is solve_on_stratum(): the rounding of smooth
  /// boundaries would change with the code around it.
  [[gnu::noinline]] double value_on_patch(const Triangle& f, const Vec3& x, Vec3& gradient) const;
  /// The function of a face between two regions, at x, negative in the greater one. \pre stratified
  double value_between(int a, int b, const Vec3& x, Vec3& gradient) const {
    return stratified->strata->value(stratified->between(a, b), x, &gradient);
  }

  std::vector<Vec3> V;
  std::vector<Tet> C;       ///< tets that are gone stay in this list
  std::vector<int> region;  ///< per tet; empty: one region
  Incidence incidence;      ///< lists only the tets that are in the mesh
  const std::vector<VertexStratum>& stratum;
  const StratifiedVertices* stratified;
};

}  // namespace umtet::detail
