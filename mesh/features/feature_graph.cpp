#include "mesh/features/feature_graph.h"

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

namespace umtet {
namespace {

constexpr double kSeedReach = 2.5;    // in h: patches nearer than this to a seed are tried in pairs
constexpr double kLeft = 4;           // in h: a curve this far from all seeds has left the body
constexpr double kStep = .2;          // in h, along a curve: the sagitta at a radius of h is .005 h
constexpr double kSameCurve = .2;     // in h
constexpr double kSameCorner = 1e-3;  // in h
constexpr double kAtCorner = 1e-4;    // in h: a patch nearer than this to a corner found by bisection takes part in it
constexpr double kArrived = 1e-12;    // in h
constexpr int kMostNewton = 40;
constexpr int kMostPoints = 1 << 18;  // of one curve
constexpr int kBisections = 40;
constexpr int kMostPatchesOfCorner = 12;  // 2^12 sign combinations are looked at
constexpr double kParallel = 1e-4;        // sine of the angle of two patches that touch

/// What is around a curve: the regions of the four sign combinations of its patches.
struct Quadrants {
  std::array<int, 4> region;  ///< of the signs (-, -), (+, -), (-, +), (+, +)
  bool operator==(const Quadrants&) const = default;
  bool depends_on_both() const {
    const bool on_first = region[0] != region[1] || region[2] != region[3];
    const bool on_second = region[0] != region[2] || region[1] != region[3];
    return on_first && on_second;
  }
  bool alternates() const { return region[0] == region[3] && region[1] == region[2] && region[0] != region[1]; }
  bool is_sharp() const { return depends_on_both() && !alternates(); }
};

class Tracer {
 public:
  Tracer(const PiecewiseDomain& domain, const std::vector<Vec3>& seeds, double h)
      : domain_(domain), h_(h), values_(domain.n_patches()) {
    for (const Vec3& x : seeds) box_.extend(x);
    box_.min().array() -= kLeft * h;
    box_.max().array() += kLeft * h;
  }

  void seed(const Vec3& x) {
    std::vector<int> near;
    for (int p = 0; p < domain_.n_patches(); ++p) {
      Vec3 g;
      const double f = domain_.patch(p, x, &g), slope = g.norm();
      if (std::abs(f) < kSeedReach * h_ * slope) near.push_back(p);
    }
    for (std::size_t i = 0; i < near.size(); ++i)
      for (std::size_t j = i + 1; j < near.size(); ++j) seed(x, {near[i], near[j]});
  }

  /// Curves that begin at corners and are too short to be found by a seed.
  void complete_corners() {
    for (std::size_t c = 0; c < graph_.corners.size(); ++c) {  // the list grows
      const FeatureCorner corner = graph_.corners[c];
      for (std::size_t i = 0; i < corner.patches.size(); ++i) {
        for (std::size_t j = i + 1; j < corner.patches.size(); ++j) {
          const std::array<int, 2> pair = {corner.patches[i], corner.patches[j]};
          const std::optional<Vec3> along = tangent(pair, corner.place);
          if (!along) continue;
          for (const double sign : {-1., 1.}) seed(corner.place + sign * kStep / 2 * h_ * *along, pair);
        }
      }
    }
  }

  FeatureGraph graph() { return std::move(graph_); }

 private:
  void seed(const Vec3& x, const std::array<int, 2>& pair) {
    Vec3 y = x;
    if (!correct(pair, y) || (y - x).norm() > 2 * kSeedReach * h_) return;
    const Quadrants around = quadrants(pair, y);
    if (!around.depends_on_both() || is_known(pair, y)) return;
    if (around.alternates()) {
      report_once({FeatureDefect::Kind::TwoSheets, -1, -1, y});
      return;
    }
    trace(pair, y, around);
  }

  bool is_known(const std::array<int, 2>& pair, const Vec3& x) const {
    return std::any_of(graph_.curves.begin(), graph_.curves.end(), [&](const FeatureCurve& c) {
      return c.patches == pair && c.nearest(x).distance < kSameCurve * h_;
    });
  }

  void report_once(const FeatureDefect& defect) {
    const bool is_new = std::none_of(graph_.defects.begin(), graph_.defects.end(), [&](const FeatureDefect& d) {
      return d.kind == defect.kind && (d.where - defect.where).norm() < 2 * h_;
    });
    if (is_new) graph_.defects.push_back(defect);
  }

  /// Newton's method with the shortest steps, to f_p = 0 for these patches.
  template <class Patches>
  bool correct(const Patches& patches, Vec3& x) const {
    const auto n = static_cast<Eigen::Index>(patches.size());
    Eigen::Matrix<double, Eigen::Dynamic, 3, 0, kMostPatchesOfCorner, 3> J(n, 3);
    Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostPatchesOfCorner, 1> f(n);
    for (int k = 0; k < kMostNewton; ++k) {
      for (Eigen::Index i = 0; i < n; ++i) {
        Vec3 g;
        f[i] = domain_.patch(patches[i], x, &g);
        const double slope = g.norm();
        if (!(slope > 0) || !std::isfinite(f[i])) return false;
        f[i] /= slope;
        J.row(i) = g.transpose() / slope;
      }
      if (n == 2 && !(J.row(0).cross(J.row(1)).norm() > kParallel)) return false;
      Vec3 step;
      if (n == 2) {
        const double c = J.row(0).dot(J.row(1)), det = 1 - c * c;
        step = -((f[0] - c * f[1]) / det * J.row(0) + (f[1] - c * f[0]) / det * J.row(1)).transpose();
      } else {
        step = -J.completeOrthogonalDecomposition().solve(f);
      }
      const double length = step.norm();
      if (!std::isfinite(length)) return false;
      if (length > h_) step *= h_ / length;
      x += step;
      if (length < kArrived * h_ + 1e-15 * x.norm()) return n <= 3 || f.cwiseAbs().maxCoeff() < kAtCorner * h_;
    }
    return false;
  }

  std::optional<Vec3> tangent(const std::array<int, 2>& pair, const Vec3& x) const {
    Vec3 a, b;
    domain_.patch(pair[0], x, &a);
    domain_.patch(pair[1], x, &b);
    const Vec3 t = a.normalized().cross(b.normalized());
    const double sine = t.norm();
    if (!(sine > kParallel)) return std::nullopt;
    return Vec3(t / sine);
  }

  Quadrants quadrants(const std::array<int, 2>& pair, const Vec3& x) {
    for (int p = 0; p < domain_.n_patches(); ++p) values_[p] = domain_.patch(p, x);
    // Larger than any value would do: max and min of signs decide.
    for (double& v : values_) v = v < 0 ? -1 : 1;
    Quadrants q;
    for (int k = 0; k < 4; ++k) {
      values_[pair[0]] = (k & 1) != 0 ? 1 : -1;
      values_[pair[1]] = (k & 2) != 0 ? 1 : -1;
      q.region[k] = domain_.region(values_);
    }
    return q;
  }

  /// Dihedral angle of the region inside. \pre sharp
  double angle_deg(const std::array<int, 2>& pair, const Vec3& x, const Quadrants& q) const {
    const auto n_inside = std::count_if(q.region.begin(), q.region.end(), [](int r) { return r != 0; });
    // The quadrant that is alone, inside or outside.
    int alone = 0;
    for (int k = 0; k < 4; ++k)
      if ((q.region[k] != 0) == (n_inside == 1)) alone = k;
    Vec3 a, b;
    domain_.patch(pair[0], x, &a);
    domain_.patch(pair[1], x, &b);
    a.normalize(), b.normalize();
    if ((alone & 1) != 0) a = -a;
    if ((alone & 2) != 0) b = -b;
    // Outward normals of the quadrant a, b < 0.
    const double angle = (std::numbers::pi - std::atan2(a.cross(b).norm(), a.dot(b))) * 180 / std::numbers::pi;
    return n_inside == 1 ? angle : 360 - angle;
  }

  void trace(const std::array<int, 2>& pair, const Vec3& start, const Quadrants& around) {
    FeatureCurve curve;
    curve.patches = pair;
    std::vector<Vec3> forth = {start}, back;
    const std::optional<int> last = follow(pair, around, 1, forth, true);
    if (!last) return;  // a defect has been reported
    curve.ends[1] = *last;
    if (*last >= 0) {
      back = {start};
      const std::optional<int> first = follow(pair, around, -1, back, false);
      if (!first) return;
      curve.ends[0] = *first;
      back.erase(back.begin());
    }
    curve.points.assign(back.rbegin(), back.rend());
    curve.points.insert(curve.points.end(), forth.begin(), forth.end());
    if (curve.points.size() < 2) return;
    curve.arc = {0};
    for (std::size_t k = 1; k < curve.points.size(); ++k)
      curve.arc.push_back(curve.arc.back() + (curve.points[k] - curve.points[k - 1]).norm());
    for (const Vec3& x : curve.points) curve.angle_deg.push_back(angle_deg(pair, x, around));
    graph_.curves.push_back(std::move(curve));
  }

  /// Appends points until the curve ends. Returns its corner, -1 if it is closed, or nothing if it cannot be followed.
  std::optional<int> follow(const std::array<int, 2>& pair, const Quadrants& around, int direction,
                            std::vector<Vec3>& points, bool may_close) {
    const Vec3 start = points.front();
    double travelled = 0;
    const auto lost = [&](const Vec3& x) {
      report_once({FeatureDefect::Kind::NotTraced, -1, -1, x});
      return std::optional<int>();
    };
    while (static_cast<int>(points.size()) < kMostPoints) {
      const Vec3 x = points.back();
      const std::optional<Vec3> along = tangent(pair, x);
      if (!along) return lost(x);
      double step = direction * kStep * h_;
      Vec3 next;
      bool is_found = false;
      for (int halving = 0; halving < 8 && !is_found; ++halving, step /= 2) {
        next = x + step * *along;
        is_found =
            correct(pair, next) && (next - x).dot(*along) * direction > 0 && (next - x).norm() < 2 * std::abs(step);
        // A turn by more than 30 degrees in one step needs a shorter one.
        const std::optional<Vec3> there = is_found ? tangent(pair, next) : std::nullopt;
        is_found = there && there->dot(*along) > .85;
      }
      if (!is_found || !box_.contains(next)) return lost(x);
      if (!(quadrants(pair, next) == around)) {
        const int corner = end_between(pair, around, x, next);
        if (corner < 0) return lost(x);
        points.push_back(graph_.corners[corner].place);
        return corner;
      }
      travelled += (next - x).norm();
      if (may_close && travelled > 3 * kStep * h_ && (next - start).norm() < 1.01 * (next - x).norm() &&
          (start - x).dot(next - x) > 0) {
        if ((start - next).dot(next - x) > .2 * (next - x).squaredNorm()) points.push_back(next);
        points.push_back(start);
        return -1;
      }
      points.push_back(next);
    }
    return lost(points.back());
  }

  int end_between(const std::array<int, 2>& pair, const Quadrants& around, Vec3 a, Vec3 b) {
    for (int k = 0; k < kBisections && (b - a).norm() > 1e-9 * h_; ++k) {
      Vec3 middle = (a + b) / 2;
      if (!correct(pair, middle)) return -1;
      (quadrants(pair, middle) == around ? a : b) = middle;
    }
    std::vector<int> near;
    for (int p = 0; p < domain_.n_patches(); ++p) {
      Vec3 g;
      const double f = domain_.patch(p, b, &g);
      if (p == pair[0] || p == pair[1] || std::abs(f) < kAtCorner * h_ * g.norm()) near.push_back(p);
    }
    near = those_that_matter(near, b);
    for (const int p : pair)
      if (std::find(near.begin(), near.end(), p) == near.end()) near.push_back(p);
    std::sort(near.begin(), near.end());
    if (near.size() < 3 || near.size() > kMostPatchesOfCorner) return -1;
    Vec3 place = b;
    if (!correct(near, place) || (place - b).norm() > kStep * h_) return -1;
    for (std::size_t c = 0; c < graph_.corners.size(); ++c)
      if ((graph_.corners[c].place - place).norm() < kSameCorner * h_) return static_cast<int>(c);
    graph_.corners.push_back({place, near});
    return static_cast<int>(graph_.corners.size()) - 1;
  }

  /// Those of some patches through a point whose signs change the region there.
  std::vector<int> those_that_matter(const std::vector<int>& near, const Vec3& x) {
    if (near.size() > kMostPatchesOfCorner) return near;
    for (int p = 0; p < domain_.n_patches(); ++p) values_[p] = domain_.patch(p, x) < 0 ? -1 : 1;
    std::vector<int> region(std::size_t{1} << near.size());
    for (std::size_t signs = 0; signs < region.size(); ++signs) {
      for (std::size_t k = 0; k < near.size(); ++k) values_[near[k]] = (signs >> k & 1) != 0 ? 1 : -1;
      region[signs] = domain_.region(values_);
    }
    std::vector<int> matter;
    for (std::size_t k = 0; k < near.size(); ++k) {
      bool does = false;
      for (std::size_t signs = 0; signs < region.size(); ++signs)
        does |= region[signs] != region[signs ^ (std::size_t{1} << k)];
      if (does) matter.push_back(near[k]);
    }
    return matter;
  }

  const PiecewiseDomain& domain_;
  const double h_;
  Eigen::AlignedBox3d box_;  ///< a curve that leaves it is no longer followed
  std::vector<double> values_;
  FeatureGraph graph_;
};

}  // namespace

const char* to_string(FeatureDefect::Kind kind) {
  switch (kind) {
    case FeatureDefect::Kind::NotTraced:
      return "a curve breaks off";
    case FeatureDefect::Kind::TwoSheets:
      return "two sheets cross";
    case FeatureDefect::Kind::NoPath:
      return "no path of edges";
    case FeatureDefect::Kind::NoCorner:
      return "no vertex for a corner";
    case FeatureDefect::Kind::WrongPatch:
      return "a path between wrong patches";
    case FeatureDefect::Kind::NotOnStratum:
      return "a vertex is not on its stratum";
  }
  return "";
}

FeatureCurve::Place FeatureCurve::nearest(const Vec3& x) const {
  Place best{std::numeric_limits<double>::infinity(), 0};
  for (std::size_t k = 0; k + 1 < points.size(); ++k) {
    const Vec3 d = points[k + 1] - points[k];
    const double t = std::clamp((x - points[k]).dot(d) / d.squaredNorm(), 0., 1.);
    const double distance = (x - points[k] - t * d).squaredNorm();
    if (distance < best.distance) best = {distance, arc[k] + t * (arc[k + 1] - arc[k])};
  }
  best.distance = std::sqrt(best.distance);
  return best;
}

Vec3 FeatureCurve::at(double s) const {
  const auto after = std::upper_bound(arc.begin() + 1, arc.end() - 1, s) - arc.begin();
  const double t = (s - arc[after - 1]) / (arc[after] - arc[after - 1]);
  return points[after - 1] + t * (points[after] - points[after - 1]);
}

double FeatureCurve::angle_deg_at(double s) const {
  const auto after = std::upper_bound(arc.begin() + 1, arc.end() - 1, s) - arc.begin();
  const double t = std::clamp((s - arc[after - 1]) / (arc[after] - arc[after - 1]), 0., 1.);
  return angle_deg[after - 1] + t * (angle_deg[after] - angle_deg[after - 1]);
}

FeatureGraph trace_features(const PiecewiseDomain& domain, const std::vector<Vec3>& seeds, double h,
                            const Context& context) {
  Tracer tracer(domain, seeds, h);
  if (domain.n_patches() < 2) return tracer.graph();
  for (std::size_t k = 0; k < seeds.size(); ++k) {
    if (k % 1024 == 0) context.poll();
    tracer.seed(seeds[k]);
  }
  tracer.complete_corners();
  return tracer.graph();
}

}  // namespace umtet
