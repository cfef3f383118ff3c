#include "mesh/features/detail/rerouted_paths.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <queue>
#include <span>
#include <tuple>
#include <utility>

#include "mesh/features/feature_embedding.h"

namespace umtet::detail {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kReach = 4;        // in h: with 2.5 one wedge of 30 degrees in ten gets no path
constexpr double kCornerReach = 3;  // in h
// Added to the distance, in h, of a vertex that lies at a patch on which the curve or corner is not: the other side of
// a thin wall may be nearer than its own.
constexpr double kForeign = 2;
constexpr double kLengthWeight = .15;  // of a length in h, beside a squared distance in h
constexpr double kWedgeWeight = 8;     // of the squared lack of quality
constexpr double kGoodWedge = .95;
constexpr int kLongestShortcut = 5;  // edges of a path that one edge may replace
constexpr double kPrice = 1;         // of a vertex of another path, the first time
constexpr int kMostTurns = 12;       // times that a path is laid
constexpr int kParts = 3;            // of a closed curve

class Router {
 public:
  Router(const PiecewiseDomain& domain, const FeatureGraph& graph, const BoundaryGraph& boundary,
         const std::vector<Vec3>& V, const std::vector<double>& h)
      : domain_(domain),
        graph_(graph),
        V_(V),
        h_(h),
        boundary_(boundary),
        owner_(V.size(), kFree),
        fights_(V.size(), 0),
        patch_(V.size(), kUnasked),
        places_(V.size()) {}

  ReroutedPaths operator()(const Context& context) {
    made_.chains.resize(graph_.curves.size());
    place_corners();
    std::vector<int> order(graph_.curves.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(),
                     [&](int a, int b) { return graph_.curves[a].length() < graph_.curves[b].length(); });
    // A path may take a vertex from another one, at a price that rises each time; the other one is then laid again.
    std::deque<int> waiting(order.begin(), order.end());
    std::vector<int> n_laid(graph_.curves.size(), 0);
    while (!waiting.empty()) {
      context.poll();
      const int c = waiting.front();
      waiting.pop_front();
      release(c);
      if (n_laid[c]++ == kMostTurns) continue;
      evicted_.clear();
      if (!(graph_.curves[c].is_closed() ? close_path(c) : join_corners(c))) release(c);
      for (const int other : evicted_)
        if (std::find(waiting.begin(), waiting.end(), other) == waiting.end()) waiting.push_back(other);
    }
    for (std::size_t c = 0; c < made_.chains.size(); ++c) {
      if (!made_.chains[c].empty()) continue;
      const FeatureCurve& curve = graph_.curves[c];
      made_.defects.push_back({FeatureDefect::Kind::NoPath, static_cast<int>(c), -1, curve.at(curve.length() / 2)});
    }
    return std::move(made_);
  }

 private:
  static constexpr int kFree = -1, kCorner = -2, kUnasked = -1;

  /// kForeign where the patch that decides psi at a vertex is none of these, else 0.
  double foreign(int v, std::span<const int> patches) {
    if (patch_[v] == kUnasked) patch_[v] = domain_.active(V_[v]);
    return std::find(patches.begin(), patches.end(), patch_[v]) == patches.end() ? kForeign : 0;
  }

  void place_corners() {
    std::vector<std::tuple<double, int, int>> pairs;
    for (std::size_t c = 0; c < graph_.corners.size(); ++c)
      for (const int v : boundary_.vertices) {
        const double d = (V_[v] - graph_.corners[c].place).norm();
        if (d < kCornerReach * h_[v])
          pairs.emplace_back(d / h_[v] + foreign(v, graph_.corners[c].patches), static_cast<int>(c), v);
      }
    std::sort(pairs.begin(), pairs.end());
    made_.corner_vertex.assign(graph_.corners.size(), -1);
    for (const auto& [d, c, v] : pairs) {
      if (made_.corner_vertex[c] >= 0 || owner_[v] != kFree) continue;
      made_.corner_vertex[c] = v;
      owner_[v] = kCorner;
    }
    for (std::size_t c = 0; c < graph_.corners.size(); ++c)
      if (made_.corner_vertex[c] < 0)
        made_.defects.push_back({FeatureDefect::Kind::NoCorner, -1, static_cast<int>(c), graph_.corners[c].place});
  }

  /// Nearest places on a curve for all boundary vertices within reach.
  void measure(int curve) {
    const FeatureCurve& c = graph_.curves[curve];
    Eigen::AlignedBox3d box;
    for (const Vec3& x : c.points) box.extend(x);
    for (const int v : boundary_.vertices) {
      places_[v] = {kInfinity, 0};
      if (box.squaredExteriorDistance(V_[v]) > kReach * kReach * h_[v] * h_[v]) continue;
      places_[v] = c.nearest(V_[v]);
      double& distance = places_[v].distance;
      distance = distance > kReach * h_[v] ? kInfinity : distance + h_[v] * foreign(v, c.patches);
    }
  }

  double cost(const FeatureCurve& curve, int a, const BoundaryGraph::Arc& arc) const {
    const double h = (h_[a] + h_[arc.to]) / 2, da = places_[a].distance / h, db = places_[arc.to].distance / h;
    const double angle = curve.angle_deg_at((places_[a].arc + places_[arc.to].arc) / 2);
    const double lack = std::max(0., kGoodWedge - best_wedge_quality(angle, arc.n_tets));
    return (da * da + db * db) / 2 + kLengthWeight * (V_[a] - V_[arc.to]).norm() / h + kWedgeWeight * lack * lack;
  }

  /// The path of least cost over free vertices, or an empty one.
  template <class MayUse>
  std::vector<int> shortest_path(int own, int from, int to, const MayUse& may_use) const {
    const FeatureCurve& curve = graph_.curves[own];
    std::map<int, std::pair<double, int>> best;  // cost, vertex before
    std::priority_queue<std::pair<double, int>, std::vector<std::pair<double, int>>, std::greater<>> queue;
    best[from] = {0, -1};
    queue.emplace(0, from);
    while (!queue.empty()) {
      const auto [d, v] = queue.top();
      queue.pop();
      if (d > best[v].first) continue;
      if (v == to) break;
      for (const BoundaryGraph::Arc& arc : boundary_.arcs[v]) {
        if (arc.to != to && (owner_[arc.to] == kCorner || owner_[arc.to] == own || !may_use(arc.to))) continue;
        if (!(places_[arc.to].distance < kInfinity)) continue;
        const bool is_taken = arc.to != to && owner_[arc.to] != kFree;
        const double price = kPrice * (is_taken ? 1 + fights_[arc.to] : .25 * fights_[arc.to]);
        const double there = d + cost(curve, v, arc) + price;
        const auto [at, is_new] = best.try_emplace(arc.to, there, v);
        if (!is_new && at->second.first <= there) continue;
        at->second = {there, v};
        queue.emplace(there, arc.to);
      }
    }
    std::vector<int> path;
    if (!best.contains(to)) return path;
    for (int v = to; v >= 0; v = best[v].second) path.push_back(v);
    std::reverse(path.begin(), path.end());
    return path;
  }

  bool join_corners(int c) {
    const FeatureCurve& curve = graph_.curves[c];
    const int from = made_.corner_vertex[curve.ends[0]], to = made_.corner_vertex[curve.ends[1]];
    if (from < 0 || to < 0 || from == to) return false;
    measure(c);
    std::vector<int> path = shortest_path(c, from, to, [](int) { return true; });
    if (path.size() < 2) return false;
    take_shortcuts(path);
    for (std::size_t k = 1; k + 1 < path.size(); ++k) take(path[k], c);
    made_.chains[c] = std::move(path);
    return true;
  }

  bool close_path(int c) {
    const FeatureCurve& curve = graph_.curves[c];
    const double length = curve.length();
    measure(c);
    const auto offset = [&](int v, double from) {
      const double s = std::fmod(places_[v].arc - from + 2 * length, length);
      return s;  // in [0, length)
    };
    const auto nearest = [&](double centre, double window) {
      int best = -1;
      for (const int v : boundary_.vertices) {
        if (owner_[v] != kFree || !(places_[v].distance < kInfinity)) continue;
        const double s = offset(v, centre);
        if (std::min(s, length - s) > window) continue;
        if (best < 0 || places_[v].distance < places_[best].distance) best = v;
      }
      return best;
    };
    std::array<int, kParts> anchor;
    anchor[0] = nearest(0, length);
    if (anchor[0] < 0) return false;
    const double start = places_[anchor[0]].arc;
    for (int k = 1; k < kParts; ++k) {
      anchor[k] = nearest(std::fmod(start + k * length / kParts, length), length / (4 * kParts));
      if (anchor[k] < 0 || anchor[k] == anchor[k - 1] || anchor[k] == anchor[0]) return false;
    }
    std::vector<int> loop = {anchor[0]};
    for (const int v : anchor) owner_[v] = c;
    for (int k = 0; k < kParts; ++k) {
      const int to = anchor[(k + 1) % kParts];
      const double begin = offset(anchor[k], start), end = k + 1 < kParts ? offset(to, start) : length;
      const double slack = length / (4 * kParts);
      const std::vector<int> path = shortest_path(c, anchor[k], to, [&](int v) {
        const double s = offset(v, start);
        return (s > begin - slack && s < end + slack) || s - length > begin - slack || s + length < end + slack;
      });
      if (path.size() < 2) return false;
      for (std::size_t i = 1; i < path.size(); ++i) {
        take(path[i], c);
        loop.push_back(path[i]);
      }
    }
    // Shortcuts from two starts, so that the first vertex may be passed, too.
    loop.pop_back();
    for (int turn = 0; turn < 2; ++turn) {
      std::rotate(loop.begin(), loop.begin() + static_cast<std::ptrdiff_t>(loop.size() / 2), loop.end());
      for (const int v : loop) owner_[v] = kFree;
      take_shortcuts(loop);
      for (const int v : loop) owner_[v] = c;
    }
    if (loop.size() < 4) return false;
    // Along the curve, from its first point on.
    const auto first =
        std::min_element(loop.begin(), loop.end(), [&](int a, int b) { return places_[a].arc < places_[b].arc; });
    std::rotate(loop.begin(), first, loop.end());
    loop.push_back(loop.front());
    made_.chains[c] = std::move(loop);
    return true;
  }

  /// Replaces parts of a path by a single edge.
  void take_shortcuts(std::vector<int>& path) const {
    for (std::size_t i = 0; i + 2 < path.size(); ++i) {
      for (std::size_t j = std::min(path.size() - 1, i + kLongestShortcut); j > i + 1; --j) {
        if (!boundary_.has_edge(path[i], path[j])) continue;
        path.erase(path.begin() + static_cast<std::ptrdiff_t>(i) + 1, path.begin() + static_cast<std::ptrdiff_t>(j));
        break;
      }
    }
  }

  /// A path takes a vertex, from another path if need be.
  void take(int v, int c) {
    const int before = owner_[v];
    if (before >= 0 && before != c) {
      ++fights_[v];
      evicted_.push_back(before);
      release(before);
    }
    owner_[v] = c;
  }

  void release(int c) {
    made_.chains[c].clear();
    for (int& o : owner_)
      if (o == c) o = kFree;
  }

  const PiecewiseDomain& domain_;
  const FeatureGraph& graph_;
  const std::vector<Vec3>& V_;
  const std::vector<double>& h_;  ///< edge length at each vertex
  const BoundaryGraph& boundary_;
  std::vector<int> owner_;    ///< per vertex: its curve, kCorner or kFree
  std::vector<int> fights_;   ///< per vertex: how often a path has lost it to another
  std::vector<int> patch_;    ///< per vertex: the patch that decides psi there, or kUnasked
  std::vector<int> evicted_;  ///< the paths that lost vertices to the last one
  std::vector<FeatureCurve::Place> places_;
  ReroutedPaths made_;
};

}  // namespace

ReroutedPaths lay_paths(const PiecewiseDomain& domain, const FeatureGraph& graph, const BoundaryGraph& boundary,
                        const std::vector<Vec3>& V, const std::vector<double>& h, const Context& context) {
  return Router(domain, graph, boundary, V, h)(context);
}

}  // namespace umtet::detail
