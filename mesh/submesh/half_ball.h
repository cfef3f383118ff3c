#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "mesh/background/background_mesh.h"
#include "mesh/base/id_set.h"

namespace umtet {

/// Tests whether the boundary of omega_h is a manifold at an outside vertex of any background. For vertices of a
/// lattice off the background boundary, LinkState gives the same answer.
///
/// The tets of omega_h at the vertex are those with an inside vertex. They have to form a half-ball: the triangles of
/// the link with an inside vertex form a disc, and no positive face at the vertex has tets of omega_h on both sides. On
/// the background boundary, which is then a wall, the link itself is a disc. The object keeps its working memory
/// between calls; use one object per thread.
class HalfBall {
 public:
  /// Keeps a reference to the background.
  explicit HalfBall(const BackgroundMesh& background) : background_(background) {}

  /// @param v  an outside vertex; the result is true also if no tet of omega_h is at it
  bool operator()(std::int64_t v, const IdSet& inside);

 private:
  struct Edge {
    std::int64_t low, high;
    bool operator<(const Edge& e) const { return low != e.low ? low < e.low : high < e.high; }
    bool operator==(const Edge& e) const { return low == e.low && high == e.high; }
  };
  void list_triangles(std::int64_t v, const IdSet& inside);
  bool is_disc(const IdSet& inside);
  bool is_one_cycle();
  bool is_connected();

  const BackgroundMesh& background_;
  std::vector<std::int64_t> star_;
  std::vector<std::array<std::int64_t, 3>> triangles_;  ///< triangles of the link with an inside vertex
  std::vector<std::pair<Edge, int>> edges_;             ///< edges, each with the index of its triangle
  std::vector<Edge> rim_;                               ///< edges that belong to one triangle only
  std::vector<std::int64_t> vertices_;
};

}  // namespace umtet
