#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "mesh/background/background_mesh.h"
#include "mesh/base/id_set.h"

namespace umtet {

/// Tells of any outside vertex of any background whether the boundary of omega_h is a manifold there: LinkState says
/// the same of the vertices of a lattice that are off the background boundary.
///
/// The tets of omega_h at the vertex are those with an inside vertex. They have to be a half-ball: the triangles of the
/// link with an inside vertex a disc, and none of the vertex's positive faces
/// may have tets of omega_h on both sides. On the background boundary, which is then a wall, the link is a disc itself.
/// Keeps its memory from call to call: one for each thread.
class HalfBall {
 public:
  /// Keeps the background by reference.
  explicit HalfBall(const BackgroundMesh& background) : background_(background) {}

  /// @param v  an outside vertex; true also where no tet of omega_h is
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
  std::vector<std::array<std::int64_t, 3>> triangles_;  ///< of the link, those with an inside vertex
  std::vector<std::pair<Edge, int>> edges_;             ///< with their triangles
  std::vector<Edge> rim_;                               ///< edges of one triangle
  std::vector<std::int64_t> vertices_;
};

}  // namespace umtet
