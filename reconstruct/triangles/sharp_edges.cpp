#include "reconstruct/triangles/sharp_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <utility>

#include "common/disjoint_sets.h"
#include "reconstruct/triangles/edge_uses.h"
#include "reconstruct/triangles/face_patches.h"

namespace umtet {
namespace {

constexpr double kRadians = M_PI / 180;  // of a degree
// Degrees: two triangles are in one plane. STL files in single precision turn by less.
constexpr double kFlatTurn = 1;
// Edges of a curved surface turn alike and are at like distances within these factors, and run alike within this angle:
// two edges of an equilateral triangle are at 60 degrees.
constexpr double kLikeTurn = 2, kLikeDistance = 3, kLeastCos = .49;
// Another edge is beside an edge, not further along its curve, if it is farther than 30 degrees from its direction.
constexpr double kBesideSine = .5;
// The facets of a curved surface consist of few triangles; this bounds the work at a plane of many.
constexpr std::size_t kMostInFacet = 16;
// A staircase: the least number of its edges, their largest mean length as a share of the diagonal, half of the default
// edge length of meshes with sharp edges, and the share of its vertices that turn back.
constexpr std::size_t kFewestStairs = 12;
constexpr double kStair = .02, kBackAndForth = .25;

/// An edge of two triangles, or of more.
struct Edge {
  int a, b;
  int left, right;  ///< two of its triangles
  double turn;      ///< degrees, positive where the surface is convex
  bool is_branching;
};

/// Why an edge is sharp.
enum class Why : std::uint8_t { Smooth, Turn, Line, Border };

double turn_of(const TriangleMesh& mesh, const EdgeUse& one, const EdgeUse& two) {
  const Vec3 m = mesh.area_vector(one.face).normalized(), n = mesh.area_vector(two.face).normalized();
  const double angle = std::atan2(m.cross(n).norm(), m.dot(n)) / kRadians;
  const bool is_convex = m.dot(mesh.centroid(two.face) - mesh.V[static_cast<std::size_t>(one.low)]) < 0;
  return is_convex ? angle : -angle;
}

SharpCurve::Reason reason_of(Why why) {
  return why == Why::Border ? SharpCurve::Reason::Border
         : why == Why::Line ? SharpCurve::Reason::Line
                            : SharpCurve::Reason::Turn;
}

class Finder {
 public:
  Finder(const TriangleMesh& mesh, const SharpEdgeParams& params)
      : mesh_(mesh), params_(params), patches_(mesh.F.size()) {}

  SharpEdges find() {
    list_edges();
    choose();
    drop_staircases();
    while (drop_loose_curves()) {
    }
    trace(true);
    SharpEdges found{curves_, corners_, std::vector<std::size_t>(mesh_.F.size()), 0};
    for (const Edge& e : edges_) {
      if (is_sharp_[static_cast<std::size_t>(&e - edges_.data())] == Why::Smooth) patches_.unite(e.left, e.right);
    }
    std::vector<std::size_t> number(mesh_.F.size());
    for (std::size_t f = 0; f < mesh_.F.size(); ++f) {
      const auto root = static_cast<std::size_t>(patches_.find(static_cast<int>(f)));
      if (root == f) number[f] = found.n_patches++;
      found.patch[f] = number[root];
    }
    return found;
  }

 private:
  const Vec3& at(int v) const { return mesh_.V[static_cast<std::size_t>(v)]; }
  void list_edges();
  void choose();
  bool turns_like_its_neighbours(std::size_t e) const;
  std::vector<double> like_distances(std::size_t e, int triangle) const;
  double second_turn_around(std::size_t e) const;
  void trace(bool ends_at_kinks);
  bool is_corner(int v, bool at_kinks) const;
  std::optional<double> turn_of_curve(int v) const;
  int other_end(std::size_t e, int v) const { return edges_[e].a == v ? edges_[e].b : edges_[e].a; }
  void drop_staircases();
  bool is_staircase(const SharpCurve& curve) const;
  bool drop_loose_curves();

  const TriangleMesh& mesh_;
  const SharpEdgeParams& params_;
  DisjointSets patches_;
  std::vector<Edge> edges_;
  std::set<std::pair<int, int>> lines_;  ///< welded vertices, ascending
  std::vector<Why> is_sharp_;
  std::vector<std::vector<std::size_t>> edges_of_;    ///< by triangle
  std::vector<std::uint8_t> is_in_plane_;             ///< by triangle: with a neighbour
  std::map<int, std::vector<std::size_t>> sharp_at_;  ///< vertex -> sharp edges
  std::vector<SharpCurve> curves_;
  std::vector<std::vector<std::size_t>> edges_of_curves_;
  std::vector<int> corners_;
  double diagonal_ = 0;
};

void Finder::list_edges() {
  const std::vector<int> corner = welded(mesh_.V, find_patches(mesh_).weld_distance);
  if (params_.by_user) {
    for (const auto& [a, b] : mesh_.lines) lines_.insert(std::minmax(corner[a], corner[b]));
  }
  const std::vector<EdgeUse> uses = edge_uses(mesh_, corner);
  for_each_edge(uses, [&](std::size_t first, std::size_t last) {
    if (last - first < 2) return;
    const EdgeUse &one = uses[first], &two = uses[first + 1];
    const double turn = turn_of(mesh_, one, two);
    const int left = static_cast<int>(one.face), right = static_cast<int>(two.face);
    edges_.push_back({one.low, one.high, left, right, turn, last - first > 2 || one.forward == two.forward});
  });
}

void Finder::choose() {
  edges_of_.resize(mesh_.F.size());
  is_in_plane_.resize(mesh_.F.size());
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    for (const int f : {edges_[e].left, edges_[e].right}) {
      edges_of_[static_cast<std::size_t>(f)].push_back(e);
      if (std::abs(edges_[e].turn) < kFlatTurn) is_in_plane_[static_cast<std::size_t>(f)] = 1;
    }
  }
  is_sharp_.resize(edges_.size());
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    const Edge& edge = edges_[e];
    const double turn = std::abs(edge.turn);
    const bool turns =
        params_.by_turn && (turn >= params_.sure_turn || (turn >= params_.least_turn && !turns_like_its_neighbours(e)));
    if (edge.is_branching || turns) {
      is_sharp_[e] = Why::Turn;
    } else if (lines_.contains({edge.a, edge.b})) {
      is_sharp_[e] = Why::Line;
    } else if (params_.by_user && !mesh_.labels.empty() &&
               mesh_.labels[static_cast<std::size_t>(edge.left)] !=
                   mesh_.labels[static_cast<std::size_t>(edge.right)]) {
      is_sharp_[e] = Why::Border;
    }
  }
}

/// Returns the distances from e to the edges that run and turn like it, on the side of a triangle. They are the borders
/// of a facet: of triangles between which the surface turns less than half as much.
std::vector<double> Finder::like_distances(std::size_t e, int triangle) const {
  const Edge& edge = edges_[e];
  const Vec3 along = (at(edge.b) - at(edge.a)).normalized(), middle = (at(edge.a) + at(edge.b)) / 2;
  std::vector<double> found;
  std::vector<int> facet{triangle};
  for (std::size_t n = 0; n < facet.size(); ++n) {
    for (const std::size_t k : edges_of_[static_cast<std::size_t>(facet[n])]) {
      const Edge& other = edges_[k];
      if (k == e) continue;
      const double ratio = other.turn / edge.turn;
      if (std::abs(ratio) < 1 / kLikeTurn) {
        const int next = other.left == facet[n] ? other.right : other.left;
        const bool is_known = std::find(facet.begin(), facet.end(), next) != facet.end();
        if (!is_known && facet.size() < kMostInFacet) facet.push_back(next);
        continue;
      }
      const Vec3 to = (at(other.a) + at(other.b)) / 2 - middle;
      const double distance = to.cross(along).norm();
      const bool is_beside = distance > kBesideSine * to.norm();
      const bool runs_alike = std::abs((at(other.b) - at(other.a)).normalized().dot(along)) > kLeastCos;
      if (is_beside && runs_alike && ratio > 0 && ratio <= kLikeTurn) found.push_back(distance);
    }
  }
  return found;
}

/// Returns the second largest turn at the other edges of the two triangles.
double Finder::second_turn_around(std::size_t e) const {
  std::vector<double> turns{0, 0};
  for (const int f : {edges_[e].left, edges_[e].right}) {
    for (const std::size_t k : edges_of_[static_cast<std::size_t>(f)]) {
      if (k != e) turns.push_back(std::abs(edges_[k].turn));
    }
  }
  std::nth_element(turns.begin(), turns.begin() + 1, turns.end(), std::greater<>());
  return turns[1];
}

bool Finder::turns_like_its_neighbours(std::size_t e) const {
  const Edge& edge = edges_[e];
  const bool has_planes =
      is_in_plane_[static_cast<std::size_t>(edge.left)] || is_in_plane_[static_cast<std::size_t>(edge.right)];
  if (!has_planes && second_turn_around(e) >= std::abs(edge.turn) / kLikeTurn) return true;
  const std::vector<double> left = like_distances(e, edge.left), right = like_distances(e, edge.right);
  for (const double l : left) {
    for (const double r : right) {
      if (std::max(l, r) <= kLikeDistance * std::min(l, r)) return true;
    }
  }
  return false;
}

/// Turn of a curve at a vertex of two sharp edges, degrees; none at others.
std::optional<double> Finder::turn_of_curve(int v) const {
  const std::vector<std::size_t>& edges = sharp_at_.at(v);
  if (edges.size() != 2) return std::nullopt;
  const Vec3 in = at(v) - at(other_end(edges[0], v)), out = at(other_end(edges[1], v)) - at(v);
  return std::atan2(in.cross(out).norm(), in.dot(out)) / kRadians;
}

/// A vertex at which a curve ends, or has a kink: a turn that is not like the turns at both of its neighbours.
bool Finder::is_corner(int v, bool at_kinks) const {
  const std::optional<double> turn = turn_of_curve(v);
  if (!turn || !at_kinks) return !turn;
  if (*turn >= params_.sure_turn) return true;
  if (*turn < params_.kink_turn) return false;
  const std::vector<std::size_t>& edges = sharp_at_.at(v);
  return !std::all_of(edges.begin(), edges.end(), [&](std::size_t e) {
    const std::optional<double> beside = turn_of_curve(other_end(e, v));
    return beside && *beside >= *turn / kLikeTurn;
  });
}

void Finder::trace(bool ends_at_kinks) {
  sharp_at_.clear();
  curves_.clear();
  edges_of_curves_.clear();
  corners_.clear();
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    if (is_sharp_[e] == Why::Smooth) continue;
    sharp_at_[edges_[e].a].push_back(e);
    sharp_at_[edges_[e].b].push_back(e);
  }
  std::vector<std::uint8_t> is_used(edges_.size(), 0);
  const auto follow = [&](int start, std::size_t first) {
    SharpCurve curve{.vertices = {start}, .reason = SharpCurve::Reason::Border};
    std::vector<std::size_t> own;
    for (std::size_t e = first;;) {
      is_used[e] = 1;
      own.push_back(e);
      const int v = curve.vertices.back(), w = edges_[e].a == v ? edges_[e].b : edges_[e].a;
      curve.vertices.push_back(w);
      curve.length += (at(w) - at(v)).norm();
      curve.reason = std::min(curve.reason, reason_of(is_sharp_[e]));
      if (w == start || is_corner(w, ends_at_kinks)) break;
      const std::vector<std::size_t>& next = sharp_at_.at(w);
      e = next[0] == e ? next[1] : next[0];
    }
    curves_.push_back(std::move(curve));
    edges_of_curves_.push_back(std::move(own));
  };
  for (const auto& [v, edges] : sharp_at_) {
    if (!is_corner(v, ends_at_kinks)) continue;
    corners_.push_back(v);
    for (const std::size_t e : edges) {
      if (!is_used[e]) follow(v, e);
    }
  }
  for (std::size_t e = 0; e < edges_.size(); ++e) {
    if (is_sharp_[e] != Why::Smooth && !is_used[e]) follow(edges_[e].a, e);
  }
}

/// A border between labels that follows the triangles of a scan.
bool Finder::is_staircase(const SharpCurve& curve) const {
  const std::size_t n = curve.vertices.size() - 1;
  if (curve.reason != SharpCurve::Reason::Border || n < kFewestStairs) return false;
  if (curve.length > kStair * diagonal_ * static_cast<double>(n)) return false;
  std::size_t n_back = 0;
  Vec3 last = Vec3::Zero();
  for (std::size_t k = 1; k < n; ++k) {
    const Vec3 in = at(curve.vertices[k]) - at(curve.vertices[k - 1]),
               out = at(curve.vertices[k + 1]) - at(curve.vertices[k]), axis = in.cross(out);
    const bool is_kink = std::atan2(axis.norm(), in.dot(out)) >= params_.kink_turn * kRadians;
    if (is_kink && axis.dot(last) < 0) ++n_back;
    last = is_kink ? axis : Vec3::Zero();
  }
  return static_cast<double>(n_back) > kBackAndForth * static_cast<double>(n);
}

void Finder::drop_staircases() {
  if (mesh_.labels.empty() || !params_.by_user) return;
  diagonal_ = diagonal_of(mesh_);
  trace(false);
  for (std::size_t c = 0; c < curves_.size(); ++c) {
    if (!is_staircase(curves_[c])) continue;
    for (const std::size_t e : edges_of_curves_[c]) is_sharp_[e] = Why::Smooth;
  }
}

/// Traces the curves, through kinks, and makes those smooth that are noise. \return whether there were any
bool Finder::drop_loose_curves() {
  trace(false);
  const double least = params_.least_length * diagonal_of(mesh_);
  DisjointSets networks(mesh_.V.size());
  std::map<int, std::size_t> n_edges;
  std::map<int, double> length;
  std::set<int> is_wanted;  // by the user: networks with lines and borders
  for (const SharpCurve& curve : curves_) {
    for (const int v : curve.vertices) networks.unite(curve.vertices.front(), v);
  }
  for (const SharpCurve& curve : curves_) {
    const int network = networks.find(curve.vertices.front());
    if (curve.reason != SharpCurve::Reason::Turn) is_wanted.insert(network);
    n_edges[network] += curve.vertices.size() - 1;
    length[network] += curve.length;
  }
  bool has_dropped = false;
  for (std::size_t c = 0; c < curves_.size(); ++c) {
    const SharpCurve& curve = curves_[c];
    const auto is_loose = [&](int v) { return sharp_at_.at(v).size() == 1; };
    const bool has_loose_end = is_loose(curve.vertices.front()) || is_loose(curve.vertices.back());
    const bool is_short = curve.length < least || curve.vertices.size() <= params_.fewest_edges;
    const int network = networks.find(curve.vertices.front());
    const bool is_speck = n_edges[network] < params_.fewest_edges && length[network] < least;
    if (!(has_loose_end && is_short) && !(is_speck && !is_wanted.contains(network))) continue;
    if (curve.reason == SharpCurve::Reason::Line) continue;
    for (const std::size_t e : edges_of_curves_[c]) is_sharp_[e] = Why::Smooth;
    has_dropped = true;
  }
  return has_dropped;
}

}  // namespace

double SharpEdges::length() const {
  return std::accumulate(curves.begin(), curves.end(), 0.,
                         [](double sum, const SharpCurve& curve) { return sum + curve.length; });
}

std::size_t SharpEdges::n_curves_by(SharpCurve::Reason reason) const {
  return static_cast<std::size_t>(
      std::count_if(curves.begin(), curves.end(), [&](const SharpCurve& c) { return c.reason == reason; }));
}

SharpEdges find_sharp_edges(const TriangleMesh& mesh, const SharpEdgeParams& params) {
  return Finder(mesh, params).find();
}

}  // namespace umtet
