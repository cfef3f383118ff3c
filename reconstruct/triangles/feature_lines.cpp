#include "reconstruct/triangles/feature_lines.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include "common/formatted.h"
#include "reconstruct/triangles/face_patches.h"
#include "reconstruct/triangles/triangle_tree.h"

namespace umtet {
namespace {

// Of the diagonal: STL files store coordinates with 24 bits.
constexpr double kOfDiagonal = 1e-6;
// Of a coordinate: half of a unit in the last of six digits, the default of C++ streams and of OpenFOAM.
constexpr double kOfCoordinate = 5e-6;
// Triangles around vertices that are looked at in total; they take a second.
constexpr std::size_t kMostTries = 10'000'000;

double distance_from_segment(const Vec3& x, const Vec3& a, const Vec3& b) {
  const Vec3 d = b - a;
  const double t = d.squaredNorm() > 0 ? std::clamp((x - a).dot(d) / d.squaredNorm(), 0., 1.) : 0;
  return (x - a - t * d).norm();
}

/// The points within a tolerance of a place.
class Places {
 public:
  Places(const std::vector<Vec3>& points, double tolerance) : points_(points), tolerance_(tolerance) {}
  void add(int point) { cells_[key_of(points_[point], {0, 0, 0})].push_back(point); }
  /// The nearest within the tolerance, or -1.
  int nearest(const Vec3& x) const {
    int best = -1;
    double least = tolerance_;
    for (int i = -1; i <= 1; ++i)
      for (int j = -1; j <= 1; ++j)
        for (int k = -1; k <= 1; ++k) {
          const auto at = cells_.find(key_of(x, {i, j, k}));
          if (at == cells_.end()) continue;
          for (const int p : at->second) {
            const double d = (points_[p] - x).norm();
            if (d > least || (d == least && best >= 0)) continue;
            least = d;
            best = p;
          }
        }
    return best;
  }

 private:
  using Key = std::array<double, 3>;
  Key key_of(const Vec3& x, const std::array<int, 3>& step) const {
    Key key;
    for (int a = 0; a < 3; ++a) key[a] = std::floor(x[a] / tolerance_) + step[a];
    return key;
  }
  const std::vector<Vec3>& points_;
  const double tolerance_;
  std::map<Key, std::vector<int>> cells_;
};

class Follower {
 public:
  Follower(const TriangleMesh& mesh, const FeatureLines& lines)
      : mesh_(mesh), lines_(lines), tolerance_(tolerance_of(mesh)), first_(welded(mesh.V, tolerance_)) {
    list_sides();
    match_points();
    list_segments();
  }

  FollowedLines operator()() {
    for (const auto& [point, others] : others_) {
      const bool is_vertex = vertex_[point] >= 0;
      if (!is_vertex && others.size() != 2) leave_out(point, fault_at(point));
      if (!is_vertex) continue;
      for (const int next : others) follow(point, next);
    }
    for (const auto& [a, b] : unused_) leave_out(a, fault_at(a));  // closed, and without a vertex
    for (const std::pair<int, int>& edge : found_) {
      for (const auto& [a, b] : sides_.at(edge)) made_.lines.push_back({a, b});
      ++made_.n_edges;
    }
    return std::move(made_);
  }

 private:
  static double tolerance_of(const TriangleMesh& mesh) {
    double farthest = 0;
    for (const Triangle& f : mesh.F)
      for (const int v : f) farthest = std::max(farthest, mesh.V[v].cwiseAbs().maxCoeff());
    return std::max(kOfDiagonal * diagonal_of(mesh) + kOfCoordinate * farthest, std::numeric_limits<double>::min());
  }
  static std::pair<int, int> pair_of(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

  void list_sides() {
    around_.resize(mesh_.V.size());
    for (const Triangle& f : mesh_.F) {
      for (int k = 0; k < 3; ++k) {
        const int a = f[k], b = f[(k + 1) % 3], v = first_[a], w = first_[b];
        if (v == w) continue;
        sides_[pair_of(v, w)].insert(pair_of(a, b));
        around_[v].push_back(w);
        around_[w].push_back(v);
      }
    }
    for (std::vector<int>& list : around_) {
      std::sort(list.begin(), list.end());
      list.erase(std::unique(list.begin(), list.end()), list.end());
    }
  }

  /// Points at one vertex or at one place become one.
  void match_points() {
    Places vertices(mesh_.V, tolerance_), others(lines_.points, tolerance_);
    for (std::size_t v = 0; v < mesh_.V.size(); ++v)
      if (first_[v] == static_cast<int>(v) && !around_[v].empty()) vertices.add(static_cast<int>(v));
    std::map<int, int> point_of;  // by vertex
    vertex_.assign(lines_.points.size(), -1);
    same_.resize(lines_.points.size());
    for (int p = 0; p < static_cast<int>(lines_.points.size()); ++p) {
      vertex_[p] = vertices.nearest(lines_.points[p]);
      if (vertex_[p] >= 0) {
        same_[p] = point_of.try_emplace(vertex_[p], p).first->second;
        continue;
      }
      const int known = others.nearest(lines_.points[p]);
      same_[p] = known >= 0 ? known : p;
      if (known < 0) others.add(p);
    }
  }

  void list_segments() {
    for (const auto& [p, q] : lines_.segments) {
      const int a = same_[p], b = same_[q];
      if (a == b || !unused_.insert(pair_of(a, b)).second) continue;
      others_[a].push_back(b);
      others_[b].push_back(a);
    }
  }

  Vec3 place(int point) const { return vertex_[point] >= 0 ? mesh_.V[vertex_[point]] : lines_.points[point]; }

  /// Follows the polyline from a vertex to the next one.
  void follow(int from, int next) {
    if (!unused_.contains(pair_of(from, next))) return;
    std::vector<int> chain{from};
    for (int at = next;;) {
      unused_.erase(pair_of(chain.back(), at));
      chain.push_back(at);
      if (vertex_[at] >= 0) break;
      const std::vector<int>& others = others_.at(at);
      if (others.size() != 2) return;  // the fault is reported at this point
      at = others[0] == chain[chain.size() - 2] ? others[1] : others[0];
      if (!unused_.contains(pair_of(chain.back(), at))) return;
    }
    const int v = vertex_[chain.front()], w = vertex_[chain.back()];
    if (chain.size() == 2 && sides_.contains(pair_of(v, w))) {
      found_.insert(pair_of(v, w));
      return;
    }
    follow_chain(chain);
  }

  void follow_chain(const std::vector<int>& chain) {
    std::vector<Vec3> x;
    std::vector<double> arc{0};
    for (const int p : chain) {
      x.push_back(place(p));
      if (x.size() > 1) arc.push_back(arc.back() + (x.back() - x[x.size() - 2]).norm());
    }
    int at = vertex_[chain.front()];
    const int end = vertex_[chain.back()];
    std::vector<std::pair<int, int>> edges;
    std::size_t k = 0;  // x[k] is the last point that has been passed
    for (double s = 0; edges.empty() || at != end;) {
      const std::optional<Step> step =
          edges.empty() || s < arc.back() ? next_step(at, x, arc, k, s) : std::optional<Step>();
      if (!step) {
        const auto far = std::find_if(chain.begin(), chain.end(), [&](int p) { return is_far(p); });
        if (far != chain.end()) return leave_out(*far, fault_at(*far));
        return leave_out(chain[k], stuck_at(x[k], mesh_.V[at], chain[k]));
      }
      edges.push_back(pair_of(at, step->vertex));
      at = step->vertex;
      s = step->arc;
      k = step->passed;
    }
    found_.insert(edges.begin(), edges.end());
  }

  struct Step {
    int vertex;
    double arc;
    std::size_t passed;
  };
  /// The edge from a vertex that runs along the polyline from arc length s on, where points up to k have been passed.
  std::optional<Step> next_step(int at, const std::vector<Vec3>& x, const std::vector<double>& arc, std::size_t k,
                                double s) {
    for (const int w : around_[at]) {
      if (++n_tries_ > kMostTries) return std::nullopt;
      const Vec3 &a = mesh_.V[at], &b = mesh_.V[w];
      const double to = std::min(s + (b - a).norm(), arc.back());
      const auto above = std::upper_bound(arc.begin() + static_cast<std::ptrdiff_t>(k), arc.end(), to);
      const auto i = static_cast<std::size_t>(std::min(above, arc.end() - 1) - arc.begin());  // to is before x[i]
      const double length = arc[i] - arc[i - 1];
      const Vec3 y = x[i - 1] + (length > 0 ? (to - arc[i - 1]) / length : 0) * (x[i] - x[i - 1]);
      if ((y - b).norm() > kArc * tolerance_) continue;
      bool is_along = true;
      for (std::size_t j = k + 1; j < i && is_along; ++j) is_along = distance_from_segment(x[j], a, b) <= tolerance_;
      if (is_along) return Step{w, to, above == arc.end() ? arc.size() - 1 : i - 1};
    }
    return std::nullopt;
  }

  void leave_out(int point, std::string what) {
    ++made_.n_faults;
    if (!made_.fault || point < made_.fault->point) made_.fault = LineFault{point, std::move(what)};
  }

  double distance(const Vec3& x) {
    if (!tree_) tree_.emplace(mesh_);
    return tree_->nearest(x).distance;
  }
  bool is_far(int point) { return vertex_[point] < 0 && distance(lines_.points[point]) > tolerance_; }

  std::string fault_at(int point) {
    if (made_.fault && made_.fault->point <= point) return {};
    const Vec3& x = lines_.points[point];
    const double off = distance(x);
    const std::string is = formatted("the point %.9g %.9g %.9g is ", x[0], x[1], x[2]);
    if (off > tolerance_)
      return is + formatted("%.3g from the triangles, more than %.2g; give lines along edges of the triangles", off,
                            tolerance_);
    const auto found = others_.find(point);
    const std::size_t n = found == others_.end() ? 0 : found->second.size();
    return is + formatted("on the triangles, but at none of their corners: %s; give lines along edges of the triangles",
                          n > 2    ? "lines cross there"
                          : n == 1 ? "a line ends there"
                                   : "a closed line has no corner");
  }

  std::string stuck_at(const Vec3& passed, const Vec3& corner, int point) const {
    if (made_.fault && made_.fault->point <= point) return {};
    const Vec3& x = (passed - corner).norm() > tolerance_ ? corner : passed;
    return formatted(
        "no edge of the triangles runs along the line from %.9g %.9g %.9g on; give lines along edges of "
        "the triangles",
        x[0], x[1], x[2]);
  }

  // Arc lengths of a polyline and of a chain within the tolerance of it may differ by more than the tolerance.
  static constexpr double kArc = 4;

  const TriangleMesh& mesh_;
  const FeatureLines& lines_;
  const double tolerance_;
  std::vector<int> first_;                                              ///< per vertex: the one that it is welded to
  std::map<std::pair<int, int>, std::set<std::pair<int, int>>> sides_;  ///< by welded vertices
  std::vector<std::vector<int>> around_;                                ///< neighbours of welded vertices
  std::vector<int> vertex_;                                             ///< per point: welded vertex there, or -1
  std::vector<int> same_;                                               ///< per point: the first at this place
  std::map<int, std::vector<int>> others_;                              ///< per point: the other ends of its segments
  std::set<std::pair<int, int>> unused_, found_;                        ///< segments; edges
  std::optional<TriangleTree> tree_;
  std::size_t n_tries_ = 0;
  FollowedLines made_;
};

}  // namespace

FollowedLines follow_lines(const TriangleMesh& mesh, const FeatureLines& lines) {
  if (lines.segments.empty() || mesh.F.empty()) return {};
  return Follower(mesh, lines)();
}

std::vector<std::array<int, 2>> renumbered_lines(const std::vector<std::array<int, 2>>& lines,
                                                 const std::vector<int>& number) {
  std::vector<std::array<int, 2>> left;
  for (const auto& [a, b] : lines)
    if (number[a] >= 0 && number[b] >= 0) left.push_back({number[a], number[b]});
  return left;
}

}  // namespace umtet
