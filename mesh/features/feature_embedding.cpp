#include "mesh/features/feature_embedding.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>
#include <utility>

#include "mesh/features/detail/boundary_graph.h"
#include "mesh/features/detail/rerouted_paths.h"

namespace umtet {
namespace {

constexpr double kLeastGap = .5;   // of the mean: two vertices of a path are not nearer than this along the curve
constexpr int kVoteSteps = 3;      // of Newton's method from the centroid of a face to psi = 0
constexpr double kClearVote = .9;  // of the area beside a curve that is missing: else the patch is unknown

class Embedder {
 public:
  Embedder(const PiecewiseDomain& domain, const FeatureGraph& graph, const std::vector<Vec3>& V,
           const std::vector<Tet>& C, const std::vector<Triangle>& faces, const std::vector<double>& h)
      : domain_(domain), graph_(graph), V_(V), faces_(faces), h_(h), boundary_(V.size(), C, faces) {}

  FeatureEmbedding operator()(const Context& context) {
    detail::ReroutedPaths paths = detail::lay_paths(domain_, graph_, boundary_, V_, h_, context);
    made_.corner_vertex = std::move(paths.corner_vertex);
    made_.chains = std::move(paths.chains);
    made_.defects = std::move(paths.defects);
    made_.chain_arc.resize(graph_.curves.size());
    std::vector<double> h_of_corner;
    for (const int v : made_.corner_vertex)
      h_of_corner.push_back(v < 0 ? *std::min_element(h_.begin(), h_.end()) : h_[v]);
    made_.strata = strata_of(domain_, graph_, h_of_corner);
    votes_.resize(faces_.size());
    for (std::size_t f = 0; f < faces_.size(); ++f) votes_[f] = vote(faces_[f]);
    while (!assign_patches()) {
    }
    set_strata();
    for (std::size_t c = 0; c < graph_.curves.size(); ++c) spread(static_cast<int>(c));
    return std::move(made_);
  }

 private:
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
    std::map<detail::Edge, int> curve_of;
    for (std::size_t c = 0; c < made_.chains.size(); ++c)
      for (std::size_t k = 0; k + 1 < made_.chains[c].size(); ++k)
        curve_of[detail::edge_of(made_.chains[c][k], made_.chains[c][k + 1])] = static_cast<int>(c);
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
          const detail::Edge e = detail::edge_of(f[i], f[(i + 1) % 3]);
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
      made_.chains[c].clear();
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
  const detail::BoundaryGraph boundary_;
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
