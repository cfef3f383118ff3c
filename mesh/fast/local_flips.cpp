#include "mesh/fast/local_flips.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <queue>
#include <span>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "mesh/core/max_min.h"
#include "mesh/core/tet_quality.h"
#include "mesh/fast/all_vertex_smoothing.h"
#include "mesh/fast/detail/ring_newton.h"
#include "mesh/implicit/closest_point.h"
#include "mesh/submesh/active_layer.h"

namespace umtet {
namespace {

using Stratum = VertexStratum;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Tets around an edge that is removed: of nine and more the best triangulation is rarely better than the ring.
constexpr int kMostRing = 8;
// Power of target / Q in the sum over a patch, and what an operation has to take off it. The sum counts the worst tet
// most, and lets others get a little worse.
constexpr int kPower = 18;
constexpr double kLeastGain = .02;
// The least Q of a patch may fall by this much where the sum falls.
constexpr double kLostQuality = .003;
// In the last pass it is enough that the worst tet reaches the target, or rises by this much while the sum does not.
constexpr double kLeastRaise = 5e-4;
// Of the least Q of a patch before, what the worst new tet needs before its vertices move. Below it one patch in ten is
// mended (`mesh_bench --benchmark_filter=flips`).
constexpr double kPromising = .6;
// Where a body is thinner than its tets, no operation helps, and each that is kept near by would have all tried again:
// a tet is left as it is once this often nothing helped at each of its vertices. A pass counts anew.
constexpr int kMostFailures = 6;
// What is left after that is tried again with more candidates and a lower bar, and all vertices of a patch move at
// once: that mends half of it or more, at ten times the cost of a try.
constexpr double kPromisingAtLast = .4;
constexpr int kMoreCandidates = 3;  // times as many
// Sweeps over the vertices of a patch, at most.
constexpr int kSweeps = 6;
constexpr double kVertexGain = 2e-4;  // of the norm of 1/Q of a ring: less is no move
// Boundary faces that are farther from psi = 0 are misaligned (patch_state.h); they count like tets whose Q is less
// than the target by this much for a cosine that is less by one.
constexpr double kAligned = .5, kWeightOfCosine = .6;
// Of an edge: the centroid of a new boundary face may be so far from psi = 0, or as far as the worst of the patch was.
constexpr double kFaceDistance = .2;
constexpr int kTriesPerPoll = 64;

double power18(double x) {
  const double x2 = x * x, x4 = x2 * x2, x8 = x4 * x4;
  return x8 * x8 * x2;
}

double quality(const std::vector<Vec3>& V, const Tet& t) { return mean_ratio(V[t[0]], V[t[1]], V[t[2]], V[t[3]]); }

// Faces of a tet, counter-clockwise seen from outside: the tet is (v_k, face k), positive.
constexpr std::array<std::array<int, 3>, 4> kFaces = {{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

bool contains(const Tet& t, int v) { return t[0] == v || t[1] == v || t[2] == v || t[3] == v; }

/// The other two vertices of a tet with the edge (a, b), so that (a, b, first, second) is positive.
std::pair<int, int> opposite_edge(const Tet& t, int a, int b) {
  // The even permutations of the corners.
  constexpr std::array<std::array<int, 4>, 12> kEven = {{{0, 1, 2, 3},
                                                         {0, 2, 3, 1},
                                                         {0, 3, 1, 2},
                                                         {1, 0, 3, 2},
                                                         {1, 2, 0, 3},
                                                         {1, 3, 2, 0},
                                                         {2, 0, 1, 3},
                                                         {2, 1, 3, 0},
                                                         {2, 3, 0, 1},
                                                         {3, 0, 2, 1},
                                                         {3, 1, 0, 2},
                                                         {3, 2, 1, 0}}};
  for (const auto& p : kEven)
    if (t[p[0]] == a && t[p[1]] == b) return {t[p[2]], t[p[3]]};
  return {-1, -1};
}

/// Tets around each vertex, while tets come and go.
class Incidence {
 public:
  Incidence(std::size_t n_vertices, const std::vector<Tet>& C) : begin_(n_vertices + 1, 0), list_of_(n_vertices, -1) {
    for (const Tet& t : C)
      for (const int v : t) ++begin_[v + 1];
    for (std::size_t v = 0; v < n_vertices; ++v) begin_[v + 1] += begin_[v];
    tets_.resize(4 * C.size());
    std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
    for (std::size_t t = 0; t < C.size(); ++t)
      for (const int v : C[t]) tets_[next[v]++] = static_cast<int>(t);
  }
  std::span<const int> of(int v) const {
    if (list_of_[v] >= 0) return lists_[list_of_[v]];
    return {tets_.data() + begin_[v], begin_[v + 1] - begin_[v]};
  }
  void add(int v, int tet) { list(v).push_back(tet); }
  void remove(int v, int tet) { std::erase(list(v), tet); }

 private:
  std::vector<int>& list(int v) {
    if (list_of_[v] < 0) {
      const std::span<const int> all = of(v);
      lists_.emplace_back(all.begin(), all.end());
      list_of_[v] = static_cast<int>(lists_.size()) - 1;
    }
    return lists_[list_of_[v]];
  }

  std::vector<std::size_t> begin_;
  std::vector<int> tets_, list_of_;
  std::vector<std::vector<int>> lists_;
};

/// The tets around an edge, in their order.
struct Ring {
  std::vector<int> vertices;  ///< counter-clockwise seen from b
  bool is_closed = false;     ///< else the edge lies on the boundary, and so do its faces with the first and the last
};

enum class Operation {
  Smooth,     ///< vertices one by one
  SmoothAll,  ///< all vertices of the patch at once (all_vertex_smoothing.h)
  RemoveEdge,
  Collapse
};

struct Candidate {
  Operation operation = Operation::Smooth;
  int a = -1, b = -1;
  double least = 0;  ///< mean ratio of the worst new tet, before its vertices move
  std::vector<int> old_tets;
  std::vector<Tet> new_tets;
};

/// A patch on which an operation is tried.
struct Patch {
  std::vector<int> vertices;  ///< of the mesh
  std::vector<Vec3> V;
  std::vector<Tet> C;  ///< local; the new tets come first
  std::vector<std::uint8_t> moves;
  std::vector<std::vector<Triangle>> ring;  ///< per vertex that moves: its tets are (v, p, q, r)
};

/// What is compared before and after an operation.
struct PatchMeasure {
  double sum = 0, least = 1;
  double shortest = kInfinity, longest = 0;  ///< edges, relative
  double least_cosine = 1, farthest = 0;     ///< of boundary faces; in edges
};

class LocalFlips {
 public:
  LocalFlips(std::vector<Vec3> V, std::vector<Tet> C, const std::vector<Stratum>& stratum, ImplicitFunctionRef psi,
             const LocalFlipParams& params, LocalFlipReport& report)
      : V_(std::move(V)),
        C_(std::move(C)),
        n_given_(C_.size()),
        alive_(C_.size(), 1),
        version_(C_.size(), 0),
        incidence_(V_.size(), C_),
        stratum_(stratum),
        local_(V_.size(), -1),
        psi_(psi),
        params_(params),
        report_(report) {
    measure_edges();
  }

  FlippedMesh operator()(const Context& context) {
    for (is_last_ = false;; is_last_ = true) {
      mend_all(context);
      if (is_last_) return result();
    }
  }

 private:
  void mend_all(const Context& context) {
    failures_.assign(V_.size(), 0);
    for (std::size_t t = 0; t < C_.size(); ++t)
      if (alive_[t]) enqueue(static_cast<int>(t));
    const auto at_first = static_cast<double>(std::max<std::size_t>(1, queue_.size()));
    for (std::size_t n = 0; !queue_.empty(); ++n) {
      if (n % kTriesPerPoll == 0)
        context.report("flips", 1 - std::min(1., static_cast<double>(queue_.size()) / at_first));
      const auto [q, tet, version] = queue_.top();
      queue_.pop();
      if (alive_[tet] && version_[tet] == version) mend(tet);
    }
  }

  using Queued = std::tuple<double, int, int>;  ///< mean ratio, tet, its version

  void measure_edges() {
    edge_.assign(V_.size(), 0);
    std::vector<int> n(V_.size(), 0);
    for (const Tet& t : C_)
      for (int i = 0; i < 4; ++i)
        for (int j = i + 1; j < 4; ++j) {
          const double length = (V_[t[i]] - V_[t[j]]).norm();
          edge_[t[i]] += length, edge_[t[j]] += length;
          ++n[t[i]], ++n[t[j]];
        }
    for (std::size_t v = 0; v < V_.size(); ++v) edge_[v] /= std::max(1, n[v]);
  }

  /// What a misaligned face counts like: the mean ratio of a tet.
  double quality_of_cosine(double cosine) const {
    return params_.target - kWeightOfCosine * std::max(0., kAligned - cosine) / 2;
  }

  void enqueue(int tet) {
    const Tet& t = C_[tet];
    double q = quality(V_, t);
    const auto n_on_boundary =
        std::count_if(t.begin(), t.end(), [&](int v) { return stratum_[v] == Stratum::Boundary; });
    if (n_on_boundary >= 3) q = std::min(q, quality_of_cosine(least_cosine(t)));
    if (q < params_.target) queue_.emplace(q, tet, version_[tet]);
  }

  /// Of the faces of a tet that lie on the boundary.
  double least_cosine(const Tet& t) {
    double least = 1;
    for (const auto& f : kFaces) {
      const Triangle face = {t[f[0]], t[f[1]], t[f[2]]};
      if (!std::all_of(face.begin(), face.end(), [&](int v) { return stratum_[v] == Stratum::Boundary; })) continue;
      const std::span<const int> around = incidence_.of(face[0]);
      const auto n = std::count_if(around.begin(), around.end(),
                                   [&](int s) { return contains(C_[s], face[1]) && contains(C_[s], face[2]); });
      if (n != 1) continue;
      const Vec3 &a = V_[face[0]], &b = V_[face[1]], &c = V_[face[2]];
      Vec3 gradient;
      psi_.value((a + b + c) / 3, gradient);
      ++report_.psi_evaluations;
      const Vec3 normal = (b - a).cross(c - a);
      const double cosine = normal.dot(gradient) / (normal.norm() * gradient.norm());
      least = std::min(least, std::isfinite(cosine) ? cosine : -1);
    }
    return least;
  }

  std::vector<int> tets_at(int a, int b) const {
    std::vector<int> tets;
    for (const int t : incidence_.of(a))
      if (contains(C_[t], b)) tets.push_back(t);
    return tets;
  }

  /// @return empty where the tets are no ring of at most kMostRing
  Ring ring_of(int a, int b, const std::vector<int>& tets) const {
    Ring ring;
    const auto n = static_cast<int>(tets.size());
    if (n < 1 || n > kMostRing) return ring;
    std::array<std::pair<int, int>, kMostRing> edge;
    for (int k = 0; k < n; ++k) edge[k] = opposite_edge(C_[tets[k]], a, b);
    int first = 0;
    for (int k = 0; k < n; ++k) {
      const bool has_before =
          std::any_of(edge.begin(), edge.begin() + n, [&](auto e) { return e.second == edge[k].first; });
      if (!has_before) first = k;
    }
    ring.vertices = {edge[first].first};
    int at = edge[first].second;
    for (int k = 1; k < n && at != ring.vertices.front(); ++k) {
      ring.vertices.push_back(at);
      const auto* next = std::find_if(edge.begin(), edge.begin() + n, [&](auto e) { return e.first == at; });
      if (next == edge.begin() + n) return {};
      at = next->second;
    }
    ring.is_closed = at == ring.vertices.front();
    if (!ring.is_closed) ring.vertices.push_back(at);
    if (static_cast<int>(ring.vertices.size()) != n + (ring.is_closed ? 0 : 1)) return {};
    return ring;
  }

  bool are_neighbours(int a, int b) const {
    const std::span<const int> tets = incidence_.of(a);
    return std::any_of(tets.begin(), tets.end(), [&](int t) { return contains(C_[t], b); });
  }

  /// The triangulation of a ring whose worst tet is best [Klincsek1980], [Shewchuk2002].
  void offer_removal(int a, int b, const std::vector<int>& tets, const Ring& ring, std::vector<Candidate>& candidates) {
    const std::vector<int>& r = ring.vertices;
    const auto n = static_cast<int>(r.size());
    if (n < 3) return;
    if (!ring.is_closed) {
      if (stratum_[a] != Stratum::Boundary || stratum_[b] != Stratum::Boundary) return;
      if (stratum_[r.front()] != Stratum::Boundary || stratum_[r.back()] != Stratum::Boundary) return;
      if (are_neighbours(r.front(), r.back())) return;
    }
    std::array<std::array<double, kMostRing + 1>, kMostRing + 1> best{};
    std::array<std::array<int, kMostRing + 1>, kMostRing + 1> middle{};
    for (int i = 0; i + 1 < n; ++i) best[i][i + 1] = kInfinity;
    for (int width = 2; width < n; ++width) {
      for (int i = 0; i + width < n; ++i) {
        const int j = i + width;
        best[i][j] = -kInfinity;
        for (int k = i + 1; k < j; ++k) {
          double q = std::min(best[i][k], best[k][j]);
          if (q <= best[i][j]) continue;
          q = std::min({q, quality(V_, {a, r[i], r[k], r[j]}), quality(V_, {b, r[i], r[j], r[k]})});
          if (q > best[i][j]) best[i][j] = q, middle[i][j] = k;
        }
      }
    }
    Candidate c{Operation::RemoveEdge, a, b, best[0][n - 1], tets, {}};
    std::sort(c.old_tets.begin(), c.old_tets.end());
    if (!(c.least > 0)) return;
    std::vector<std::pair<int, int>> open = {{0, n - 1}};
    while (!open.empty()) {
      const auto [i, j] = open.back();
      open.pop_back();
      if (j - i < 2) continue;
      const int k = middle[i][j];
      c.new_tets.push_back({a, r[i], r[k], r[j]});
      c.new_tets.push_back({b, r[i], r[j], r[k]});
      open.emplace_back(i, k);
      open.emplace_back(k, j);
    }
    candidates.push_back(std::move(c));
  }

  /// Vertex a goes into b.
  void offer_collapse(int a, int b, const std::vector<int>& around, const Ring& ring,
                      std::vector<Candidate>& candidates) {
    if (stratum_[a] == Stratum::Fixed) return;
    if (stratum_[a] == Stratum::Boundary && (ring.is_closed || stratum_[b] != Stratum::Boundary)) return;
    Candidate c{Operation::Collapse, a, b, kInfinity, {}, {}};
    for (const int t : incidence_.of(a)) {
      c.old_tets.push_back(t);
      if (contains(C_[t], b)) continue;
      Tet moved = C_[t];
      std::replace(moved.begin(), moved.end(), a, b);
      c.least = std::min(c.least, quality(V_, moved));
      if (!(c.least > 0)) return;
      c.new_tets.push_back(moved);
    }
    if (c.new_tets.empty()) return;
    std::sort(c.old_tets.begin(), c.old_tets.end());
    // The link condition [Dey1999]: who is a neighbour of both lies around their edge.
    for (const int t : incidence_.of(a)) {
      for (const int v : C_[t]) {
        if (v == a || v == b || std::find(ring.vertices.begin(), ring.vertices.end(), v) != ring.vertices.end())
          continue;
        if (std::any_of(around.begin(), around.end(), [&](int s) { return contains(C_[s], v); })) continue;
        if (are_neighbours(v, b)) return;
      }
    }
    candidates.push_back(std::move(c));
  }

  std::vector<Candidate> candidates_of(int tet) {
    std::vector<Candidate> candidates;
    const Tet corners = C_[tet];
    for (int i = 0; i < 4; ++i) {
      for (int j = i + 1; j < 4; ++j) {
        const int a = corners[i], b = corners[j];
        const std::vector<int> tets = tets_at(a, b);
        const Ring ring = ring_of(a, b, tets);
        if (ring.vertices.empty()) continue;
        offer_removal(a, b, tets, ring, candidates);
        offer_collapse(a, b, tets, ring, candidates);
        offer_collapse(b, a, tets, ring, candidates);
      }
    }
    const double bar = (is_last_ ? kPromisingAtLast : kPromising) * quality(V_, corners);
    std::erase_if(candidates, [&](const Candidate& c) { return c.least < bar; });
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Candidate& x, const Candidate& y) { return x.least > y.least; });
    const auto most = static_cast<std::size_t>(params_.most_candidates) * (is_last_ ? kMoreCandidates : 1);
    if (candidates.size() > most) candidates.resize(most);
    return candidates;
  }

  void mend(int tet) {
    const Tet corners = C_[tet];
    if (std::all_of(corners.begin(), corners.end(), [&](int v) { return failures_[v] >= kMostFailures; })) return;
    if (was_mended(tet)) return;
    for (const int v : corners) failures_[v] = static_cast<std::uint8_t>(std::min(255, failures_[v] + 1));
  }

  bool was_mended(int tet) {
    for (const Candidate& c : candidates_of(tet))
      if (attempt(c)) return true;
    Candidate c;
    for (const int v : C_[tet])
      for (const int t : incidence_.of(v)) c.old_tets.push_back(t);
    std::sort(c.old_tets.begin(), c.old_tets.end());
    c.old_tets.erase(std::unique(c.old_tets.begin(), c.old_tets.end()), c.old_tets.end());
    for (const int t : c.old_tets) c.new_tets.push_back(C_[t]);
    if (attempt(c)) return true;
    c.operation = Operation::SmoothAll;
    return attempt(c);
  }

  /// @return whether it was kept
  bool attempt(const Candidate& c) {
    ++report_.tries;
    // Vertices of the new tets move; a patch holds all tets at one that moves.
    moving_.clear();
    for (const Tet& t : c.new_tets)
      for (const int v : t)
        if (stratum_[v] != Stratum::Fixed) moving_.push_back(v);
    std::sort(moving_.begin(), moving_.end());
    moving_.erase(std::unique(moving_.begin(), moving_.end()), moving_.end());
    patch_tets_.clear();
    for (const int v : moving_)
      for (const int t : incidence_.of(v)) patch_tets_.push_back(t);
    for (const int t : c.old_tets) patch_tets_.push_back(t);
    std::sort(patch_tets_.begin(), patch_tets_.end());
    patch_tets_.erase(std::unique(patch_tets_.begin(), patch_tets_.end()), patch_tets_.end());

    std::vector<Tet> before;
    for (const int t : patch_tets_) before.push_back(C_[t]);
    const PatchMeasure old = measured(patch_of(before));
    std::vector<Tet> after = c.new_tets;
    kept_tets_.clear();
    for (const int t : patch_tets_) {
      if (std::binary_search(c.old_tets.begin(), c.old_tets.end(), t)) continue;
      kept_tets_.push_back(t);
      after.push_back(C_[t]);
    }
    Patch patch = patch_of(after);
    if (c.operation != Operation::SmoothAll) shape(patch);
    if (c.operation == Operation::SmoothAll || is_last_) shape_at_once(patch);
    const PatchMeasure made = measured(patch);
    if (!is_better(made, old)) return false;
    commit(c, patch);
    std::size_t& n = c.operation == Operation::RemoveEdge ? report_.n_removed_edges
                     : c.operation == Operation::Collapse ? report_.n_collapsed
                                                          : report_.n_smoothed;
    ++n;
    return true;
  }

  bool is_better(const PatchMeasure& made, const PatchMeasure& old) const {
    const bool has_less = made.sum < (1 - kLeastGain) * old.sum && made.least >= old.least - kLostQuality;
    const bool has_raised =
        is_last_ && (made.least >= params_.target || (made.sum <= old.sum && made.least > old.least + kLeastRaise));
    return (has_less || has_raised) && made.shortest >= std::min(params_.shortest, old.shortest) &&
           made.longest <= std::max(params_.longest, old.longest) &&
           made.least_cosine >= std::min(kAligned, old.least_cosine) &&
           made.farthest <= std::max(kFaceDistance, old.farthest);
  }

  Patch patch_of(const std::vector<Tet>& tets) {
    Patch patch;
    patch.C.reserve(tets.size());
    for (const Tet& t : tets) {
      Tet l{};
      for (int k = 0; k < 4; ++k) {
        if (local_[t[k]] < 0) {
          local_[t[k]] = static_cast<int>(patch.vertices.size());
          patch.vertices.push_back(t[k]);
          patch.V.push_back(V_[t[k]]);
          patch.moves.push_back(std::binary_search(moving_.begin(), moving_.end(), t[k]) ? 1 : 0);
        }
        l[k] = local_[t[k]];
      }
      patch.C.push_back(l);
    }
    for (const int v : patch.vertices) local_[v] = -1;
    patch.ring.resize(patch.vertices.size());
    for (const Tet& t : patch.C) {
      for (int k = 0; k < 4; ++k)
        if (patch.moves[t[k]]) patch.ring[t[k]].push_back({t[kFaces[k][0]], t[kFaces[k][1]], t[kFaces[k][2]]});
    }
    return patch;
  }

  /// Moves the vertices of a patch until all its tets reach the target or none gains any more.
  void shape(Patch& patch) {
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      bool has_moved = false, is_good = true;
      for (std::size_t v = 0; v < patch.V.size(); ++v) {
        if (!patch.moves[v] || patch.ring[v].size() > kMaxRing) continue;
        OneRing ring(patch.V[v], patch.V, patch.ring[v]);
        if (ring.f_here >= good_f_) continue;
        is_good = false;
        detail::silence_padding(ring);
        has_moved |= solve(patch, v, ring);
      }
      if (is_good || !has_moved) return;
    }
  }

  /// The same where single vertices gain nothing.
  void shape_at_once(Patch& patch) {
    ActiveLayer layer;
    layer.V = patch.V;
    layer.C = patch.C;
    for (std::size_t v = 0; v < patch.V.size(); ++v) {
      const bool is_on_boundary = stratum_[patch.vertices[v]] == Stratum::Boundary;
      layer.role.push_back(!patch.moves[v]  ? ActiveLayer::Role::Fixed
                           : is_on_boundary ? ActiveLayer::Role::Boundary
                                            : ActiveLayer::Role::Inner);
      layer.local_h.push_back(edge_[patch.vertices[v]]);
    }
    report_.psi_evaluations += smooth_all_vertices(layer, psi_, params_.target).psi_evaluations;
    patch.V = std::move(layer.V);
  }

  bool solve(Patch& patch, std::size_t v, const OneRing& ring) {
    const int vertex = patch.vertices[v];
    const double h = edge_[vertex];
    const detail::Bar bar(ring, h, kVertexGain);
    Vec3& x = patch.V[v];
    if (stratum_[vertex] == Stratum::Inner) {
      const detail::Displacement best = detail::best_displacement(ring, bar, h, {});
      if (!best.passed(ring, bar)) return false;
      x += best.y;
      return true;
    }
    Vec3 gradient;
    psi_.value(x, gradient);
    ++report_.psi_evaluations;
    const double norm = gradient.norm();
    if (!(norm > 0) || !std::isfinite(norm)) return false;
    detail::Directions tangent{true, {}};
    tangent.tangents.col(0) = gradient.unitOrthogonal();
    tangent.tangents.col(1) = (gradient / norm).cross(tangent.tangents.col(0));
    const detail::Displacement best = detail::best_displacement(ring, bar, h, tangent);
    if (!best.passed(ring, bar)) return false;
    const ClosestPoint foot = closest_point(psi_, x + best.y, h, closest_point_);
    report_.psi_evaluations += static_cast<std::size_t>(foot.iterations);
    if (!foot.converged || !bar.passed(ring, foot.point - x)) return false;
    x = foot.point;
    return true;
  }

  PatchMeasure measured(const Patch& patch) {
    PatchMeasure m;
    for (const Tet& t : patch.C) {
      const double q = quality(patch.V, t);
      m.least = std::min(m.least, q);
      m.sum += q > 0 ? power18(params_.target / q) : kInfinity;
      for (int i = 0; i < 4; ++i)
        for (int j = i + 1; j < 4; ++j) {
          if (!patch.moves[t[i]] && !patch.moves[t[j]]) continue;
          const double mean = (edge_[patch.vertices[t[i]]] + edge_[patch.vertices[t[j]]]) / 2;
          const double ratio = (patch.V[t[i]] - patch.V[t[j]]).norm() / mean;
          m.shortest = std::min(m.shortest, ratio);
          m.longest = std::max(m.longest, ratio);
        }
    }
    if (m.sum < kInfinity) add_faces(patch, m);
    return m;
  }

  /// Faces with a vertex that moves and one tet. The patch holds all tets at such a vertex.
  void add_faces(const Patch& patch, PatchMeasure& m) {
    faces_.clear();
    for (const Tet& t : patch.C) {
      for (const auto& f : kFaces) {
        const Triangle face = {t[f[0]], t[f[1]], t[f[2]]};
        const bool is_candidate =
            std::all_of(face.begin(), face.end(),
                        [&](int v) { return stratum_[patch.vertices[v]] == Stratum::Boundary; }) &&
            std::any_of(face.begin(), face.end(), [&](int v) { return patch.moves[v] != 0; });
        if (!is_candidate) continue;
        Triangle key = face;
        std::sort(key.begin(), key.end());
        faces_.emplace_back(key, face);
      }
    }
    std::sort(faces_.begin(), faces_.end());
    for (std::size_t k = 0; k < faces_.size(); ++k) {
      const bool is_twin = (k > 0 && faces_[k - 1].first == faces_[k].first) ||
                           (k + 1 < faces_.size() && faces_[k + 1].first == faces_[k].first);
      if (is_twin) continue;
      const Triangle& f = faces_[k].second;
      const Vec3 &a = patch.V[f[0]], &b = patch.V[f[1]], &c = patch.V[f[2]];
      const Vec3 normal = (b - a).cross(c - a);
      Vec3 gradient;
      const double value = psi_.value((a + b + c) / 3, gradient);
      ++report_.psi_evaluations;
      const double slope = gradient.norm(), cosine = normal.dot(gradient) / (normal.norm() * slope);
      const double h = (edge_[patch.vertices[f[0]]] + edge_[patch.vertices[f[1]]] + edge_[patch.vertices[f[2]]]) / 3;
      if (!std::isfinite(cosine)) {
        m.least_cosine = -1;
        continue;
      }
      m.least_cosine = std::min(m.least_cosine, cosine);
      m.farthest = std::max(m.farthest, std::abs(value) / (slope * h));
      if (cosine < kAligned) m.sum += power18(params_.target / quality_of_cosine(cosine));
    }
  }

  void commit(const Candidate& c, const Patch& patch) {
    for (std::size_t v = 0; v < patch.V.size(); ++v)
      if (patch.moves[v]) V_[patch.vertices[v]] = patch.V[v];
    if (c.operation == Operation::RemoveEdge || c.operation == Operation::Collapse) {
      for (const int t : c.old_tets) {
        alive_[t] = 0;
        for (const int v : C_[t]) incidence_.remove(v, t);
      }
      for (const Tet& t : c.new_tets) {
        const auto id = static_cast<int>(C_.size());
        C_.push_back(t);
        alive_.push_back(1);
        version_.push_back(0);
        for (const int v : t) incidence_.add(v, id);
        enqueue(id);
      }
    } else {
      kept_tets_ = patch_tets_;
    }
    for (const int t : kept_tets_) {
      ++version_[t];
      enqueue(t);
    }
  }

  FlippedMesh result() {
    FlippedMesh made;
    made.V = std::move(V_);
    for (std::size_t t = 0; t < C_.size(); ++t) {
      if (!alive_[t]) continue;
      report_.n_below += quality(made.V, C_[t]) < params_.target ? 1 : 0;
      made.C.push_back(C_[t]);
      made.origin.push_back(t < n_given_ ? static_cast<std::int64_t>(t) : -1);
    }
    return made;
  }

  std::vector<Vec3> V_;
  std::vector<Tet> C_;
  const std::size_t n_given_;
  std::vector<std::uint8_t> alive_;
  std::vector<int> version_;
  Incidence incidence_;
  const std::vector<Stratum>& stratum_;
  std::vector<int> local_;    ///< per vertex, while a patch is made
  std::vector<double> edge_;  ///< mean length at each vertex, at first
  ImplicitFunctionRef psi_;
  const LocalFlipParams& params_;
  LocalFlipReport& report_;
  const ClosestPointParams closest_point_{.method = ClosestPointMethod::Damped};
  const double good_f_ = f_of_quality(std::min(.999, params_.target + .02));
  std::vector<std::uint8_t> failures_;  ///< per vertex, in this pass
  bool is_last_ = false;                ///< the last pass
  std::priority_queue<Queued, std::vector<Queued>, std::greater<>> queue_;
  std::vector<int> moving_, patch_tets_, kept_tets_;
  std::vector<std::pair<Triangle, Triangle>> faces_;
};

}  // namespace

std::vector<std::string> problems(const LocalFlipParams& params) {
  std::vector<std::string> p;
  if (!(params.target > 0 && params.target < 1)) p.emplace_back("target must be in (0, 1)");
  if (!(params.shortest > 0 && params.shortest < 1)) p.emplace_back("shortest must be in (0, 1)");
  if (!(params.longest > 1)) p.emplace_back("longest must be > 1");
  if (params.most_candidates < 0) p.emplace_back("most_candidates must be >= 0");
  return p;
}

FlippedMesh flip_locally(std::vector<Vec3> V, std::vector<Tet> C, const std::vector<VertexStratum>& stratum,
                         ImplicitFunctionRef psi, const LocalFlipParams& params, LocalFlipReport& report,
                         const Context& context) {
  std::string all;
  for (const std::string& problem : problems(params)) all += (all.empty() ? "" : "; ") + problem;
  if (stratum.size() != V.size()) all += (all.empty() ? "" : "; ") + std::string("one stratum for each vertex");
  if (!all.empty()) throw std::invalid_argument(all);
  return LocalFlips(std::move(V), std::move(C), stratum, psi, params, report)(context);
}

}  // namespace umtet
