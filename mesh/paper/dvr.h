#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "mesh/core/implicit_function.h"
#include "mesh/core/max_min.h"
#include "mesh/core/tet_mesh.h"
#include "mesh/paper/relaxation_direction.h"

namespace umtet {

/// A tet mesh with moving vertices and fixed connectivity: coordinates, the faces opposite to each vertex in its
/// 1-ring, and marks of vertices that need no relaxation.
class MovingMesh {
 public:
  /// @param rings_are_optimal  relaxation does not move any vertex until a vertex has been moved; see Tiling
  /// \throw std::invalid_argument for a vertex with more than kMaxRing tets
  explicit MovingMesh(const TetMesh& mesh, bool rings_are_optimal = false);

  std::vector<Vec3> V;  ///< change it through move()

  std::span<const Triangle> one_ring(int i) const { return {faces_.data() + begin_[i], faces_.data() + begin_[i + 1]}; }
  /// The ring of i around its present position.
  OneRing ring(int i) const { return OneRing(V[i], V, one_ring(i)); }

  /// Moves vertex i to x, and marks it and its neighbours for relaxation at their next turn. Different threads may move
  /// vertices that share no tet at the same time.
  void move(int i, const Vec3& x);

  /// Stands for all directions: settled only in an optimal ring in which no vertex has been moved.
  static constexpr int kAnyDirection = 3;
  /// False if vertex i, or a neighbour, has moved since settle(i, axis). If true, another relaxation of i along the
  /// axis would not move it, because the arithmetic is the same on the same numbers.
  bool is_settled(int i, int axis) const { return (settled_[i] >> axis & 1) != 0; }
  void settle(int i, int axis) { settled_[i] = static_cast<unsigned char>(settled_[i] | 1u << axis); }

 private:
  std::vector<std::size_t> begin_;      ///< per vertex, into faces_
  std::vector<Triangle> faces_;         ///< positively oriented with the vertex in front
  std::vector<unsigned char> settled_;  ///< a bit per axis, and one for kAnyDirection
};

/// An order of relaxation for threads that gives the same bits as the sequential order. Vertex i is in level 1 + the
/// highest level among its lower-numbered neighbours in the list. All vertices it depends on have then moved, and
/// vertices of one level share no tet.
class RelaxationOrder {
 public:
  /// @param vertices  I_R or I^+, to be relaxed in ascending order
  RelaxationOrder(const MovingMesh& mesh, std::vector<int> vertices);

  const std::vector<int>& vertices() const { return vertices_; }  ///< ascending
  /// Calls relax(i) for every vertex i with wants(i), in an order equivalent to ascending i. wants(i) is called after
  /// all vertices that i depends on have moved.
  /// @param side_by_side  SideBySide of the psi that relax(i) evaluates, if psi is evaluated in blocks; else null
  void for_each(const std::function<bool(int)>& wants, const std::function<void(int)>& relax,
                const SideBySide* side_by_side = nullptr) const;

 private:
  std::vector<int> vertices_;
  std::vector<int> by_level_;        ///< vertices_ sorted by level, ascending within a level
  std::vector<std::size_t> levels_;  ///< begin of each level in by_level_, and the end
};

/// Parameters of dvr().
struct DvrParams {
  DirectionRule directions = DirectionRule::AxesInTurn;
  MaxMin max_min = kBestMaxMin;
  std::uint64_t seed = 0;
  bool skip_settled = true;  ///< skips relaxations that cannot move their vertex; does not change the result
};

/// Directional vertex relaxation: iterations first .. first + n - 1 of Algorithm 2. In ascending order, each vertex
/// moves to the max-min point of its ring along its direction, eq. (5) [RangarajanLew2017]. A vertex stays unless the
/// worst quality of its ring rises by more than rounding.
/// @param background_vertex  per vertex, the id that determines its random directions
/// @return number of moves
/// \pre every tet at a relaxed vertex has Q > 0
std::size_t dvr(MovingMesh& mesh, const RelaxationOrder& relaxed, std::span<const std::int64_t> background_vertex,
                const DvrParams& params, int first_iteration, int n_iterations);

/// A smaller relative gain of min f is rounding: vertices in a perfect part of the lattice must not drift.
inline constexpr double kLeastGain = 1e-10;

}  // namespace umtet
