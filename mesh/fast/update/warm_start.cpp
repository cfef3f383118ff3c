#include "mesh/fast/update/warm_start.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstdint>
#include <utility>

#include "mesh/core/asking_psi.h"
#include "mesh/fast/update/detail/flat_tets.h"
#include "mesh/implicit/closest_point.h"

namespace umtet {
namespace {

// More sweeps save smoothing about what they cost (moving_bench).
constexpr int kSweeps = 3;
// psi = 0 crosses an edge at every positive vertex, and no tiling has longer ones, in h: farther feet are elsewhere.
constexpr double kFarthestFoot = 1.5;
// Of ClosestPointParams, if that is less. A vertex has to be on psi = 0 to ClosestPointParams::tol; along the surface
// smoothing moves it anyway, so .01 h will do there, which the damped iteration without Hessians reaches soon.
constexpr double kFootTol = 1e-2;
constexpr std::size_t kFeetPerTask = 64;  // of a microsecond or two each

class Start {
 public:
  Start(BackgroundLayer& layer, const ProjectionParams& projection)
      : ids_(layer.background_vertex),
        layer_(layer.layer),
        projection_(projection),
        background_V_(layer.layer.V),
        recalled_(layer.layer.V.size(), 0) {}

  void recall(const BackgroundMesh& background, const IdSet& inside, const FastMemory& memory);
  std::size_t go_to_feet(ImplicitFunctionRef psi, const Context& context);
  void follow_boundary();
  void draw_along();
  void go_back_where_flat();
  const std::vector<unsigned char>& recalled() const { return recalled_; }
  bool is_on_surface() const { return is_on_surface_; }

 private:
  Vec3 mean_around(int v, const std::vector<Vec3>& u) const;

  const std::vector<std::int64_t>& ids_;
  ActiveLayer& layer_;
  const ProjectionParams& projection_;
  const std::vector<Vec3> background_V_;
  std::vector<unsigned char> recalled_;
  std::vector<std::pair<int, Vec3>> boundary_from_;  ///< recalled Boundary vertices, before they went to their feet
  bool is_on_surface_ = true;
};

void Start::recall(const BackgroundMesh& background, const IdSet& inside, const FastMemory& memory) {
  IdSet changed(background.n_vertices());  // and their neighbours
  std::vector<std::int64_t> link;
  for (std::size_t w = 0; w < inside.n_words(); ++w) {
    for (std::uint64_t bits = inside.word(w) ^ memory.inside.word(w); bits != 0; bits &= bits - 1) {
      const std::int64_t v = static_cast<std::int64_t>(w * 64) + std::countr_zero(bits);
      link.clear();
      background.link(v, link);
      changed.insert(v);
      for (const std::int64_t n : link) changed.insert(n);
    }
  }
  std::size_t v = 0;
  for (const auto& [id, x] : memory.moved) {
    while (v < ids_.size() && ids_[v] < id) ++v;
    if (v == ids_.size()) break;
    if (ids_[v] != id || layer_.role[v] == ActiveLayer::Role::Fixed || changed.test(id)) continue;
    layer_.V[v] = x;
    recalled_[v] = 1;
  }
}

/// Returns the number of values of psi.
std::size_t Start::go_to_feet(ImplicitFunctionRef psi, const Context& context) {
  std::vector<int> boundary;
  for (std::size_t v = 0; v < layer_.V.size(); ++v) {
    if (layer_.role[v] != ActiveLayer::Role::Boundary) continue;
    boundary.push_back(static_cast<int>(v));
    if (recalled_[v] != 0) boundary_from_.emplace_back(v, layer_.V[v]);
  }
  std::atomic<bool> all_found = true;
  ClosestPointParams params = projection_.closest_point;
  params.method = ClosestPointMethod::Damped;
  params.foot_tol = std::max(params.foot_tol, kFootTol);
  const std::size_t n_evaluations =
      sum_asking<std::size_t>(psi, 0, boundary.size(), kFeetPerTask, context, [&](std::size_t k, std::size_t& n) {
        Vec3& x = layer_.V[boundary[k]];
        const double h = layer_.h_at(boundary[k]);
        const ClosestPoint foot = closest_point(psi, x, h, params);
        n += static_cast<std::size_t>(foot.iterations);
        if (foot.converged && (foot.point - x).norm() <= kFarthestFoot * h) {
          x = foot.point;
        } else {
          all_found.store(false, std::memory_order_relaxed);
        }
      });
  is_on_surface_ = all_found;
  return n_evaluations;
}

/// The mean of u over the other vertices of the tets at v.
Vec3 Start::mean_around(int v, const std::vector<Vec3>& u) const {
  const int begin = layer_.ring_begin[v], end = layer_.ring_begin[v + 1];
  Vec3 sum = -(end - begin) * u[v];
  for (int r = begin; r < end; ++r) {
    const Tet& t = layer_.C[layer_.ring[r]];
    sum += (u[t[0]] + u[t[1]]) + (u[t[2]] + u[t[3]]);
  }
  return sum / (3 * (end - begin));
}

/// Recalled inner vertices move as those around them do in the mean. One sweep, in ascending order: a second one saves
/// smoothing no more than it costs.
void Start::follow_boundary() {
  std::vector<Vec3> moved(layer_.V.size(), Vec3::Zero());
  for (const auto& [v, from] : boundary_from_) moved[v] = layer_.V[v] - from;
  for (std::size_t v = 0; v < layer_.V.size(); ++v) {
    if (layer_.role[v] != ActiveLayer::Role::Inner || recalled_[v] == 0) continue;
    moved[v] = mean_around(static_cast<int>(v), moved);
    layer_.V[v] += moved[v];
  }
}

void Start::draw_along() {
  std::vector<Vec3> u(layer_.V.size());
  std::vector<int> drawn;
  for (std::size_t v = 0; v < u.size(); ++v) {
    u[v] = layer_.V[v] - background_V_[v];
    if (layer_.role[v] == ActiveLayer::Role::Inner && recalled_[v] == 0) drawn.push_back(static_cast<int>(v));
  }
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (const int v : drawn) u[v] = mean_around(v, u);
  }
  for (const int v : drawn) layer_.V[v] = background_V_[v] + u[v];
}

void Start::go_back_where_flat() {
  detail::go_back_where_flat(
      layer_, projection_.least_quality, [&](int v) { return layer_.V[v] != background_V_[v]; },
      [&](int v) {
        layer_.V[v] = background_V_[v];
        recalled_[v] = 0;
        is_on_surface_ &= layer_.role[v] != ActiveLayer::Role::Boundary;
      });
}

}  // namespace

WarmStart warm_start(const BackgroundMesh& background, ImplicitFunctionRef psi, const IdSet& inside,
                     const FastMemory& memory, const ProjectionParams& projection, BackgroundLayer& layer,
                     const Context& context) {
  Start start(layer, projection);
  WarmStart result;
  start.recall(background, inside, memory);
  result.psi_evaluations = start.go_to_feet(psi, context);
  start.follow_boundary();
  start.draw_along();
  start.go_back_where_flat();
  result.recalled = start.recalled();
  result.is_on_surface = start.is_on_surface();
  result.n_recalled = static_cast<std::size_t>(std::count(result.recalled.begin(), result.recalled.end(), 1));
  return result;
}

}  // namespace umtet
