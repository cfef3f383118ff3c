#include "body/edges/cloud_domain.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "common/disjoint_sets.h"
#include "reconstruct/cloud/neighbours/neighbour_tree.h"
#include "reconstruct/patches/corner_table.h"
#include "reconstruct/patches/feature_tracing.h"
#include "reconstruct/patches/patch_fit.h"

namespace umtet {
namespace {

// In spacings. A sample may be a spacing away from the foot of x, and so may be one of the patch beyond the curve.
constexpr double kNearCurve = 2, kNearCorner = 2.5;

// A sample whose foot is farther, in spacings and in standard deviations of the noise, is an outlier.
constexpr double kFarthestFoot = 1, kNoises = 5;
// So is one with fewer samples of its patch within this distance: in the corner of a square the fourth is 2.2 s away.
constexpr int kCompany = 4;
constexpr double kAlone = 2.5;
constexpr int kSteps = 4;            // of Newton's method: within a spacing it doubles the digits each time
constexpr double kOnBoundary = .01;  // in spacings

double square(double x) { return x * x; }

/// The curves and corners at the border of a patch.
struct PatchBorder {
  std::vector<Vec3> points;  ///< of curves
  std::vector<int> curves;   ///< of each point
  std::optional<NeighbourTree> tree;
  std::vector<int> corners;  ///< corners where three or more patches meet
};

/// Patches, curves and corners around the samples of a cloud.
class CloudSurface {
 public:
  CloudSurface(const std::vector<Vec3>& points, const SamplePatches& patches, const Context& context)
      : s_(patches.spacing),
        fits_(fit_patches(points, patches, context)),
        features_(trace_patch_features(points, patches, fits_, context)),
        borders_(patches.count) {
    for (std::size_t c = 0; c < features_.curves.size(); ++c) {
      const TracedCurve& curve = features_.curves[c];
      for (const int p : curve.patches) {
        borders_[p].points.insert(borders_[p].points.end(), curve.points.begin(), curve.points.end());
        borders_[p].curves.resize(borders_[p].points.size(), static_cast<int>(c));
      }
    }
    for (PatchBorder& border : borders_)
      if (!border.points.empty()) border.tree.emplace(border.points);
    for (std::size_t c = 0; c < features_.corners.size(); ++c) {
      terms_.push_back(terms_of(static_cast<int>(c)));
      if (terms_.back().empty()) continue;
      for (const int p : features_.corners[c].patches) borders_[p].corners.push_back(static_cast<int>(c));
    }
    place_feet(points, patches);
  }

  const TracedFeatures& features() const { return features_; }
  int n_patches() const { return static_cast<int>(fits_.size()); }
  double patch(int p, const Vec3& x, Vec3* g, Mat3* H) const { return fits_[p].evaluate(x, g, H); }

  ActivePatch psi(const Vec3& x) const {
    std::array<Neighbour, 1> room;
    const Neighbour nearest = tree_->k_nearest(x, room)[0];
    return psi(x, patch_[nearest.point], nearest.distance2);
  }

 private:
  /// psi, where the nearest foot is one on patch p.
  ActivePatch psi(const Vec3& x, int p, double distance2) const {
    const PatchBorder& border = borders_[p];
    if (const int corner = nearest_corner(border, x, distance2); corner >= 0) return at_corner(corner, x);
    if (border.tree) {
      std::array<Neighbour, 1> room;
      const Neighbour on = border.tree->k_nearest(x, room)[0];
      if (on.distance2 <= distance2 + square(kNearCurve * s_)) return at_curve(border.curves[on.point], x);
    }
    return {value(p, x), p};
  }

  /// The feet of the samples on their patches. Those of outliers are far away, or far from other samples of the patch,
  /// and those beyond the curves of their patch are not on the boundary: all of these are left out.
  void place_feet(const std::vector<Vec3>& points, const SamplePatches& patches) {
    std::vector<Vec3> feet;
    const NeighbourTree samples(points);
    const auto has_company = [&](std::size_t i) {
      int n = 0;
      samples.within(points[i], square(kAlone * s_),
                     [&](std::uint32_t j, double) { n += patches.patch[j] == patches.patch[i] ? 1 : 0; });
      return n > kCompany;  // the sample itself is one
    };
    const double farthest = std::max(kFarthestFoot * s_, kNoises * patches.noise);
    for (std::size_t i = 0; i < points.size(); ++i) {
      Vec3 x = points[i];
      for (int k = 0; k < kSteps; ++k) {
        Vec3 g;
        const double f = patch(patches.patch[i], x, &g, nullptr);
        x -= f / g.squaredNorm() * g;
      }
      if (!((x - points[i]).norm() <= farthest) || !has_company(i)) continue;
      if (!(std::abs(psi(x, patches.patch[i], 0).value) <= kOnBoundary * s_)) continue;
      feet.push_back(x);
      patch_.push_back(patches.patch[i]);
    }
    if (feet.empty()) {  // curves that contradict all samples
      feet = points;
      patch_ = patches.patch;
    }
    tree_.emplace(feet);
  }

  double value(int p, const Vec3& x) const { return fits_[p].evaluate(x, nullptr, nullptr); }

  int nearest_corner(const PatchBorder& border, const Vec3& x, double distance2) const {
    int best = -1;
    double least = distance2 + square(kNearCorner * s_);
    for (const int c : border.corners) {
      const double d = (features_.corners[c].place - x).squaredNorm();
      if (d > least) continue;
      least = d;
      best = c;
    }
    return best;
  }

  ActivePatch at_curve(int c, const Vec3& x) const {
    const TracedCurve& curve = features_.curves[c];
    const auto [p, q] = curve.patches;
    const double f = value(p, x), g = value(q, x);
    return (f < g) == curve.is_convex ? ActivePatch{g, q} : ActivePatch{f, p};
  }

  ActivePatch at_corner(int c, const Vec3& x) const {
    const std::vector<int>& patches = features_.corners[c].patches;
    std::array<double, 32> f;
    for (std::size_t k = 0; k < patches.size(); ++k) f[k] = value(patches[k], x);
    ActivePatch psi{std::numeric_limits<double>::infinity(), patches[0]};
    for (const std::uint32_t term : terms_[c]) {
      ActivePatch most{-std::numeric_limits<double>::infinity(), patches[0]};
      for (std::size_t k = 0; k < patches.size(); ++k)
        if ((term >> k & 1) != 0 && f[k] > most.value) most = {f[k], patches[k]};
      if (most.value < psi.value) psi = most;
    }
    return psi;
  }

  std::vector<std::uint32_t> terms_of(int c) const {
    const TracedCorner& corner = features_.corners[c];
    std::vector<Vec3> normals;
    for (const int p : corner.patches) {
      Vec3 g;
      patch(p, corner.place, &g, nullptr);
      normals.push_back(g.normalized());
    }
    const auto number = [&](int p) {
      return static_cast<int>(std::lower_bound(corner.patches.begin(), corner.patches.end(), p) -
                              corner.patches.begin());
    };
    std::vector<CornerRay> rays;
    for (const TracedCurve& curve : features_.curves)
      for (int end = 0; end < 2; ++end) {
        if (curve.ends[end] != c) continue;
        rays.push_back({direction(curve, end), {number(curve.patches[0]), number(curve.patches[1])}, curve.is_convex});
      }
    return corner_terms(normals, rays);
  }

  /// From an end of a curve to the point a spacing away.
  Vec3 direction(const TracedCurve& curve, int end) const {
    const auto n = curve.points.size();
    const Vec3& from = end == 0 ? curve.points.front() : curve.points.back();
    std::size_t k = 1;
    while (k + 1 < n / 2 && ((end == 0 ? curve.points[k] : curve.points[n - 1 - k]) - from).norm() < s_) ++k;
    return ((end == 0 ? curve.points[k] : curve.points[n - 1 - k]) - from).normalized();
  }

  double s_;
  std::vector<PatchFit> fits_;
  TracedFeatures features_;
  std::vector<PatchBorder> borders_;               ///< per patch
  std::optional<NeighbourTree> tree_;              ///< of the feet of samples
  std::vector<int> patch_;                         ///< of each
  std::vector<std::vector<std::uint32_t>> terms_;  ///< per corner; empty where there is no table
};

/// Patches with the ones joined whose borders are not sharp.
SamplePatches joined(const SamplePatches& patches) {
  DisjointSets sets(patches.count);
  for (const SamplePatches::Border& b : patches.borders)
    if (!b.sharp) sets.unite(b.a, b.b);
  std::vector<int> number(patches.count, -1);
  SamplePatches made = patches;
  made.count = 0;
  for (int p = 0; p < patches.count; ++p) {
    int& n = number[sets.find(p)];
    if (n < 0) n = made.count++;
  }
  const auto of = [&](int p) { return number[sets.find(p)]; };
  for (int& p : made.patch) p = of(p);
  std::erase_if(made.borders, [&](const SamplePatches::Border& b) { return !b.sharp || of(b.a) == of(b.b); });
  for (SamplePatches::Border& b : made.borders) std::tie(b.a, b.b) = std::minmax(of(b.a), of(b.b));
  return made;
}

FeatureGraph graph_of(const TracedFeatures& features) {
  FeatureGraph graph;
  for (const TracedCorner& c : features.corners) graph.corners.push_back({c.place, c.patches});
  for (const TracedCurve& c : features.curves) {
    FeatureCurve curve;
    curve.patches = c.patches;
    curve.ends = c.ends;
    curve.points = c.points;
    curve.angle_deg = c.angle_deg;
    curve.arc = {0};
    for (std::size_t k = 1; k < c.points.size(); ++k)
      curve.arc.push_back(curve.arc.back() + (c.points[k] - c.points[k - 1]).norm());
    graph.curves.push_back(std::move(curve));
  }
  return graph;
}

}  // namespace

std::optional<CloudDomain> cloud_domain(const std::vector<Vec3>& points, const SamplePatches& patches,
                                        const Context& context) {
  const SamplePatches all = joined(patches);
  if (all.count < 2 || all.borders.empty()) return std::nullopt;
  const auto surface = std::make_shared<const CloudSurface>(points, all, context);
  std::vector<PatchFunction> functions;
  functions.reserve(static_cast<std::size_t>(surface->n_patches()));
  for (int p = 0; p < surface->n_patches(); ++p)
    functions.push_back([surface, p](const Vec3& x, Vec3* g, Mat3* H) { return surface->patch(p, x, g, H); });
  return CloudDomain{
      PiecewiseDomain::of_patches(std::move(functions), [surface](const Vec3& x) { return surface->psi(x); }),
      graph_of(surface->features()), surface->features().broken};
}

}  // namespace umtet
