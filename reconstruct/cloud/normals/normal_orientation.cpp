#include "reconstruct/cloud/normals/normal_orientation.h"

#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <stdexcept>

#include "common/formatted.h"
#include "reconstruct/cloud/normals/enclosed_volume.h"
#include "reconstruct/cloud/normals/sign_graph.h"

namespace umtet {
namespace {

// Smaller pieces are noise: they are oriented, but not counted.
constexpr std::size_t kCountedPoints = 100;
// In a cloud of this consistency or more, a few points that seem wrong are likelier noise than turned normals, unless
// every pair along their border has a weight below kSurelyWrong: on a smooth place that is a wrong normal. A clean
// cloud with one normal in a hundred turned is below it.
constexpr double kConsistent = 0.985, kSurelyWrong = -0.5;
// Regions below this are "a few points": those that noise makes look wrong are smaller.
constexpr std::size_t kFewPoints = 20;

void require(const OrientedPointCloud& cloud, const OrientationParams& params) {
  if (const auto found = problems(params); !found.empty()) throw std::invalid_argument(found.front());
  if (cloud.points.size() != cloud.normals.size())
    throw std::invalid_argument(
        formatted("%zu points but %zu normals: must be equal", cloud.points.size(), cloud.normals.size()));
  for (std::size_t i = 0; i < cloud.normals.size(); ++i)
    if (!cloud.normals[i].allFinite()) throw std::invalid_argument(formatted("normals[%zu] is not finite", i));
}

double agreement(const std::vector<SignEdge>& edges, const std::vector<std::int8_t>* sign) {
  double agrees = 0, all = 0;
  for (const SignEdge& e : edges) {
    const double weight = sign ? (*sign)[e.a] * (*sign)[e.b] * static_cast<double>(e.weight) : e.weight;
    all += std::abs(weight);
    if (weight > 0) agrees += weight;
  }
  return all > 0 ? agrees / all : 1;
}

OrientedPointCloud signed_cloud(const OrientedPointCloud& cloud, const std::vector<std::int8_t>& sign) {
  OrientedPointCloud result = cloud;
  for (std::size_t i = 0; i < sign.size(); ++i)
    if (sign[i] < 0) result.normals[i] = -result.normals[i];
  return result;
}

/// The sides of the components: which of their signs are to be turned so that bodies face outward and cavities inward.
class Sides {
 public:
  Sides(const OrientedPointCloud& cloud, const Signs& signs, const std::vector<double>& areas)
      : cloud_(signed_cloud(cloud, signs.sign)),
        areas_(areas),
        bodies(enclosed_volumes(cloud_, areas, signs.component, signs.n_components)),
        turn(signs.n_components, 1) {
    for (std::size_t c = 0; c < bodies.size(); ++c) turn[c] = bodies[c].volume < 0 ? -1 : 1;
  }

  /// Components in a component point inward when they are one deep, outward when two, and so on: what is inside of the
  /// material is a hole in it.
  void find_cavities(const std::vector<std::uint32_t>& component) {
    std::vector<std::uint32_t> closed;
    for (std::uint32_t c = 0; c < bodies.size(); ++c)
      if (bodies[c].tells_sides() && bodies[c].n_points >= kCountedPoints) closed.push_back(c);
    depth.assign(bodies.size(), 0);
    half_inside.assign(bodies.size(), 0);
    if (closed.size() < 2) return;
    std::vector<std::vector<std::uint32_t>> members(bodies.size());
    for (std::uint32_t i = 0; i < component.size(); ++i) members[component[i]].push_back(i);
    for (const std::uint32_t inner : closed)
      for (const std::uint32_t outer : closed)
        if (inner != outer && bodies[inner].area < bodies[outer].area) {
          const double winding = median_winding(members[outer], members[inner]) * turn[outer];
          if (winding > 0.75) ++depth[inner];
          if (winding > 0.25 && winding <= 0.75) half_inside[inner] = 1;
        }
    for (const std::uint32_t c : closed)
      if (depth[c] % 2 == 1) turn[c] = static_cast<std::int8_t>(-turn[c]);
  }

 private:
  OrientedPointCloud cloud_;
  const std::vector<double>& areas_;

  double median_winding(const std::vector<std::uint32_t>& outer, const std::vector<std::uint32_t>& inner) const {
    constexpr std::size_t kPicked = 11;  // points; odd, for a median
    std::vector<double> winding;
    for (std::size_t m = 0; m < kPicked; ++m)
      winding.push_back(winding_number(cloud_, areas_, outer, cloud_.points[inner[m * inner.size() / kPicked]]));
    std::nth_element(winding.begin(), winding.begin() + kPicked / 2, winding.end());
    return winding[kPicked / 2];
  }

 public:
  std::vector<EnclosedVolume> bodies;
  std::vector<std::int8_t> turn;  ///< +1 or -1
  std::vector<int> depth;         ///< components around this one
  std::vector<std::uint8_t> half_inside;
};

/// A closed body is settled by its volume; what is open or flat gets its side from the pieces it is joined to later.
std::vector<std::int8_t> settle(const OrientedPointCloud& cloud, const Signs& signs, const std::vector<double>& areas) {
  Sides sides(cloud, signs, areas);
  sides.find_cavities(signs.component);
  std::vector<std::int8_t> verdict(signs.n_components, 0);
  for (std::size_t c = 0; c < verdict.size(); ++c)
    if (sides.bodies[c].tells_sides() && sides.bodies[c].n_points >= kCountedPoints) verdict[c] = sides.turn[c];
  return verdict;
}

/// Whether a point is of a component whose outward side is a guess, by the signs that they are left with: of two
/// spheres that touch, solved as one surface, one is turned and together they enclose nothing, but repair keeps both as
/// they came.
void find_doubtful(const OrientedPointCloud& cloud, const Signs& signs, const std::vector<double>& areas,
                   OrientationReport& report) {
  Sides sides(cloud, signs, areas);
  sides.find_cavities(signs.component);
  const auto is_doubtful = [&](std::size_t c) { return !sides.bodies[c].tells_sides() || sides.half_inside[c]; };
  for (std::size_t c = 0; c < sides.bodies.size(); ++c)
    if (is_doubtful(c)) report.n_doubtful += sides.bodies[c].n_points;
  if (report.n_doubtful == 0) return;
  for (const auto component : signs.component) report.is_doubtful.push_back(is_doubtful(component) ? 1 : 0);
}

/// What the pairs along the border of a region say, and the region itself.
struct Region {
  double disagrees = 0, all = 0;  ///< sums of |weight|
  double mildest = -1;            ///< the greatest weight
  std::uint32_t n_points = 0;
};

/// Repair turns a region only where its border says so: elsewhere the given sign is evidence too, and the better one
/// along sharp edges and in noise. Regions of a few points are turned only in clouds where that many are wrong, or
/// where there is no doubt. A region that is a body facing outward as it came touches another one: pairs across the
/// gap do not count against that. A region without a border is a whole component, which the volume has decided.
void keep_undisputed(const OrientedPointCloud& cloud, const std::vector<double>& areas,
                     const std::vector<SignEdge>& edges, double disagreement, std::size_t few,
                     std::vector<std::int8_t>& sign) {
  std::vector<std::uint32_t> parent(sign.size());
  std::iota(parent.begin(), parent.end(), 0U);
  const auto root = [&](std::uint32_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (const SignEdge& e : edges) {
    if (sign[e.a] > 0 || sign[e.b] > 0 || !(e.weight > 0)) continue;
    const std::uint32_t a = root(e.a), b = root(e.b);
    parent[std::max(a, b)] = std::min(a, b);
  }
  std::vector<Region> regions(1);  // the first is all that is not turned
  std::vector<std::uint32_t> region(sign.size(), 0);
  for (std::uint32_t i = 0; i < sign.size(); ++i) {
    if (sign[i] > 0) continue;
    if (root(i) == i) {  // the least of its members, so it comes before them
      region[i] = static_cast<std::uint32_t>(regions.size());
      regions.emplace_back();
    }
    region[i] = region[root(i)];
    ++regions[region[i]].n_points;
  }
  for (const SignEdge& e : edges) {
    if (sign[e.a] == sign[e.b]) continue;
    Region& r = regions[region[sign[e.a] < 0 ? e.a : e.b]];
    const double weight = e.weight;
    r.all += std::abs(weight);
    r.mildest = std::max(r.mildest, weight);
    if (weight < 0) r.disagrees -= weight;
  }
  const std::vector<EnclosedVolume> bodies = enclosed_volumes(cloud, areas, region, regions.size());
  const auto stays = [&](std::uint32_t r) {
    const Region& it = regions[r];
    if (!(it.all > 0)) return false;
    if (it.n_points <= few && it.mildest > kSurelyWrong) return true;
    if (it.n_points >= kCountedPoints && bodies[r].tells_sides() && bodies[r].volume > 0) return true;
    return it.disagrees < disagreement * it.all;
  };
  for (std::size_t i = 0; i < sign.size(); ++i)
    if (sign[i] < 0 && stays(region[i])) sign[i] = 1;
}

/// a_i as sample_areas has them where no two points share a place. Areas of duplicates may be 0: they have no say.
std::vector<double> areas_behind(const std::vector<Vec3>& points, const Neighbourhoods& near) {
  std::vector<double> areas(near.size());
  const auto k = static_cast<double>(near.k());
  tbb::parallel_for(std::size_t{0}, areas.size(), [&](std::size_t i) {
    areas[i] = 2 * std::numbers::pi / (k * (k + 2)) * near.sum_of_distances2(points, i);
  });
  return areas;
}

/// Those given, or searched now.
class FoundNeighbours {
 public:
  FoundNeighbours(const OrientedPointCloud& cloud, const OrientationParams& params, const Neighbourhoods* given)
      : own_(given ? Neighbourhoods() : Neighbourhoods(cloud.points, static_cast<std::size_t>(params.neighbours))),
        used_(given ? *given : own_) {
    const std::size_t n = cloud.points.size(), k = std::min(static_cast<std::size_t>(params.neighbours), n - 1);
    if (used_.size() != n || used_.k() != k)
      throw std::invalid_argument(
          formatted("neighbourhoods of %zu points, %zu each: must be %zu, %zu each", used_.size(), used_.k(), n, k));
  }
  const Neighbourhoods& operator*() const { return used_; }

 private:
  Neighbourhoods own_;
  const Neighbourhoods& used_;
};

/// Bodies without contested points that all face the right way: there is nothing to repair.
bool is_right_as_given(const OrientedPointCloud& cloud, const Neighbourhoods& near, const std::vector<double>& areas,
                       OrientationReport& report) {
  Signs signs;
  signs.component = agreeing_components(cloud, near, signs.n_components);
  signs.sign.assign(cloud.points.size(), 1);
  Sides sides(cloud, signs, areas);
  for (const EnclosedVolume& body : sides.bodies)
    if (!body.tells_sides() || body.n_points < kCountedPoints) return false;
  sides.find_cavities(signs.component);
  for (std::uint32_t c = 0; c < signs.n_components; ++c)
    if (sides.turn[c] < 0 || sides.half_inside[c]) return false;
  report.n_components = signs.n_components;
  report.n_cavities = static_cast<std::size_t>(
      std::count_if(sides.depth.begin(), sides.depth.end(), [](int depth) { return depth % 2 == 1; }));
  report.left_alone = true;
  return true;
}

/// Whether points that would be turned lie on a sheet of their own: nearer to one of the others than to most of theirs,
/// and all to the same side of it. Then body or gap between is thinner than the samples are apart, and turning one
/// sheet would make one surface of two. Where normals are merely turned over, the sides of the others are evenly
/// spread.
bool lie_on_another_sheet(const OrientedPointCloud& cloud, const Neighbourhoods& near,
                          const std::vector<std::int8_t>& sign) {
  std::size_t n_turned = 0;
  std::vector<double> slopes;  // of the way to the nearest of the others, against its tangent plane
  for (std::size_t i = 0; i < sign.size(); ++i) {
    if (sign[i] > 0 || cloud.normals[i].isZero(0)) continue;
    ++n_turned;
    for (const std::uint32_t j : near.points(i)) {
      if (sign[j] < 0 || cloud.normals[j].isZero(0)) continue;
      const Vec3 way = cloud.points[i] - cloud.points[j];
      if (!way.isZero(0)) slopes.push_back(way.normalized().dot(cloud.normals[j]));
      break;
    }
  }
  // Around a turned patch only the points along its border have others near. Curvature and noise below half a spacing
  // stay under 30 degrees.
  if (2 * slopes.size() < n_turned || slopes.empty()) return false;
  const auto middle = slopes.begin() + static_cast<std::ptrdiff_t>(slopes.size() / 2);
  std::nth_element(slopes.begin(), middle, slopes.end());
  return std::abs(*middle) > 0.5;
}

enum class Given { Directions, Signs };

OrientationReport orient(OrientedPointCloud& cloud, const OrientationParams& params, const Neighbourhoods* known,
                         Given given) {
  require(cloud, params);
  OrientationReport report;
  report.n_undefined = static_cast<std::size_t>(
      std::count_if(cloud.normals.begin(), cloud.normals.end(), [](const Vec3& n) { return n.isZero(0); }));
  const std::size_t n = cloud.points.size();
  if (n < 2) return report;
  const FoundNeighbours near(cloud, params, known);
  const std::vector<double> areas = areas_behind(cloud.points, *near);
  if (given == Given::Signs) {
    const SignAgreement agreement = sign_agreement(cloud, *near);
    report.consistency = report.consistency_after = agreement.share();
    if (agreement.n_contested == 0 && is_right_as_given(cloud, *near, areas, report)) return report;
  }
  const std::vector<SignEdge> edges = sign_graph(cloud, *near);
  report.consistency = report.consistency_after = agreement(edges, nullptr);

  Signs signs = solve_signs(n, edges, [&](const Signs& found) { return settle(cloud, found, areas); });
  Sides sides(cloud, signs, areas);
  sides.find_cavities(signs.component);
  std::vector<std::ptrdiff_t> votes(signs.n_components, 0);
  for (std::size_t i = 0; i < n; ++i) votes[signs.component[i]] += signs.sign[i];
  for (std::size_t c = 0; c < signs.n_components; ++c) {
    const EnclosedVolume& body = sides.bodies[c];
    const bool is_counted = body.n_points >= kCountedPoints, tells = body.tells_sides();
    if (given == Given::Signs && !(tells && is_counted)) sides.turn[c] = votes[c] < 0 ? -1 : 1;
    if (is_counted) ++report.n_components;
    if (sides.depth[c] % 2 == 1) ++report.n_cavities;
  }
  for (std::size_t i = 0; i < n; ++i)
    signs.sign[i] = static_cast<std::int8_t>(signs.sign[i] * sides.turn[signs.component[i]]);
  if (given == Given::Signs) {
    const std::size_t few = report.consistency >= kConsistent ? kFewPoints : 0;
    keep_undisputed(cloud, areas, edges, params.disagreement, few, signs.sign);
  }
  if (given == Given::Signs && lie_on_another_sheet(cloud, *near, signs.sign)) signs.sign.assign(n, 1);
  find_doubtful(cloud, signs, areas, report);
  for (std::size_t i = 0; i < n; ++i) {
    if (signs.sign[i] > 0 || cloud.normals[i].isZero(0)) continue;
    cloud.normals[i] = -cloud.normals[i];
    ++report.n_turned;
  }
  report.left_alone = report.n_turned == 0;
  report.consistency_after = agreement(edges, &signs.sign);
  return report;
}

/// Sums of the weights, and of their magnitudes, of the pairs of a point with a representative and those around it.
SignAgreement pairs_with(const OrientedPointCloud& few, const Neighbourhoods& near, std::uint32_t representative,
                         const Vec3& x, const Vec3& n) {
  SignAgreement sum;
  const auto add = [&](std::uint32_t r) {
    const double weight = pair_weight(few.points[r], few.normals[r], x, n);
    sum.agrees += weight;
    sum.all += std::abs(weight);
  };
  add(representative);
  for (const std::uint32_t r : near.points(representative)) add(r);
  return sum;
}

/// On scan lines: see the header.
OrientationReport orient(OrientedPointCloud& cloud, const OrientationParams& params, const Neighbourhoods* near,
                         const Covering* covering, Given given) {
  if (!covering || covering->is_even()) return orient(cloud, params, near, given);
  require(cloud, params);
  OrientedPointCloud few = picked(cloud, covering->chosen);
  OrientationReport report =
      orient(few, params, params.neighbours == static_cast<int>(covering->near.k()) ? &covering->near : nullptr, given);
  const double surely = given == Given::Signs ? kSurelyWrong : 0;
  report.n_turned = report.n_undefined = 0;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const std::uint32_t r = covering->representative[i];
    Vec3& n = cloud.normals[i];
    if (n.isZero(0)) {
      ++report.n_undefined;
      continue;
    }
    bool is_wrong = n.dot(few.normals[r]) < 0;
    if (covering->chosen[r] != i) {
      const SignAgreement pairs = pairs_with(few, covering->near, r, cloud.points[i], n);
      is_wrong = pairs.agrees < surely * pairs.all;
    }
    if (!is_wrong) continue;
    n = -n;
    ++report.n_turned;
  }
  if (!report.is_doubtful.empty()) {
    std::vector<std::uint8_t> of_all(cloud.points.size());
    for (std::size_t i = 0; i < of_all.size(); ++i) of_all[i] = report.is_doubtful[covering->representative[i]];
    report.is_doubtful = std::move(of_all);
  }
  report.n_doubtful = report.n_doubtful * cloud.points.size() / few.points.size();
  report.left_alone = report.n_turned == 0;
  return report;
}

}  // namespace

std::vector<std::string> problems(const OrientationParams& params) {
  std::vector<std::string> found;
  if (params.neighbours < 4 || params.neighbours > 64)
    found.push_back(formatted("neighbours = %d: must be in 4..64", params.neighbours));
  if (!(params.disagreement >= 0.5 && params.disagreement < 1))
    found.push_back(formatted("disagreement = %g: must be at least 0.5 and below 1", params.disagreement));
  return found;
}

double consistency(const OrientedPointCloud& cloud, const OrientationParams& params, const Neighbourhoods* near,
                   const Covering* covering) {
  if (covering && !covering->is_even()) {
    return consistency(picked(cloud, covering->chosen), params,
                       params.neighbours == static_cast<int>(covering->near.k()) ? &covering->near : nullptr);
  }
  require(cloud, params);
  return cloud.points.size() < 2 ? 1 : sign_agreement(cloud, *FoundNeighbours(cloud, params, near)).share();
}

OrientationReport orient_normals(OrientedPointCloud& cloud, const OrientationParams& params, const Neighbourhoods* near,
                                 const Covering* covering) {
  return orient(cloud, params, near, covering, Given::Directions);
}

OrientationReport repair_normals(OrientedPointCloud& cloud, const OrientationParams& params, const Neighbourhoods* near,
                                 const Covering* covering) {
  return orient(cloud, params, near, covering, Given::Signs);
}

void flip(OrientedPointCloud& cloud) {
  for (Vec3& n : cloud.normals) n = -n;
}

}  // namespace umtet
