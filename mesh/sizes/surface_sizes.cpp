#include "mesh/sizes/surface_sizes.h"

#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <stdexcept>
#include <tuple>
#include <utility>

#include "common/formatted.h"
#include "common/polled_loops.h"
#include "mesh/core/asking_psi.h"
#include "mesh/implicit/curvature.h"
#include "mesh/implicit/thickness.h"

namespace umtet {
namespace {

// psi is followed in steps of this share of h_min, so that a sheet of h_min / 16 is seen; and of this share of the way
// so far. What is stepped over then, a wall of t / 4 at the distance t, asks for t / (4 edges_across) itself, and by a
// grade of .3 for less here than t / edges_across.
constexpr double kFirstStep = .125, kGrowth = .25;
// Newton's steps to psi = 0; points that are not there to this share of h_min after so many are left out.
constexpr int kMostSteps = 8;
constexpr double kReached = 1e-3;
// Of the spacing: a size below that asks for points between. The tree answers to 5 %.
constexpr double kWide = .95;
// Points of one generation in one cell of this share of their spacing are one: children are half a spacing apart.
constexpr double kCell = .5;
// Halvings of an edge that turns too much: more than there are between h and h_min in any mesh.
constexpr int kMostHalvings = 20;

/// A place to look at, and how far it is to the next.
struct Place {
  Vec3 x;
  double spacing;
};

/// A point of psi = 0 with its unit normal.
struct OnSurface {
  Vec3 x, n;
  double spacing;
};

class SurfaceSizes {
 public:
  SurfaceSizes(ImplicitFunctionRef psi, const SurfaceSizeParams& params, const Context& context)
      : psi_(psi), p_(params), context_(context) {}

  std::vector<SizeSource> of(std::vector<Place> places,
                             const std::function<bool(const std::vector<SizeSource>&)>& enough) {
    std::vector<SizeSource> sources;
    std::vector<OnSurface> open;  // so far they are near enough to each other
    while (!places.empty()) {
      const std::vector<OnSurface> feet = one_a_cell(on_surface(places));
      const std::vector<double> h = sizes(feet);
      for (std::size_t i = 0; i < feet.size(); ++i) sources.push_back({feet[i].x, h[i], p_.constant_layer * h[i]});
      open.insert(open.end(), feet.begin(), feet.end());
      places = between(sources, open);
      if (enough && places.size() > sources.size() && enough(sources)) break;
    }
    return sources;
  }

 private:
  /// Those points that reach psi = 0 within their spacing, in their order.
  std::vector<OnSurface> on_surface(const std::vector<Place>& places) const {
    std::vector<std::optional<OnSurface>> found(places.size());
    for_each_asking(psi_, places.size(), kValuesPerPoll / 4, context_,
                    [&](std::size_t i) { found[i] = foot(places[i]); });
    std::vector<OnSurface> feet;
    for (const std::optional<OnSurface>& f : found) {
      if (f) feet.push_back(*f);
    }
    return feet;
  }

  std::optional<OnSurface> foot(const Place& from) const {
    Vec3 x = from.x, g;
    for (int step = 0; step < kMostSteps; ++step) {
      const double value = psi_.value(x, g), slope = g.norm();
      if (!(slope > 0) || !std::isfinite(slope) || !std::isfinite(value)) return std::nullopt;
      if (std::abs(value) <= kReached * p_.h_min * slope) {
        if ((x - from.x).norm() > from.spacing) return std::nullopt;
        return OnSurface{x, g / slope, from.spacing};
      }
      const double length = std::min(std::abs(value) / slope, from.spacing / 2);
      x -= std::copysign(length, value) / slope * g;
    }
    return std::nullopt;
  }

  /// The first of those in one cell that look the same way: the two sheets of a thin body are two.
  static std::vector<OnSurface> one_a_cell(const std::vector<OnSurface>& feet) {
    using Cell = std::tuple<double, double, double, double, Eigen::Index>;
    std::vector<std::pair<Cell, std::size_t>> order(feet.size());
    tbb::parallel_for(std::size_t{0}, feet.size(), [&](std::size_t i) {
      const auto& [x, n, spacing] = feet[i];
      const Vec3 cell = (x / (kCell * spacing)).array().floor();
      Eigen::Index axis = 0;
      n.cwiseAbs().maxCoeff(&axis);
      order[i] = {{spacing, cell.x(), cell.y(), cell.z(), n[axis] > 0 ? axis : axis + 3}, i};
    });
    tbb::parallel_sort(order.begin(), order.end());
    std::vector<OnSurface> left;
    for (std::size_t k = 0; k < order.size(); ++k) {
      if (k == 0 || order[k].first != order[k - 1].first) left.push_back(feet[order[k].second]);
    }
    return left;
  }

  /// Four places around each point that is farther from the next than the size there, by all sources so far. Such
  /// points are taken out of `open`.
  std::vector<Place> between(const std::vector<SizeSource>& sources, std::vector<OnSurface>& open) const {
    const SourceTree tree(sources, p_.grade);
    std::vector<std::uint8_t> is_wide(open.size());
    polled_parallel_for(open.size(), kValuesPerPoll, context_, [&](std::size_t i) {
      is_wide[i] = tree.at(open[i].x, p_.h_min, open[i].spacing) < kWide * open[i].spacing ? 1 : 0;
    });
    std::vector<Place> places;
    std::size_t n_left = 0;
    for (std::size_t i = 0; i < open.size(); ++i) {
      const auto [x, n, spacing] = open[i];
      if (!is_wide[i]) {
        open[n_left++] = open[i];
        continue;
      }
      const Vec3 u = spacing / 4 * n.unitOrthogonal(), v = n.cross(u);
      for (const Vec3& d : std::array<Vec3, 4>{u + v, u - v, v - u, -u - v}) places.push_back({x + d, spacing / 2});
    }
    open.resize(n_left);
    return places;
  }

  std::vector<double> sizes(const std::vector<OnSurface>& feet) const {
    std::vector<double> h(feet.size());
    for_each_asking(psi_, feet.size(), kValuesPerPoll / 16, context_, [&](std::size_t i) {
      h[i] = std::max(p_.h_min, std::min({p_.h, of_thickness(feet[i]), of_deviation(feet[i])}));
      h[i] = std::max(p_.h_min, of_turn(feet[i], h[i]));
    });
    return h;
  }

  double of_thickness(const OnSurface& f) const {
    if (p_.edges_across == 0) return p_.h;
    const SheetSearch search{kFirstStep * p_.h_min, p_.edges_across * p_.h, p_.steepest, kGrowth};
    const SheetDistances d = sheet_distances_from(psi_, f.x, f.n, search);
    return std::min(known_thickness(f, -d.body), known_thickness(f, d.gap)) / p_.edges_across;
  }

  /// The distance from one sheet to the other if both are known, else infinity.
  /// @param along  signed distance along the normal to the other sheet; infinite: there is none
  double known_thickness(const OnSurface& f, double along) const {
    const double distance = std::abs(along);
    if (!p_.is_known || !(distance < p_.edges_across * p_.h)) return distance;
    const Vec3 other = f.x + along * f.n;
    Vec3 gradient;
    psi_.value(other, gradient);
    return p_.is_known(f.x, f.n) && p_.is_known(other, gradient) ? distance : std::numeric_limits<double>::infinity();
  }

  double of_deviation(const OnSurface& f) const {
    return p_.deviation > 0 ? edge_of_deviation(principal_curvatures(psi_, f.x), p_.deviation) : p_.h;
  }

  /// At most h, so short that psi = 0 does not turn by more than max_turn along it, or is no farther off than noise.
  double of_turn(const OnSurface& f, double h) const {
    const double least = p_.least_by_turn * p_.h;
    for (int halving = 0; p_.max_turn > 0 && h > least && halving < kMostHalvings; ++halving) {
      const double turn = turn_along(psi_, f.x, f.n, h);
      const double part = std::max(p_.max_turn / turn, std::sqrt(8 * p_.noise / (h * turn)));
      if (part >= 1) break;
      h = std::max(least, h * std::max(.5, part));
    }
    return h;
  }

  ImplicitFunctionRef psi_;
  const SurfaceSizeParams& p_;
  const Context& context_;
};

}  // namespace

std::vector<std::string> problems(const SurfaceSizeParams& p) {
  std::vector<std::string> list;
  const auto require = [&list](bool holds, const char* name, double value, const char* what) {
    if (!holds) list.push_back(formatted("%s = %g: must be %s", name, value, what));
  };
  require(p.h_min > 0, "h_min", p.h_min, "> 0");
  require(p.h >= p.h_min && std::isfinite(p.h), "h", p.h, "finite, and not below h_min");
  require(p.grade > 0 && std::isfinite(p.grade), "grade", p.grade, "> 0");
  require(p.edges_across >= 0, "edges_across", p.edges_across, ">= 0");
  require(p.max_turn >= 0, "max_turn", p.max_turn, ">= 0");
  require(p.least_by_turn > 0 && p.least_by_turn <= 1, "least_by_turn", p.least_by_turn, "in (0, 1]");
  require(p.noise >= 0, "noise", p.noise, ">= 0");
  require(p.deviation >= 0, "deviation", p.deviation, ">= 0");
  require(p.constant_layer >= 0, "constant_layer", p.constant_layer, ">= 0");
  require(p.steepest > 0, "steepest", p.steepest, "> 0");
  return list;
}

std::vector<SizeSource> surface_sizes(ImplicitFunctionRef psi, const std::vector<Vec3>& points, double spacing,
                                      const SurfaceSizeParams& params, const Context& context,
                                      const std::function<bool(const std::vector<SizeSource>&)>& enough) {
  std::vector<std::string> all = problems(params);
  if (!(spacing > 0)) all.push_back(formatted("spacing = %g: must be > 0", spacing));
  if (!all.empty()) throw std::invalid_argument(joined(all, "; "));
  std::vector<Place> places;
  places.reserve(points.size());
  for (const Vec3& x : points) places.push_back({x, spacing});
  return SurfaceSizes(psi, params, context).of(std::move(places), enough);
}

}  // namespace umtet
