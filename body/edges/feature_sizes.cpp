#include "body/edges/feature_sizes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>

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
// Side of the cubes in which the curvature is measured, in spacings of the samples: of a plane they have nine.
constexpr double kCube = 3;
constexpr double kFewestSamples = 4.5;
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
               const std::vector<double>& curvature, const FeatureSizeParams& params)
      : mesh_(mesh), edges_(edges), graph_(graph), curvature_(curvature), params_(params) {}

  std::vector<SizeSource> operator()(const Context& context) {
    sample(context);
    of_thickness(context);
    of_curvature();
    of_curves(context);
    return std::move(sources_);
  }

 private:
  void add(const Vec3& x, double size, double extent = 0) {
    const double h = std::clamp(size, params_.h_min, params_.h);
    sources_.push_back({x, h, std::max(params_.constant_layer * h, extent)});
  }

  void sample(const Context& context) {
    double area = 0;
    for (std::size_t f = 0; f < mesh_.F.size(); ++f) area += mesh_.area_vector(f).norm();
    spacing_ = std::sqrt(area / kSamples);
    cube_ = kCube * spacing_;
    samples_ = sample_triangles(mesh_, spacing_, 0, context);
    area_of_sample_ = area / static_cast<double>(samples_.points.size());
  }

  void of_thickness(const Context& context) {
    const std::vector<double> t = sheet_thickness(mesh_, TriangleTree(mesh_), samples_.points, samples_.faces,
                                                  params_.edges_across * params_.h, context);
    for (std::size_t i = 0; i < t.size(); ++i) add(samples_.points[i], t[i] / params_.edges_across, spacing_);
  }

  double by_curvature(double curvature) const {
    if (!(curvature > 0)) return kInfinity;
    return std::min(params_.max_turn / curvature, std::sqrt(8 * params_.deviation / curvature));
  }

  /// Turn times length, and area, of the cubes that samples of a smooth patch lie in.
  struct Cube {
    double turn = 0, area = 0;
  };
  using Key = std::array<std::int64_t, 4>;  // patch, and three coordinates
  Key key_of(std::size_t patch, const Vec3& x) const {
    const Eigen::Array3d at = (x / cube_).array().floor();
    return {static_cast<std::int64_t>(patch), static_cast<std::int64_t>(at[0]), static_cast<std::int64_t>(at[1]),
            static_cast<std::int64_t>(at[2])};
  }

  void of_curvature() {
    std::map<Key, Cube> cubes;
    for (std::size_t i = 0; i < samples_.points.size(); ++i)
      cubes[key_of(edges_.patch[samples_.faces[i]], samples_.points[i])].area += area_of_sample_;
    const std::vector<EdgeUse> uses = edge_uses(mesh_, welded(mesh_.V, find_patches(mesh_).weld_distance));
    for_each_edge(uses, [&](std::size_t begin, std::size_t end) {
      if (end - begin != 2) return;
      const std::size_t f = uses[begin].face, g = uses[begin + 1].face;
      if (edges_.patch[f] != edges_.patch[g]) return;
      const Vec3 &a = mesh_.V[uses[begin].low], &b = mesh_.V[uses[begin].high];
      const Vec3 m = mesh_.area_vector(f), n = mesh_.area_vector(g);
      const double turn = std::atan2(m.cross(n).norm(), m.dot(n)), length = (b - a).norm();
      const auto n_parts = static_cast<int>(std::ceil(2 * length / cube_));
      for (int k = 0; k < n_parts; ++k) {
        const auto at = cubes.find(key_of(edges_.patch[f], a + (k + .5) / n_parts * (b - a)));
        if (at != cubes.end()) at->second.turn += turn * length / n_parts;
      }
    });
    for (std::size_t i = 0; i < samples_.points.size(); ++i) {
      const std::size_t patch = edges_.patch[samples_.faces[i]];
      const Cube& cube = cubes.at(key_of(patch, samples_.points[i]));
      const double known = patch < curvature_.size() ? curvature_[patch] : -1;
      // A cube that the patch hardly meets has too few samples to measure its area.
      const double area = std::max(cube.area, kFewestSamples * area_of_sample_);
      const double size = by_curvature(known >= 0 ? known : cube.turn / area);
      if (size < params_.h) add(samples_.points[i], size, known >= 0 ? spacing_ : cube_);
    }
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
  const std::vector<double>& curvature_;
  const FeatureSizeParams& params_;
  TriangleSamples samples_;
  double spacing_ = 0, cube_ = 0, area_of_sample_ = 0;
  std::vector<SizeSource> sources_;
};

}  // namespace

std::vector<SizeSource> feature_sizes(const TriangleMesh& mesh, const SharpEdges& edges, const FeatureGraph& graph,
                                      const std::vector<double>& curvature, const FeatureSizeParams& params,
                                      const Context& context) {
  return FeatureSizes(mesh, edges, graph, curvature, params)(context);
}

}  // namespace umtet
