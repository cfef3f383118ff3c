#include "reconstruct/patches/feature_tracing.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

#include "reconstruct/cloud/neighbours/neighbour_tree.h"
#include "reconstruct/patches/patch_zero_sets.h"

namespace umtet {
namespace {

// Lengths in spacings.
constexpr std::size_t kNear = 32;     // neighbours of a sample: within 3.2 s on a surface
constexpr double kPair = 1.75;        // distance of two samples that give a seed
constexpr double kSeedMoves = 2;      // to its curve, at most
constexpr double kCornerMoves = 3.5;  // from a sample nearby to the corner, at most
constexpr double kHasSamples = 3;     // every patch of a corner has samples within this distance: more in acute corners
constexpr double kHasSeeds = 2;       // a curve goes on while it has seeds within this distance
constexpr double kSameCorner = 1;     // two corners are one
constexpr double kCurveStep = .3;     // along a curve
constexpr double kTouches = .1;       // a curve and a corner
constexpr double kSameCurve = .6;     // a seed is on a curve that has been traced
constexpr double kFromCorner = 1;     // a seed nearer to a corner may be beyond the end of its curve
constexpr double kShort = .2;         // the same for curves between two corners near each other
constexpr double kToCorner = 3;  // a curve that breaks off within this distance of a corner of its patches ends there
constexpr int kHalvings = 6;
constexpr double kMostTurn = .966;  // cosine: 15 degrees a step
constexpr std::size_t kPerPoll = 256;

/// Points of the curves along a sharp border, each from two samples.
struct Seeds {
  std::vector<Vec3> places;
  std::vector<double> depth;  ///< of both samples below the patch of the other: > 0 at a convex curve
  std::optional<NeighbourTree> tree;
  bool has_within(double distance, const Vec3& x) const {
    std::array<Neighbour, 1> room;
    return tree && tree->k_nearest(x, room)[0].distance2 <= distance * distance;
  }
};

class PatchTracer {
 public:
  PatchTracer(const std::vector<Vec3>& points, const SamplePatches& patches, const std::vector<PatchFit>& fits)
      : points_(points), patches_(patches), zero_sets_(fits, patches.spacing), s_(patches.spacing), tree_(points) {
    for (const SamplePatches::Border& b : patches.borders)
      if (b.sharp && b.a != b.b) borders_[std::minmax(b.a, b.b)];
  }

  TracedFeatures operator()(const Context& context) {
    find_seeds(context);
    find_corners(context);
    for (const auto& [pair, border] : borders_) {
      context.poll();
      trace({pair.first, pair.second}, border);
    }
    join_broken_ends();
    drop_unused_corners();
    return std::move(made_);
  }

 private:
  bool has_samples(int patch, const Vec3& x, double within) const {
    bool has = false;
    tree_.within(x, within * within * s_ * s_, [&](std::uint32_t i, double) { has |= patches_.patch[i] == patch; });
    return has;
  }

  // --- corners

  void find_corners(const Context& context) {
    std::vector<TracedCorner> found;
    std::vector<Neighbour> room(kNear);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (i % kPerPoll == 0) context.poll();
      std::vector<int> near;
      for (const Neighbour& n : tree_.k_nearest(points_[i], room))
        if (n.distance2 < square(kHasSamples * s_)) near.push_back(patches_.patch[n.point]);
      std::sort(near.begin(), near.end());
      near.erase(std::unique(near.begin(), near.end()), near.end());
      if (near.size() < 3 || near.size() > kMostPatchesAtCorner) continue;
      for (std::size_t a = 0; a < near.size(); ++a)
        for (std::size_t b = a + 1; b < near.size(); ++b)
          for (std::size_t c = b + 1; c < near.size(); ++c) try_corner({near[a], near[b], near[c]}, points_[i], found);
    }
    join(found);
  }
  static double square(double x) { return x * x; }

  void try_corner(const std::array<int, 3>& triple, const Vec3& from, std::vector<TracedCorner>& found) const {
    for (const TracedCorner& c : found)
      if (std::equal(triple.begin(), triple.end(), c.patches.begin()) && (c.place - from).norm() < kCornerMoves * s_)
        return;
    Vec3 x = from;
    if (!zero_sets_.correct(triple, x, kCornerMoves * s_)) return;
    for (const int p : triple)
      if (!has_samples(p, x, kHasSamples)) return;
    if (curves_at(triple, x) < 2) return;
    for (const TracedCorner& c : found)
      if (std::equal(triple.begin(), triple.end(), c.patches.begin()) && (c.place - x).norm() < kTouches * s_) return;
    found.push_back({x, {triple.begin(), triple.end()}});
  }

  /// The number of pairs of three patches with seeds near a point.
  int curves_at(const std::array<int, 3>& triple, const Vec3& x) const {
    int n = 0;
    for (int k = 0; k < 3; ++k) {
      const auto at = borders_.find(std::minmax(triple[k], triple[(k + 1) % 3]));
      if (at != borders_.end() && at->second.has_within(kHasSeeds * s_, x)) ++n;
    }
    return n;
  }

  /// Corners that are near each other become one.
  void join(const std::vector<TracedCorner>& found) {
    std::vector<std::uint8_t> is_used(found.size(), 0);
    for (std::size_t i = 0; i < found.size(); ++i) {
      if (is_used[i]) continue;
      std::vector<std::size_t> group = {i};
      is_used[i] = 1;
      for (std::size_t g = 0; g < group.size(); ++g)
        for (std::size_t j = 0; j < found.size(); ++j)
          if (!is_used[j] && (found[j].place - found[group[g]].place).norm() < kSameCorner * s_) {
            is_used[j] = 1;
            group.push_back(j);
          }
      TracedCorner corner{Vec3::Zero(), {}};
      for (const std::size_t g : group) {
        corner.place += found[g].place / static_cast<double>(group.size());
        corner.patches.insert(corner.patches.end(), found[g].patches.begin(), found[g].patches.end());
      }
      std::sort(corner.patches.begin(), corner.patches.end());
      corner.patches.erase(std::unique(corner.patches.begin(), corner.patches.end()), corner.patches.end());
      if (corner.patches.size() > kMostPatchesAtCorner) continue;
      const Vec3 mean = corner.place;
      if (!zero_sets_.correct(corner.patches, corner.place, 2 * s_, &corner.off)) {
        corner.place = mean;
        for (const int p : corner.patches) {
          Vec3 normal;
          corner.off = std::max(corner.off, std::abs(zero_sets_.distance(p, mean, normal)));
        }
      }
      made_.corners.push_back(std::move(corner));
    }
  }

  // --- seeds

  void find_seeds(const Context& context) {
    std::vector<Neighbour> room(kNear);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      if (i % kPerPoll == 0) context.poll();
      const int a = patches_.patch[i];
      for (const Neighbour& n : tree_.k_nearest(points_[i], room)) {
        const int b = patches_.patch[n.point];
        if (b <= a || n.distance2 > square(kPair * s_)) continue;
        const auto border = borders_.find({a, b});
        if (border == borders_.end()) continue;
        Vec3 x = (points_[i] + points_[n.point]) / 2, normal;
        if (!zero_sets_.correct(std::array{a, b}, x, kSeedMoves * s_)) continue;
        border->second.places.push_back(x);
        border->second.depth.push_back(-zero_sets_.distance(a, points_[n.point], normal) -
                                       zero_sets_.distance(b, points_[i], normal));
      }
    }
    for (auto& [pair, seeds] : borders_)
      if (!seeds.places.empty()) seeds.tree.emplace(seeds.places);
  }

  // --- curves

  double from_corners(const std::array<int, 2>& pair, const Vec3& x) const {
    double least = std::numeric_limits<double>::infinity();
    for (const TracedCorner& c : made_.corners)
      if (has(c, pair)) least = std::min(least, (c.place - x).norm());
    return least;
  }
  static bool has(const TracedCorner& c, const std::array<int, 2>& pair) {
    return std::binary_search(c.patches.begin(), c.patches.end(), pair[0]) &&
           std::binary_search(c.patches.begin(), c.patches.end(), pair[1]);
  }

  void trace(const std::array<int, 2>& pair, const Seeds& seeds) {
    std::vector<std::uint8_t> is_done(seeds.places.size(), 0);
    for (const double least : {kFromCorner, kShort}) {
      for (std::size_t k = 0; k < is_done.size(); ++k) {
        if (is_done[k] || from_corners(pair, seeds.places[k]) < least * s_) continue;
        is_done[k] = 1;
        std::optional<TracedCurve> curve = curve_through(pair, seeds.places[k], seeds, least == kShort);
        if (!curve) continue;
        curve->is_convex = mark(*curve, seeds, is_done) > 0;
        for (const Vec3& x : curve->points) curve->angle_deg.push_back(zero_sets_.angle_deg(pair, x, curve->is_convex));
        made_.curves.push_back(std::move(*curve));
      }
    }
  }

  /// Marks the seeds on a curve. \return the sum of their depths
  double mark(const TracedCurve& curve, const Seeds& seeds, std::vector<std::uint8_t>& is_done) const {
    std::vector<std::uint32_t> on;
    for (const Vec3& x : curve.points)
      seeds.tree->within(x, square(kSameCurve * s_), [&](std::uint32_t k, double) { on.push_back(k); });
    std::sort(on.begin(), on.end());
    on.erase(std::unique(on.begin(), on.end()), on.end());
    double depth = 0;
    for (const std::uint32_t k : on) {
      is_done[k] = 1;
      depth += seeds.depth[k];
    }
    return depth;
  }

  /// The curve through a seed. @param needs_corners  whether a curve that does not end at two corners is none
  std::optional<TracedCurve> curve_through(const std::array<int, 2>& pair, const Vec3& seed, const Seeds& seeds,
                                           bool needs_corners) {
    TracedCurve curve;
    curve.patches = pair;
    std::vector<Vec3> forth = {seed}, back = {seed};
    End last = follow(pair, 1, seeds, forth);
    if (last.is_closed) {
      if (needs_corners) return std::nullopt;
      curve.points = std::move(forth);
      return curve;
    }
    End first = follow(pair, -1, seeds, back);
    if (needs_corners && (first.corner < 0 || last.corner < 0 || first.corner == last.corner)) return std::nullopt;
    if (first.corner < 0) first.corner = break_off(pair, back);
    if (last.corner < 0) last.corner = break_off(pair, forth);
    if (first.is_closed || back.size() + forth.size() < 4) return std::nullopt;
    curve.ends = {first.corner, last.corner};
    curve.points.assign(back.rbegin(), std::prev(back.rend()));
    curve.points.insert(curve.points.end(), forth.begin(), forth.end());
    return curve;
  }

  struct End {
    int corner = -1;
    bool is_closed = false;
  };

  /// Appends points until the curve closes, meets a corner or leaves the seeds.
  End follow(const std::array<int, 2>& pair, double direction, const Seeds& seeds, std::vector<Vec3>& points) {
    const Vec3 start = points.front();
    double length = 0;
    const std::size_t most = 20 * (seeds.places.size() + 100);
    while (points.size() < most) {
      const Vec3 x = points.back();
      const std::optional<Vec3> along = zero_sets_.tangent(pair, x);
      if (!along) return {};
      Vec3 next;
      double step = kCurveStep * s_;
      bool is_found = false;
      for (int halving = 0; halving < kHalvings && !is_found; ++halving, step /= 2) {
        next = x + direction * step * *along;
        if (!zero_sets_.correct(pair, next, step)) continue;
        const std::optional<Vec3> there = zero_sets_.tangent(pair, next);
        is_found = there && there->dot(*along) > kMostTurn && (next - x).dot(*along) * direction > step / 2;
      }
      if (!is_found) return {};
      if (const int corner = corner_between(pair, x, next, points.size() == 1); corner >= 0) {
        if ((points.back() - made_.corners[corner].place).norm() < kTouches * s_ && points.size() > 1)
          points.pop_back();
        points.push_back(made_.corners[corner].place);
        return {corner, false};
      }
      if (!seeds.has_within(kHasSeeds * s_, next)) return {};
      length += (next - x).norm();
      if (direction > 0 && length > 3 * kCurveStep * s_ && comes_back(x, next, start)) {
        if ((start - next).dot(next - x) > .2 * (next - x).squaredNorm()) points.push_back(next);
        points.push_back(start);
        return {-1, true};
      }
      points.push_back(next);
    }
    return {};
  }

  static bool comes_back(const Vec3& x, const Vec3& next, const Vec3& start) {
    return (next - start).norm() < 1.01 * (next - x).norm() && (start - x).dot(next - x) > 0;
  }

  /// The corner that a step of a curve passes; -1 if there is none.
  int corner_between(const std::array<int, 2>& pair, const Vec3& x, const Vec3& next, bool is_first) const {
    const Vec3 d = next - x;
    for (std::size_t c = 0; c < made_.corners.size(); ++c) {
      const TracedCorner& corner = made_.corners[c];
      if (!has(corner, pair)) continue;
      const double along = (corner.place - x).dot(d) / d.squaredNorm();
      if (along < (is_first ? 0 : -.5) || along > 1) continue;
      const double distance = (x + along * d - corner.place).norm();
      if (distance < kTouches * s_ + 2 * corner.off) return static_cast<int>(c);
    }
    return -1;
  }

  /// The corner at the end of a curve that leaves the seeds: one of its patches nearby, or a new one.
  int break_off(const std::array<int, 2>& pair, std::vector<Vec3>& points) {
    int best = -1;
    double least = kToCorner * s_;
    for (std::size_t c = 0; c < made_.corners.size(); ++c) {
      const double distance = (made_.corners[c].place - points.back()).norm();
      if (!has(made_.corners[c], pair) || distance > least) continue;
      least = distance;
      best = static_cast<int>(c);
    }
    if (best < 0) {
      best = static_cast<int>(made_.corners.size());
      made_.broken.push_back(best);
      made_.corners.push_back({points.back(), {pair[0], pair[1]}});
      return best;
    }
    cut_at(made_.corners[best].place, points);  // the curve runs past the corner as far as there are seeds
    return best;
  }

  /// Ends of curves that break off near each other, of three and more patches, are one corner if there is a common
  /// point of these patches.
  void join_broken_ends() {
    std::vector<int> left = made_.broken;
    made_.broken.clear();
    while (!left.empty()) {
      std::vector<int> group = {left.front()}, others;
      std::set<int> patches(corner(left.front()).patches.begin(), corner(left.front()).patches.end());
      Vec3 mean = corner(left.front()).place;
      for (std::size_t k = 1; k < left.size(); ++k) {
        if ((corner(left[k]).place - corner(group[0]).place).norm() > kToCorner * s_) {
          others.push_back(left[k]);
          continue;
        }
        group.push_back(left[k]);
        mean += corner(left[k]).place;
        patches.insert(corner(left[k]).patches.begin(), corner(left[k]).patches.end());
      }
      left = std::move(others);
      TracedCorner joint{mean / static_cast<double>(group.size()), {patches.begin(), patches.end()}};
      if (patches.size() < 3 || patches.size() > kMostPatchesAtCorner ||
          !zero_sets_.correct(joint.patches, joint.place, kCornerMoves * s_, &joint.off)) {
        made_.broken.insert(made_.broken.end(), group.begin(), group.end());
        continue;
      }
      made_.corners.push_back(joint);
      for (TracedCurve& c : made_.curves)
        for (int end = 0; end < 2; ++end)
          if (std::find(group.begin(), group.end(), c.ends[end]) != group.end()) end_at(c, end);
    }
  }

  /// Lets an end of a curve be the last corner.
  void end_at(TracedCurve& curve, int end) const {
    const auto turn = [&] {
      if (end > 0) return;
      std::reverse(curve.points.begin(), curve.points.end());
      std::reverse(curve.angle_deg.begin(), curve.angle_deg.end());
    };
    turn();
    cut_at(made_.corners.back().place, curve.points);
    curve.angle_deg.resize(curve.points.size(), curve.angle_deg.back());
    turn();
    curve.ends[end] = static_cast<int>(made_.corners.size()) - 1;
  }

  /// Ends a polyline at a place near its end: where it is nearest.
  void cut_at(const Vec3& place, std::vector<Vec3>& points) const {
    while (points.size() > 2 && (points[points.size() - 2] - place).norm() <= (points.back() - place).norm())
      points.pop_back();
    if ((points.back() - place).norm() < kTouches * s_ && points.size() > 1) points.pop_back();
    points.push_back(place);
  }

  const TracedCorner& corner(int c) const { return made_.corners[c]; }

  void drop_unused_corners() {
    std::vector<int> number(made_.corners.size(), -1);
    for (const TracedCurve& c : made_.curves)
      for (const int end : c.ends)
        if (end >= 0) number[end] = 0;
    std::vector<TracedCorner> kept;
    for (std::size_t c = 0; c < number.size(); ++c) {
      if (number[c] < 0) continue;
      number[c] = static_cast<int>(kept.size());
      kept.push_back(std::move(made_.corners[c]));
    }
    made_.corners = std::move(kept);
    for (TracedCurve& c : made_.curves)
      for (int& end : c.ends)
        if (end >= 0) end = number[end];
    std::vector<int> broken;
    for (const int c : made_.broken)
      if (number[c] >= 0) broken.push_back(number[c]);
    made_.broken = std::move(broken);
  }

  const std::vector<Vec3>& points_;
  const SamplePatches& patches_;
  PatchZeroSets zero_sets_;
  const double s_;
  const NeighbourTree tree_;
  std::map<std::pair<int, int>, Seeds> borders_;  ///< the sharp ones, by ascending pairs of patches
  TracedFeatures made_;
};

}  // namespace

TracedFeatures trace_patch_features(const std::vector<Vec3>& points, const SamplePatches& patches,
                                    const std::vector<PatchFit>& fits, const Context& context) {
  return PatchTracer(points, patches, fits)(context);
}

}  // namespace umtet
