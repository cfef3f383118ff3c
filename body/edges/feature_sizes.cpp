#include "body/edges/feature_sizes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "common/polled_loops.h"
#include "mesh/core/polyline.h"
#include "reconstruct/triangles/body_thickness.h"
#include "reconstruct/triangles/edge_uses.h"
#include "reconstruct/triangles/face_patches.h"
#include "reconstruct/triangles/triangle_samples.h"
#include "reconstruct/triangles/triangle_tree.h"

namespace umtet {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Samples of the surface for its thickness.
constexpr double kSamples = 20000;
// Edges of a closed curve: fewer turn by more than 52 degrees each.
constexpr double kEdgesOfLoop = 7;
// A fillet of a smaller radius than this many deviations is not resolved: a chord of 90 degrees is .41 radii from the
// corner of its tangents.
constexpr double kRoundedFillet = 1;
// Two points of a curve are at a neck if the way along the curve is this many times their distance: half a circle is
// 1.57 times its diameter.
constexpr double kAlongNeck = 3;
constexpr double kHere = 1e-6;  // of the length: nearer than this along the curve is the point itself
// Curves are looked at in steps of this share of the size there.
constexpr double kStep = .5;
constexpr std::size_t kPerPoll = 64;

class FeatureSizes {
 public:
  FeatureSizes(const TriangleMesh& mesh, const SharpEdges& edges, const FeatureGraph& graph,
               const FeatureSizeParams& params)
      : mesh_(mesh), edges_(edges), graph_(graph), params_(params) {}

  std::vector<SizeSource> operator()(const Context& context) {
    of_thickness(context);
    of_turn();
    of_curves(context);
    return std::move(sources_);
  }

 private:
  void add(const Vec3& x, double size, double extent = 0) {
    const double h = std::clamp(size, params_.h_min, params_.h);
    sources_.push_back({x, h, std::max(params_.constant_layer * h, extent)});
  }

  void of_thickness(const Context& context) {
    double area = 0;
    for (std::size_t f = 0; f < mesh_.F.size(); ++f) area += mesh_.area_vector(f).norm();
    const double spacing = std::sqrt(area / kSamples);
    const TriangleSamples samples = sample_triangles(mesh_, spacing, 0, context);
    const std::vector<double> t = sheet_thickness(mesh_, TriangleTree(mesh_), samples.points, samples.faces,
                                                  params_.edges_across * params_.h, context);
    for (std::size_t i = 0; i < t.size(); ++i) add(samples.points[i], t[i] / params_.edges_across, spacing);
  }

  /// Across the edges of smooth patches: the turn over the height of the wider triangle. A narrow triangle beside a wide
  /// one is a matter of the triangulation.
  void of_turn() {
    const std::vector<EdgeUse> uses = edge_uses(mesh_, welded(mesh_.V, find_patches(mesh_).weld_distance));
    for_each_edge(uses, [&](std::size_t begin, std::size_t end) {
      if (end - begin != 2) return;
      const std::size_t f = uses[begin].face, g = uses[begin + 1].face;
      if (edges_.patch[f] != edges_.patch[g]) return;
      const Vec3 &a = mesh_.V[uses[begin].low], &b = mesh_.V[uses[begin].high];
      const Vec3 m = mesh_.area_vector(f), n = mesh_.area_vector(g);
      const double turn = std::atan2(m.cross(n).norm(), m.dot(n)), length = (b - a).norm();
      const double apart = 2 * std::max(m.norm(), n.norm()) / length;
      if (!(turn > 0)) return;
      const double curvature = turn / apart;
      if (curvature * kRoundedFillet * params_.deviation > 1) return;
      const double size = std::min(params_.max_turn / curvature, std::sqrt(8 * params_.deviation / curvature));
      if (!(size < params_.h)) return;
      const auto n_points = static_cast<int>(std::ceil(length / std::max(size, params_.h_min)));
      for (int k = 0; k <= n_points; ++k) add(a + k * (b - a) / n_points, size, apart);
    });
  }

  bool are_adjacent(const FeatureCurve& a, const FeatureCurve& b) const {
    if (a.is_closed() || b.is_closed()) return false;
    return a.ends[0] == b.ends[0] || a.ends[0] == b.ends[1] || a.ends[1] == b.ends[0] || a.ends[1] == b.ends[1];
  }

  /// Distance from x to the nearest point of its own curve that is much farther along the curve: infinite if the curve
  /// has no neck at x.
  static double neck(const Polyline& line, bool is_closed, const Vec3& x, double s) {
    const std::vector<Vec3>& points = line.points();
    double least = kInfinity;
    for (std::size_t k = 0; k + 1 < points.size(); ++k) {
      const Vec3 d = points[k + 1] - points[k];
      const double t = std::clamp((x - points[k]).dot(d) / d.squaredNorm(), 0., 1.);
      const double distance = (x - points[k] - t * d).norm(), arc = line.arc()[k] + t * d.norm();
      double along = std::abs(arc - s);
      if (is_closed) along = std::min(along, line.length() - along);
      if (along > std::max(kAlongNeck * distance, kHere * line.length())) least = std::min(least, distance);
    }
    return least;
  }

  void of_curves(const Context& context) {
    const std::size_t n = graph_.curves.size();
    std::vector<Polyline> lines;
    std::vector<Eigen::AlignedBox3d> boxes(n);
    for (std::size_t c = 0; c < n; ++c) {
      lines.emplace_back(graph_.curves[c].points);
      for (const Vec3& x : graph_.curves[c].points) boxes[c].extend(x);
    }
    std::vector<std::vector<SizeSource>> found(n);
    polled_parallel_for(n, kPerPoll, context, [&](std::size_t c) {
      const FeatureCurve& curve = graph_.curves[c];
      const double length = lines[c].length();
      const double own = curve.is_closed() ? length / kEdgesOfLoop : length / params_.edges_across;
      for (double s = 0; s <= length;) {
        const Vec3 x = lines[c].at(s);
        double nearest = kInfinity;
        for (std::size_t other = 0; other < n; ++other) {
          if (other == c || are_adjacent(curve, graph_.curves[other])) continue;
          if (boxes[other].exteriorDistance(x) < nearest) nearest = std::min(nearest, lines[other].nearest(x).distance);
        }
        nearest = std::min(nearest, neck(lines[c], curve.is_closed(), x, s));
        const double h = std::clamp(std::min(own, nearest / params_.edges_across), params_.h_min, params_.h);
        found[c].push_back({x, h, params_.constant_layer * h});
        if (s == length) break;
        s = std::min(length, s + kStep * h);
      }
    });
    for (const auto& some : found) sources_.insert(sources_.end(), some.begin(), some.end());
  }

  const TriangleMesh& mesh_;
  const SharpEdges& edges_;
  const FeatureGraph& graph_;
  const FeatureSizeParams& params_;
  std::vector<SizeSource> sources_;
};

}  // namespace

std::vector<SizeSource> feature_sizes(const TriangleMesh& mesh, const SharpEdges& edges, const FeatureGraph& graph,
                                      const FeatureSizeParams& params, const Context& context) {
  return FeatureSizes(mesh, edges, graph, params)(context);
}

}  // namespace umtet
