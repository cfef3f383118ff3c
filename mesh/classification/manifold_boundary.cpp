#include "mesh/classification/manifold_boundary.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <unordered_map>

#include "mesh/submesh/half_ball.h"

namespace umtet {
namespace {

/// Of every vertex: whether the boundary is a manifold there, and what its configuration costs.
class BoundaryStates {
 public:
  BoundaryStates(const BackgroundMesh& background, const VertexLinks* links)
      : background_(background), links_(links), half_ball_(background) {}

  /// @param v  an outside vertex
  bool is_manifold(std::int64_t v, const IdSet& inside) {
    if (!has_state(v)) return half_ball_(v, inside);
    const LinkMask mask = links_->mask(v, inside);
    return mask == 0 || links_->at(v).state(mask).manifold;
  }
  /// 0 where no tet of omega_h is. @param costs  of the links, or null
  double cost(std::int64_t v, const IdSet& inside, const StarCostTable* costs) {
    if (costs && has_state(v)) {
      const LinkMask mask = links_->mask(v, inside);
      const LinkTopology& link = links_->at(v);
      return mask == 0 ? 0 : (*costs)(link.site, link.state(mask));
    }
    return is_manifold(v, inside) ? 0 : kCostOfNoManifold;
  }

 private:
  // As in a StarCostTable: worse than all the rings that a flip can spoil.
  static constexpr double kCostOfNoManifold = 1000;
  bool has_state(std::int64_t v) const { return links_ && !background_.on_boundary(v); }

  const BackgroundMesh& background_;
  const VertexLinks* links_;
  HalfBall half_ball_;
};

class Mending {
 public:
  Mending(const BackgroundMesh& background, const VertexLinks* links, ImplicitFunctionRef psi,
          const ClassificationParams& params, bool has_walls, IdSet& inside)
      : background_(background),
        psi_(psi),
        params_(params),
        costs_(links ? params.costs : nullptr),
        has_walls_(has_walls),
        inside_(inside),
        states_(background, links) {}

  ManifoldReport operator()(const std::vector<std::int64_t>& bad, const Context& context,
                            const std::function<void(std::int64_t)>& read);

 private:
  /// What has been done to a vertex. What is Removed stays outside.
  enum class Change : std::uint8_t { Flipped, Filled, Removed };

  const std::vector<std::int64_t>& link(std::int64_t v);
  double distance(std::int64_t v);
  double energy(std::int64_t v);
  double energy_around(std::int64_t v);
  double change_by_flip(std::int64_t v);
  std::int64_t best_flip(std::int64_t v);
  bool may_be_inside(std::int64_t v) const { return has_walls_ || !background_.on_boundary(v); }
  void flip(std::int64_t v, Change change);
  void toggle(std::int64_t v) { inside_.test(v) ? inside_.erase(v) : inside_.insert(v); }
  void look_at(std::int64_t v);
  void mend_one_way(std::int64_t v);

  const BackgroundMesh& background_;
  ImplicitFunctionRef psi_;
  const ClassificationParams& params_;
  const StarCostTable* costs_;
  const bool has_walls_;
  IdSet& inside_;
  BoundaryStates states_;
  std::set<std::int64_t> bad_;
  std::unordered_map<std::int64_t, Change> changed_;
  std::unordered_map<std::int64_t, bool> was_inside_;  ///< of the changed ones
  std::unordered_map<std::int64_t, std::vector<std::int64_t>> links_;
  std::unordered_map<std::int64_t, double> distances_;
  ManifoldReport report_;
};

const std::vector<std::int64_t>& Mending::link(std::int64_t v) {
  const auto [at, is_new] = links_.try_emplace(v);
  if (is_new) background_.link(v, at->second);
  return at->second;
}

/// To psi = 0, in h.
double Mending::distance(std::int64_t v) {
  const auto [at, is_new] = distances_.try_emplace(v, 0);
  if (is_new) {
    Vec3 g;
    const double value = psi_.value(background_.position(v), g);
    const double d = value / (g.norm() * background_.h(v));
    // Where psi has no gradient, or no value: far.
    at->second = std::isfinite(d) ? d : std::copysign(params_.reach_in + params_.reach_out + 1, value);
    ++report_.psi_evaluations;
  }
  return at->second;
}

/// What v adds to the energy of classify_vertices().
double Mending::energy(std::int64_t v) {
  const auto square = [](double d) { return d * d; };
  if (inside_.test(v)) return params_.inside_weight * square(std::max(0., distance(v) + params_.inside_depth));
  const std::vector<std::int64_t>& around = link(v);
  if (std::none_of(around.begin(), around.end(), [&](std::int64_t w) { return inside_.test(w); })) return 0;
  return states_.cost(v, inside_, costs_) + params_.outside_weight * square(distance(v) - params_.outside_height);
}

double Mending::energy_around(std::int64_t v) {
  double sum = energy(v);
  for (const std::int64_t w : link(v)) {
    if (!inside_.test(w)) sum += energy(w);  // that of an inside vertex does not depend on its link
  }
  return sum;
}

double Mending::change_by_flip(std::int64_t v) {
  const double before = energy_around(v);
  toggle(v);
  const double after = energy_around(v);
  toggle(v);
  return after - before;
}

/// The best flip at a bad vertex, or -1.
std::int64_t Mending::best_flip(std::int64_t v) {
  std::int64_t best = -1;
  double least = std::numeric_limits<double>::infinity();
  const auto consider = [&](std::int64_t w) {
    if (changed_.count(w) != 0) return;
    const double change = change_by_flip(w);
    if (change < least) least = change, best = w;
  };
  if (may_be_inside(v)) consider(v);
  for (const std::int64_t w : link(v)) {
    if (inside_.test(w)) consider(w);
  }
  return best;
}

void Mending::look_at(std::int64_t v) {
  if (!inside_.test(v) && !states_.is_manifold(v, inside_)) {
    bad_.insert(v);
  } else {
    bad_.erase(v);
  }
}

void Mending::flip(std::int64_t v, Change change) {
  was_inside_.try_emplace(v, inside_.test(v));
  toggle(v);
  changed_[v] = change;
  look_at(v);
  for (const std::int64_t w : link(v)) look_at(w);
}

void Mending::mend_one_way(std::int64_t v) {
  const auto before = changed_.find(v);
  const bool is_removed = before != changed_.end() && before->second == Change::Removed;
  if (!is_removed && may_be_inside(v)) {
    ++report_.n_one_way;
    flip(v, Change::Filled);
    return;
  }
  for (const std::int64_t w : link(v)) {
    if (!inside_.test(w)) continue;
    ++report_.n_one_way;
    flip(w, Change::Removed);
  }
}

ManifoldReport Mending::operator()(const std::vector<std::int64_t>& bad, const Context& context,
                                   const std::function<void(std::int64_t)>& read) {
  bad_.insert(bad.begin(), bad.end());
  report_.n_bad = bad_.size();
  while (!bad_.empty()) {
    context.poll();
    const std::int64_t v = *bad_.begin();
    if (read) read(v);
    if (const std::int64_t best = best_flip(v); best >= 0) {
      flip(best, Change::Flipped);
    } else {
      mend_one_way(v);
    }
  }
  for (const auto& [v, was_inside] : was_inside_) {
    if (inside_.test(v) == was_inside) continue;
    report_.flips.push_back({v, background_.position(v), !was_inside, distance(v) * background_.h(v)});
  }
  std::sort(report_.flips.begin(), report_.flips.end(),
            [](const ManifoldFlip& a, const ManifoldFlip& b) { return a.background_vertex < b.background_vertex; });
  return std::move(report_);
}

}  // namespace

std::vector<std::int64_t> vertices_not_manifold(const BackgroundMesh& background, const VertexLinks* links,
                                                const IdSet& inside) {
  IdSet seen(background.n_vertices());
  BoundaryStates states(background, links);
  std::vector<std::int64_t> link, bad;
  inside.for_each([&](std::int64_t v) {
    link.clear();
    background.link(v, link);
    for (const std::int64_t w : link) {
      if (inside.test(w) || seen.test(w)) continue;
      seen.insert(w);
      if (!states.is_manifold(w, inside)) bad.push_back(w);
    }
  });
  std::sort(bad.begin(), bad.end());
  return bad;
}

ManifoldReport make_manifold(const BackgroundMesh& background, const VertexLinks* links, ImplicitFunctionRef psi,
                             const ClassificationParams& params, bool has_walls, const std::vector<std::int64_t>& bad,
                             IdSet& inside, const Context& context,
                             const std::function<void(std::int64_t)>& read) {
  if (bad.empty()) return {};
  return Mending(background, links, psi, params, has_walls, inside)(bad, context, read);
}

}  // namespace umtet
