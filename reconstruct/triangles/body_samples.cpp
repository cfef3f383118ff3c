#include "reconstruct/triangles/body_samples.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "common/formatted.h"
#include "reconstruct/triangles/triangle_samples.h"
#include "reconstruct/triangles/triangle_winding.h"

namespace umtet {
namespace {

// The default h is 1.5 % of the diagonal: two or three samples an edge show what such a mesh can.
constexpr double kOfDiagonal = .006;
// A fit of so many takes some minutes; more only if they are asked for.
constexpr double kMostSamples = 1e6;
// 250 bytes each, and as much again in the fit.
constexpr double kTooMany = 2e7;
// Of the diagonal: far above rounding, far below a gap that shows.
constexpr double kBeside = 2e-6;
// Of the winding number before a sample. Where a twentieth of the surface is missing it is off by as much; before an
// inner wall it is .45 and more.
constexpr double kOutside = .3;
// Before open surfaces, a shallow dish say, it is down to -1/2.
constexpr double kInsideOut = -.75;
// Off a whole number; half-way is a quarter.
constexpr double kUnsure = .25;

/// A place on the boundary of the body, or why it is none.
enum class Place : std::uint8_t { Boundary, Inside, InsideOut };

Place place_of(double w_before) {
  return w_before > kOutside ? Place::Inside : w_before < kInsideOut ? Place::InsideOut : Place::Boundary;
}

std::vector<Vec3> before(const TriangleMesh& mesh, const std::vector<Vec3>& points,
                         const std::vector<std::uint32_t>& faces) {
  const double step = kBeside * diagonal_of(mesh);
  std::vector<Vec3> places(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    places[i] = points[i] + step * mesh.area_vector(faces[i]).normalized();
  return places;
}

/// How much of a triangle lies on the boundary.
enum class Share : std::uint8_t { None, Some, All };

/// By its samples; triangles without one by their centre.
std::vector<Share> shares_on_boundary(const TriangleMesh& mesh, const TriangleSamples& samples,
                                      const std::vector<Place>& place, const TriangleWinding& w,
                                      const Context& context) {
  std::vector<std::uint32_t> n(mesh.F.size(), 0), n_on(mesh.F.size(), 0);
  for (std::size_t i = 0; i < place.size(); ++i) {
    ++n[samples.faces[i]];
    n_on[samples.faces[i]] += place[i] == Place::Boundary ? 1 : 0;
  }
  const bool all = std::all_of(place.begin(), place.end(), [](Place p) { return p == Place::Boundary; });
  std::vector<Vec3> centres;
  std::vector<std::uint32_t> without;
  for (std::uint32_t f = 0; f < n.size() && !all; ++f) {
    if (n[f] > 0) continue;
    without.push_back(f);
    centres.push_back(mesh.centroid(f));
  }
  std::vector<Share> share(n.size());
  for (std::size_t f = 0; f < n.size(); ++f)
    share[f] = n_on[f] == n[f] ? Share::All : n_on[f] > 0 ? Share::Some : Share::None;
  const std::vector<double> at = w(before(mesh, centres, without), context);
  for (std::size_t i = 0; i < without.size(); ++i)
    share[without[i]] = place_of(at[i]) == Place::Boundary ? Share::All : Share::None;
  return share;
}

/// Those that lie on the boundary or cross it, with the vertices that they use; the label is 1 for the former, else 0.
TriangleMesh on_boundary(const TriangleMesh& mesh, const std::vector<Share>& share) {
  TriangleMesh some;
  std::vector<int> number(mesh.V.size(), -1);
  for (std::size_t f = 0; f < mesh.F.size(); ++f) {
    if (share[f] == Share::None) continue;
    Triangle triangle = mesh.F[f];
    for (int& v : triangle) {
      if (number[v] < 0) {
        number[v] = static_cast<int>(some.V.size());
        some.V.push_back(mesh.V[v]);
      }
      v = number[v];
    }
    some.F.push_back(triangle);
    some.labels.push_back(share[f] == Share::All ? 1 : 0);
  }
  return some;
}

double area_of(const TriangleMesh& mesh) {
  double area = 0;
  for (std::size_t f = 0; f < mesh.F.size(); ++f) area += mesh.area_vector(f).norm();
  return area;
}

}  // namespace

std::vector<std::string> problems(const BodySampleParams& params) {
  if (params.spacing >= 0 && std::isfinite(params.spacing)) return {};
  return {formatted("spacing = %g: must be >= 0", params.spacing)};
}

double default_spacing(const TriangleMesh& mesh) {
  const double area = area_of(mesh);
  const double n_corners = static_cast<double>(mesh.F.size()) / 2;
  const double spacing = std::min(kOfDiagonal * diagonal_of(mesh), std::sqrt(area / n_corners));
  return std::max(spacing, std::sqrt(area / kMostSamples));
}

BodySamples sample_body(TriangleMesh mesh, const BodySampleParams& params, const Context& context) {
  if (const auto found = problems(params); !found.empty()) throw std::invalid_argument(found.front());
  BodySamples made;
  TriangleReport& report = made.report;
  report.n_triangles = mesh.F.size();
  report.dropped = drop_useless_faces(mesh);
  if (mesh.F.empty()) throw std::invalid_argument("no triangle has an area");
  if (params.turn) report.sides = orient_outward(mesh, context);
  report.spacing = default_spacing(mesh);
  if (params.spacing > 0) report.spacing = std::min(report.spacing, params.spacing);
  if (const double n = area_of(mesh) / (report.spacing * report.spacing); n > kTooMany)
    throw std::invalid_argument(
        formatted("%.3g samples %.3g apart are too many: at most %.0g", n, report.spacing, kTooMany));
  const TriangleSamples samples = sample_triangles(mesh, report.spacing, 0, context);
  const TriangleWinding w(mesh);
  const std::vector<double> w_before = w(before(mesh, samples.points, samples.faces), context);
  std::vector<Place> place(samples.points.size());
  std::transform(w_before.begin(), w_before.end(), place.begin(), place_of);
  report.n_samples = samples.points.size();
  std::size_t n_unsure = 0;
  for (std::size_t i = 0; i < place.size(); ++i) {
    n_unsure += std::abs(w_before[i] - std::round(w_before[i])) > kUnsure ? 1 : 0;
    report.n_inside += place[i] == Place::Inside ? 1 : 0;
    report.n_inside_out += place[i] == Place::InsideOut ? 1 : 0;
    if (place[i] != Place::Boundary) continue;
    made.cloud.points.push_back(samples.points[i]);
    made.cloud.normals.push_back(mesh.area_vector(samples.faces[i]).normalized());
    if (!mesh.labels.empty()) made.cloud.labels.push_back(mesh.labels[samples.faces[i]]);
  }
  report.unsure = static_cast<double>(n_unsure) / static_cast<double>(place.size());
  made.boundary = on_boundary(mesh, shares_on_boundary(mesh, samples, place, w, context));
  return made;
}

}  // namespace umtet
