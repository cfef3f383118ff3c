#include "mesh/features/feature_embedding.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <deque>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <numeric>
#include <queue>
#include <span>
#include <tuple>
#include <utility>

namespace umtet {
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
constexpr double kLeastGap = .5;     // of the mean: two vertices of a path are not nearer than this along the curve
constexpr int kLongestShortcut = 5;  // edges of a path that one edge may replace
constexpr int kVoteSteps = 3;        // of Newton's method from the centroid of a face to psi = 0
constexpr double kClearVote = .9;    // of the area beside a curve that is missing: else the patch is unknown
constexpr double kPrice = 1;         // of a vertex of another path, the first time
constexpr int kMostTurns = 12;       // times that a path is laid
constexpr int kParts = 3;            // of a closed curve

using Edge = std::pair<int, int>;
Edge edge_of(int a, int b) { return {std::min(a, b), std::max(a, b)}; }

/// The boundary as a graph of its vertices.
struct BoundaryGraph {
  struct Arc {
    int to, n_tets;
  };
  std::vector<int> vertices;           ///< ascending
  std::vector<std::vector<Arc>> arcs;  ///< per vertex of the mesh
  std::map<Edge, std::array<int, 2>> faces;

  BoundaryGraph(std::size_t n_vertices, const std::vector<Tet>& C, const std::vector<Triangle>& list)
      : arcs(n_vertices) {
    for (std::size_t f = 0; f < list.size(); ++f) {
      for (int k = 0; k < 3; ++k) {
        const auto [at, is_new] =
            faces.try_emplace(edge_of(list[f][k], list[f][(k + 1) % 3]), std::array{static_cast<int>(f), -1});
        if (!is_new) at->second[1] = static_cast<int>(f);
      }
    }
    std::vector<std::uint8_t> on_boundary(n_vertices, 0);
    for (const Triangle& f : list)
      for (const int v : f) on_boundary[v] = 1;
    for (std::size_t v = 0; v < n_vertices; ++v)
      if (on_boundary[v]) vertices.push_back(static_cast<int>(v));
    std::map<Edge, int> n_tets;
    for (const Tet& t : C)
      for (int i = 0; i < 4; ++i)
        for (int j = i + 1; j < 4; ++j)
          if (on_boundary[t[i]] && on_boundary[t[j]]) ++n_tets[edge_of(t[i], t[j])];
    for (const auto& [edge, f] : faces) {
      const int n = n_tets[edge];
      arcs[edge.first].push_back({edge.second, n});
      arcs[edge.second].push_back({edge.first, n});
    }
  }
  bool has_edge(int a, int b) const {
    return std::any_of(arcs[a].begin(), arcs[a].end(), [&](const Arc& arc) { return arc.to == b; });
  }
};

class Embedder {
 public:
  Embedder(const PiecewiseDomain& domain, const FeatureGraph& graph, const std::vector<Vec3>& V,
           const std::vector<Tet>& C, const std::vector<Triangle>& faces, const std::vector<double>& h)
      : domain_(domain),
        graph_(graph),
        V_(V),
        faces_(faces),
        h_(h),
        boundary_(V.size(), C, faces),
        owner_(V.size(), kFree),
        fights_(V.size(), 0),
        patch_(V.size(), kUnasked),
        places_(V.size()) {}

  FeatureEmbedding operator()(const Context& context) {
    made_.chains.resize(graph_.curves.size());
    made_.chain_arc.resize(graph_.curves.size());
    place_corners();
    std::vector<double> h_of_corner;
    for (const int v : made_.corner_vertex)
      h_of_corner.push_back(v < 0 ? *std::min_element(h_.begin(), h_.end()) : h_[v]);
    made_.strata = strata_of(domain_, graph_, h_of_corner);
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
    votes_.resize(faces_.size());
    for (std::size_t f = 0; f < faces_.size(); ++f) votes_[f] = vote(faces_[f]);
    while (!assign_patches()) {
    }
    set_strata();
    for (std::size_t c = 0; c < graph_.curves.size(); ++c) spread(static_cast<int>(c));
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

  /// The patch at which psi = 0 is met from the centroid of a face.
  int vote(const Triangle& f) const {
    Vec3 x = (V_[f[0]] + V_[f[1]] + V_[f[2]]) / 3;
    const double h = h_[f[0]];
    for (int k = 0; k < kVoteSteps; ++k) {
      Vec3 g;
      const double psi = domain_.evaluate(x, &g, nullptr);
      const double g2 = g.squaredNorm();
      if (!(g2 > 0)) break;
      Vec3 step = psi / g2 * g;
      if (step.norm() > h) step *= h / step.norm();
      x -= step;
    }
    return domain_.active(x);
  }

  /// Fills the faces between paths. Returns false if a path had to be left out.
  bool assign_patches() {
    std::map<Edge, int> curve_of;
    for (std::size_t c = 0; c < made_.chains.size(); ++c)
      for (std::size_t k = 0; k + 1 < made_.chains[c].size(); ++k)
        curve_of[edge_of(made_.chains[c][k], made_.chains[c][k + 1])] = static_cast<int>(c);
    const bool is_complete =
        std::none_of(made_.chains.begin(), made_.chains.end(), [](const auto& c) { return c.empty(); });
    made_.face_patch.assign(faces_.size(), -2);
    for (std::size_t first = 0; first < faces_.size(); ++first) {
      if (made_.face_patch[first] != -2) continue;
      std::vector<int> part = {static_cast<int>(first)};
      made_.face_patch[first] = -1;
      std::vector<std::uint8_t> may_be(static_cast<std::size_t>(domain_.n_patches()), 1);
      for (std::size_t k = 0; k < part.size(); ++k) {
        const Triangle& f = faces_[part[k]];
        for (int i = 0; i < 3; ++i) {
          const Edge e = edge_of(f[i], f[(i + 1) % 3]);
          if (const auto at = curve_of.find(e); at != curve_of.end()) {
            for (int p = 0; p < domain_.n_patches(); ++p) {
              const auto& pair = graph_.curves[at->second].patches;
              if (p != pair[0] && p != pair[1]) may_be[p] = 0;
            }
            continue;
          }
          for (const int g : boundary_.faces.at(e)) {
            if (g < 0 || made_.face_patch[g] != -2) continue;
            made_.face_patch[g] = -1;
            part.push_back(g);
          }
        }
      }
      std::vector<std::size_t> votes(may_be.size(), 0);
      for (const int f : part) ++votes[votes_[f]];
      int best = -1;
      std::size_t n_all = 0;
      for (std::size_t p = 0; p < votes.size(); ++p) {
        n_all += votes[p];
        if (may_be[p] && (best < 0 || votes[p] > votes[best])) best = static_cast<int>(p);
      }
      const bool is_clear =
          best >= 0 && (is_complete || static_cast<double>(votes[best]) >= kClearVote * static_cast<double>(n_all));
      for (const int f : part) made_.face_patch[f] = is_clear ? best : -1;
    }
    // Both sides of every path.
    std::vector<int> wrong;
    for (const auto& [edge, c] : curve_of) {
      const auto& f = boundary_.faces.at(edge);
      std::array<int, 2> sides = {made_.face_patch[f[0]], made_.face_patch[f[1]]};
      std::sort(sides.begin(), sides.end());
      if (sides == graph_.curves[c].patches) continue;
      // A side without a patch is no fault of this curve, if the other side is right.
      const bool may_stay = !is_complete && sides[0] == -1 &&
                            (sides[1] == graph_.curves[c].patches[0] || sides[1] == graph_.curves[c].patches[1]);
      if (!may_stay && std::find(wrong.begin(), wrong.end(), c) == wrong.end()) wrong.push_back(c);
    }
    if (wrong.empty()) return true;
    for (const int c : wrong) {
      made_.defects.push_back(
          {FeatureDefect::Kind::WrongPatch, c, -1, graph_.curves[c].at(graph_.curves[c].length() / 2)});
      release(c);
    }
    return false;
  }

  void set_strata() {
    const int whole = FeatureEmbedding::whole(domain_);
    made_.stratum.assign(V_.size(), -1);
    for (std::size_t f = 0; f < faces_.size(); ++f)
      for (const int v : faces_[f]) {
        const int patch = made_.face_patch[f] < 0 ? whole : made_.face_patch[f];
        if (made_.stratum[v] != whole) made_.stratum[v] = patch;
      }
    for (std::size_t c = 0; c < made_.chains.size(); ++c)
      for (const int v : made_.chains[c]) made_.stratum[v] = whole + 1 + static_cast<int>(c);
    const int first_corner = whole + 1 + static_cast<int>(graph_.curves.size());
    for (std::size_t c = 0; c < graph_.corners.size(); ++c) {
      const int v = made_.corner_vertex[c];
      if (v < 0) continue;
      const bool has_curve = made_.stratum[v] > whole;
      if (has_curve) made_.stratum[v] = first_corner + static_cast<int>(c);
      if (!has_curve) made_.corner_vertex[c] = -1;
    }
  }

  /// Arc lengths of a chain: those of the nearest points, made monotone, with a least gap.
  void spread(int c) {
    const std::vector<int>& chain = made_.chains[c];
    if (chain.empty()) return;
    const FeatureCurve& curve = graph_.curves[c];
    const double length = curve.length();
    const auto n = static_cast<int>(chain.size());
    std::vector<double> s(chain.size());
    for (int k = 0; k < n; ++k) s[k] = curve.nearest(V_[chain[k]]).arc;
    if (curve.is_closed()) {
      // Unrolled: the direction of the loop may be either.
      double turned = 0;
      std::vector<double> unrolled = s;
      for (int k = 1; k < n; ++k) {
        double d = s[k] - s[k - 1];
        if (d > length / 2) d -= length;
        if (d < -length / 2) d += length;
        turned += d;
        unrolled[k] = unrolled[k - 1] + d;
      }
      s = unrolled;
      if (turned < 0) {
        for (double& x : s) x = -x;
      }
      s[n - 1] = s[0] + length;
      const double gap = kLeastGap * length / (n - 1);
      for (int k = 1; k < n; ++k) s[k] = std::max(s[k], s[k - 1] + gap);
      s[n - 1] = s[0] + length;
      for (int k = n - 2; k > 0; --k) s[k] = std::min(s[k], s[k + 1] - gap);
      for (double& x : s) {
        if (turned < 0) x = -x;
        x = std::fmod(x + 4 * length, length);
      }
    } else {
      const double gap = kLeastGap * length / (n - 1);
      s[0] = 0;
      s[n - 1] = length;
      for (int k = 1; k < n; ++k) s[k] = std::max(s[k], s[k - 1] + gap);
      s[n - 1] = length;
      for (int k = n - 2; k > 0; --k) s[k] = std::min(s[k], s[k + 1] - gap);
    }
    made_.chain_arc[c] = std::move(s);
  }

  const PiecewiseDomain& domain_;
  const FeatureGraph& graph_;
  const std::vector<Vec3>& V_;
  const std::vector<Triangle>& faces_;
  const std::vector<double>& h_;  ///< edge length at each vertex
  const BoundaryGraph boundary_;
  std::vector<int> owner_;    ///< per vertex: its curve, kCorner or kFree
  std::vector<int> fights_;   ///< per vertex: how often a path has lost it to another
  std::vector<int> evicted_;  ///< the paths that lost vertices to the last one
  std::vector<int> patch_;    ///< per vertex: the patch that decides psi there, or kUnasked
  std::vector<FeatureCurve::Place> places_;
  std::vector<int> votes_;  ///< per face
  FeatureEmbedding made_;
};

}  // namespace

double best_wedge_quality(double angle_deg, int k) {
  const double a = angle_deg / k * std::numbers::pi / 180;
  if (!(a < std::numbers::pi)) return 0;
  const double q = std::sin(a) / (std::numbers::sqrt2 * (6 - 2 * std::cos(a)));
  return 4 * std::cbrt(q * q);
}

std::vector<Stratum> strata_of(const PiecewiseDomain& domain, const FeatureGraph& graph,
                               const std::vector<double>& h_of_corner) {
  std::vector<Stratum> strata;
  strata.reserve(static_cast<std::size_t>(domain.n_patches()) + 1 + graph.curves.size() + graph.corners.size());
  for (int p = 0; p < domain.n_patches(); ++p) strata.push_back({.dimension = 2, .patches = {p}, .ends = {}});
  strata.push_back({.dimension = 2, .patches = {}, .ends = {}});
  for (const FeatureCurve& c : graph.curves) {
    Stratum s{.dimension = 1, .patches = {c.patches[0], c.patches[1]}, .ends = {}};
    if (c.patches[0] == c.patches[1]) s.patches.pop_back();
    if (c.is_given) s.course = std::make_shared<const Polyline>(c.points);
    if (!c.is_closed()) {
      const auto within = [&](int end) { return std::min(h_of_corner[c.ends[end]], c.length() / 2); };
      s.ends.push_back({c.points.front(), (c.points[1] - c.points[0]).normalized(), within(0)});
      s.ends.push_back({c.points.back(), (c.points[c.points.size() - 2] - c.points.back()).normalized(), within(1)});
    }
    strata.push_back(std::move(s));
  }
  // Other curves come from seeds, and one that has none is not among them: no border is sure.
  if (!domain.decides_by_signs()) {
    for (int p = 0; p < domain.n_patches(); ++p) strata[p].border.emplace();
    for (std::size_t k = 0; k < graph.curves.size(); ++k) {
      const Stratum& s = strata[static_cast<std::size_t>(domain.n_patches()) + 1 + k];
      for (const int p : s.patches) {
        if (!s.course) strata[p].border.reset();
        if (strata[p].border) strata[p].border->push_back(s.course);
      }
    }
  }
  for (const FeatureCorner& c : graph.corners)
    strata.push_back({.dimension = 0, .patches = c.patches, .place = c.place, .ends = {}});
  return strata;
}

FeatureEmbedding embed_features(const PiecewiseDomain& domain, const FeatureGraph& graph, const std::vector<Vec3>& V,
                                const std::vector<Tet>& C, const std::vector<Triangle>& faces,
                                const std::vector<double>& h, const Context& context) {
  return Embedder(domain, graph, V, C, faces, h)(context);
}

}  // namespace umtet
