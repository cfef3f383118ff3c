#include "mesh/paper/dvr.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <stdexcept>
#include <string>
#include <utility>

namespace umtet {
namespace {

// A relaxation takes about a microsecond; to hand a task to a thread takes a few.
constexpr std::size_t kRelaxationsPerTask = 16;
constexpr std::size_t kWorthThreads = 64;

}  // namespace

MovingMesh::MovingMesh(const TetMesh& mesh, bool rings_are_optimal)
    : V(mesh.V), begin_(mesh.V.size() + 1, 0), settled_(mesh.V.size(), rings_are_optimal ? 0xf : 0) {
  for (const Tet& tet : mesh.C) {
    for (const int i : tet) ++begin_[i + 1];
  }
  for (std::size_t i = 0; i < V.size(); ++i) {
    if (begin_[i + 1] > kMaxRing) {
      throw std::invalid_argument("vertex " + std::to_string(i) + ": more than " + std::to_string(kMaxRing) + " tets");
    }
    begin_[i + 1] += begin_[i];
  }
  faces_.resize(begin_.back());
  std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
  for (const Tet& tet : mesh.C) {
    for (int k = 0; k < 4; ++k)
      faces_[next[tet[k]]++] = {tet[kTetFace[k][0]], tet[kTetFace[k][1]], tet[kTetFace[k][2]]};
  }
}

void MovingMesh::move(int i, const Vec3& x) {
  V[i] = x;
  // Two vertices that share no tet may share a neighbour: both then write the same zero, so relaxed stores will do.
  std::atomic_ref(settled_[i]).store(0, std::memory_order_relaxed);
  for (const Triangle& face : one_ring(i)) {
    for (const int j : face) std::atomic_ref(settled_[j]).store(0, std::memory_order_relaxed);
  }
}

RelaxationOrder::RelaxationOrder(const MovingMesh& mesh, std::vector<int> vertices) : vertices_(std::move(vertices)) {
  std::vector<int> level(mesh.V.size(), 0);  // 0: not in the list, or not placed yet
  std::vector<std::size_t> count;
  for (const int i : vertices_) {
    int above = 0;
    for (const Triangle& face : mesh.one_ring(i)) {
      for (const int j : face) above = std::max(above, level[j]);
    }
    level[i] = above + 1;
    if (static_cast<std::size_t>(above) >= count.size()) count.push_back(0);
    ++count[above];
  }
  levels_.assign(1, 0);
  for (const std::size_t n : count) levels_.push_back(levels_.back() + n);
  by_level_.resize(vertices_.size());
  std::vector<std::size_t> next(levels_.begin(), levels_.end());
  for (const int i : vertices_) by_level_[next[level[i] - 1]++] = i;
}

void RelaxationOrder::for_each(const std::function<bool(int)>& wants, const std::function<void(int)>& relax,
                               const SideBySide* side_by_side) const {
  std::vector<int> todo;
  for (std::size_t l = 0; l + 1 < levels_.size(); ++l) {
    todo.clear();
    for (std::size_t k = levels_[l]; k < levels_[l + 1]; ++k) {
      if (wants(by_level_[k])) todo.push_back(by_level_[k]);
    }
    if (side_by_side) {
      side_by_side->for_each(todo.size(), [&](std::size_t k) { relax(todo[k]); });
      continue;
    }
    if (todo.size() < kWorthThreads) {
      for (const int i : todo) relax(i);
      continue;
    }
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, todo.size(), kRelaxationsPerTask), [&](const auto& range) {
      for (std::size_t k = range.begin(); k != range.end(); ++k) relax(todo[k]);
    });
  }
}

std::size_t dvr(MovingMesh& mesh, const RelaxationOrder& relaxed, std::span<const std::int64_t> background_vertex,
                const DvrParams& params, int first_iteration, int n_iterations) {
  std::atomic<std::size_t> n_moves = 0;
  // Random directions never come back, so "stays where it is" is worth remembering for the axes only.
  const bool axes = params.directions == DirectionRule::AxesInTurn;
  for (int r = first_iteration; r < first_iteration + n_iterations; ++r) {
    const int axis = axes ? r % 3 : MovingMesh::kAnyDirection;
    const auto wants = [&](int i) { return !(params.skip_settled && mesh.is_settled(i, axis)); };
    relaxed.for_each(wants, [&](int i) {
      const Vec3 d = relaxation_direction(params.directions, params.seed, r, background_vertex[i]);
      const MaxMinResult best = max_min(RingOnLine(mesh.ring(i), d), params.max_min);  // Alg. 2, step 41
      if (best.f > best.f_at_zero * (1 + kLeastGain)) {
        mesh.move(i, mesh.V[i] + best.lambda * d);  // Alg. 2, step 42
        n_moves.fetch_add(1, std::memory_order_relaxed);
      } else if (axes) {
        mesh.settle(i, axis);
      }
    });
  }
  return n_moves;
}

}  // namespace umtet
