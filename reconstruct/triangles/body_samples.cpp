#include "reconstruct/triangles/body_samples.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "common/formatted.h"
#include "reconstruct/triangles/body_thickness.h"
#include "reconstruct/triangles/cut_triangles.h"
#include "reconstruct/triangles/feature_lines.h"
#include "reconstruct/triangles/triangle_samples.h"
#include "reconstruct/triangles/triangle_tree.h"
#include "reconstruct/triangles/triangle_winding.h"

namespace umtet {
namespace {

// The default h is 1.5 % of the diagonal: two or three samples an edge show what such a mesh can.
constexpr double kSpacingOfDiagonal = .006;
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
// Triangles are no surface where so many of their edges belong to one alone, and no body where the winding number is a
// guess for so much of them. Triangles that were torn apart or fit badly share few edges, but the winding number is
// sure; a surface with half of it missing is unsure, but shares its edges.
constexpr double kNoSurface = .6, kNoBody = .25;
// Samples to a thickness, along it: psi is fitted on a lattice of 1.25 spacings (resolution.cpp), and has two sheets
// where it has two and a half of these between them.
constexpr double kAcross = 3;
// Spacings of a piece of a large triangle that has a thickness of its own.
constexpr double kPiece = 6;
// Spacings are halved this often at most.
constexpr int kMostHalvings = 6;
// Pieces that triangles are cut into at most, and some for each.
constexpr std::size_t kMostPieces = 200000;
// Share of the surface that is thinner than what is said of it.
constexpr double kThinShare = .005;
// Of a gap or a neck, in spacings: the lattice has 1.25 of them, an edge of the default mesh 2.5, and samples of both
// sides of a right angle end up 1.9 times as far from each other.
constexpr double kContactWidth = 3;

/// A place on the boundary of the body, or why it is none.
enum class Place : std::uint8_t { Boundary, Inside, InsideOut };

Place place_of(double w_before) {
  return w_before > kOutside ? Place::Inside : w_before < kInsideOut ? Place::InsideOut : Place::Boundary;
}

std::vector<Vec3> beside(const TriangleMesh& mesh, const std::vector<Vec3>& points,
                         const std::vector<std::uint32_t>& faces, double step) {
  step *= diagonal_of(mesh);
  std::vector<Vec3> places(points.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    places[i] = points[i] + step * mesh.area_vector(faces[i]).normalized();
  return places;
}

std::vector<Vec3> before(const TriangleMesh& mesh, const std::vector<Vec3>& points,
                         const std::vector<std::uint32_t>& faces) {
  return beside(mesh, points, faces, kBeside);
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

/// Returns the group of each triangle, see group_of().
std::vector<int> groups_of(const TriangleMesh& mesh, bool has_groups) {
  std::vector<int> groups(mesh.F.size(), 0);
  if (!has_groups) return groups;
  std::vector<int> different = mesh.labels;
  std::sort(different.begin(), different.end());
  different.erase(std::unique(different.begin(), different.end()), different.end());
  if (different.size() > kMostGroupsOfBody) return groups;
  std::transform(mesh.labels.begin(), mesh.labels.end(), groups.begin(),
                 [](int label) { return std::clamp(label, 0, std::numeric_limits<int>::max() - 1); });
  return groups;
}

/// Those that lie on the boundary or cross it, with the vertices that they use.
TriangleMesh on_boundary(const TriangleMesh& mesh, const std::vector<Share>& share, bool has_groups) {
  const std::vector<int> groups = groups_of(mesh, has_groups);
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
    some.labels.push_back(share[f] == Share::All ? groups[f] + 1 : -groups[f]);
  }
  some.lines = renumbered_lines(mesh.lines, number);
  return some;
}

double area_of(const TriangleMesh& mesh) {
  double area = 0;
  for (std::size_t f = 0; f < mesh.F.size(); ++f) area += mesh.area_vector(f).norm();
  return area;
}

/// Least thickness at some places of each piece.
std::vector<double> thickness_of_pieces(const TriangleMesh& mesh, const TrianglePieces& pieces, double limit,
                                        const Context& context) {
  // Of many pieces each is small.
  constexpr std::size_t kFew = 50000;
  const std::size_t n_places = pieces.mesh.F.size() < kFew ? 4 : 1;
  std::vector<Vec3> points;
  std::vector<std::uint32_t> faces;
  for (std::size_t f = 0; f < pieces.mesh.F.size(); ++f) {
    const Vec3 centre = pieces.mesh.centroid(f);
    points.push_back(centre);
    // Not on an edge: rays along it would meet what is beside it.
    for (int k = 0; k + 1 < static_cast<int>(n_places); ++k)
      points.push_back(centre + .9 * (pieces.mesh.corner(f, k) - centre));
    faces.insert(faces.end(), n_places, pieces.of[f]);
  }
  const std::vector<double> t = sheet_thickness(mesh, TriangleTree(mesh), points, faces, limit, context);
  std::vector<double> least(pieces.mesh.F.size());
  for (std::size_t f = 0; f < least.size(); ++f)
    least[f] = *std::min_element(t.begin() + static_cast<std::ptrdiff_t>(n_places * f),
                                 t.begin() + static_cast<std::ptrdiff_t>(n_places * (f + 1)));
  return least;
}

/// Samples whose spacing goes with the thickness. @param report  receives it
TriangleSamples samples_by_thickness(const TriangleMesh& mesh, TriangleReport& report, const Context& context) {
  const double spacing = report.spacing, limit = kAcross * spacing;
  report.least_spacing = spacing;
  const TrianglePieces pieces = cut_triangles(mesh, kPiece * spacing, kMostPieces + 2 * mesh.F.size());
  const std::vector<double> t = thickness_of_pieces(mesh, pieces, limit, context);
  std::vector<std::pair<double, double>> spectrum;  // thickness and area
  double area = 0, thin = 0, finest = spacing;
  for (std::size_t f = 0; f < t.size(); ++f) {
    area += pieces.mesh.area_vector(f).norm();
    if (t[f] < limit) spectrum.emplace_back(t[f], pieces.mesh.area_vector(f).norm());
  }
  if (spectrum.empty()) return sample_triangles(mesh, spacing, 0, context);
  std::sort(spectrum.begin(), spectrum.end());
  for (const auto& [thickness, of] : spectrum) {
    thin += of;
    if (thin < kThinShare * area) continue;
    report.thickness = thickness;
    finest = thickness / kAcross;
    break;
  }
  if (!report.thickness) finest = spectrum.front().first / kAcross;
  // One spacing for most of what is thin, and halves between it and that of the rest: few kinds of pieces.
  const auto n_samples = [&](double least) {
    double n = (area - thin) / (spacing * spacing);
    for (const auto& [thickness, of] : spectrum) n += of / std::pow(std::max(least, thickness / kAcross), 2);
    return n;
  };
  while (n_samples(finest) > kMostSamples && finest < spacing) finest *= 1.05;
  finest = std::clamp(finest, std::ldexp(spacing, -kMostHalvings), spacing);
  report.least_spacing = finest;
  // Kind 0 has the spacing of what is thick, kind k > 0 finest * 2^(k - 1).
  std::vector<TriangleMesh> kinds(1);
  std::vector<std::vector<std::uint32_t>> of(1);
  for (std::size_t f = 0; f < t.size(); ++f) {
    std::size_t k = 0;
    if (t[f] < limit) k = 1 + static_cast<std::size_t>(std::max(0., std::floor(std::log2(t[f] / kAcross / finest))));
    if (kinds.size() <= k) {
      kinds.resize(k + 1);
      of.resize(k + 1);
    }
    kinds[k].F.push_back(pieces.mesh.F[f]);
    of[k].push_back(pieces.of[f]);
  }
  TriangleSamples all;
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    if (kinds[k].F.empty()) continue;
    kinds[k].V = pieces.mesh.V;
    const double of_kind = k == 0 ? spacing : std::ldexp(finest, static_cast<int>(k) - 1);
    const TriangleSamples some = sample_triangles(kinds[k], std::min(of_kind, spacing), k, context);
    all.points.insert(all.points.end(), some.points.begin(), some.points.end());
    for (const std::uint32_t f : some.faces) all.faces.push_back(of[k][f]);
  }
  return all;
}

/// Labels of caps follow those of all others.
void label_caps(TriangleMesh& mesh, std::size_t n_before, const std::vector<PlaneCap>& caps) {
  if (mesh.labels.empty()) {
    mesh.labels.assign(mesh.F.size(), 1);
  }
  int label = *std::max_element(mesh.labels.begin(), mesh.labels.end());
  std::size_t f = n_before;
  for (const PlaneCap& cap : caps) {
    ++label;
    for (std::size_t k = 0; k < cap.n_triangles; ++k) mesh.labels[f++] = label;
  }
}

/// Before anything is sampled: random triangles would ask for as many samples as there may be.
void require_surface(const TriangleMesh& mesh, const TriangleReport& report, const Context& context) {
  constexpr std::size_t kAsked = 2000;  // triangles, evenly picked: 500 of them are at kNoBody
  const double open = static_cast<double>(report.sides.n_open_edges) / (3 * static_cast<double>(mesh.F.size()));
  if (open < kNoSurface) return;
  std::vector<Vec3> centres;
  std::vector<std::uint32_t> faces;
  const std::size_t every = (mesh.F.size() + kAsked - 1) / kAsked;
  for (std::size_t f = every / 2; f < mesh.F.size(); f += every) {
    centres.push_back(mesh.centroid(f));
    faces.push_back(static_cast<std::uint32_t>(f));
  }
  const std::vector<double> w = TriangleWinding(mesh)(before(mesh, centres, faces), context);
  const auto n = std::count_if(w.begin(), w.end(), [](double x) { return std::abs(x - std::round(x)) > kUnsure; });
  const double unsure = static_cast<double>(n) / static_cast<double>(w.size());
  if (unsure < kNoBody) return;
  throw NoBody(
      formatted("the triangles bound no body: %.0f %% of their edges belong to one triangle alone, and which side is "
                "inside is a guess for %.0f %% of them; give a surface that is closed, but for holes",
                100 * open, 100 * unsure));
}

/// Openings are closed first, as their triangles look: which side of a closed wall is inside is sure, and the inner
/// wall of a pipe that is open at its ends is not. Where triangles along a rim contradict one another, they are turned
/// first.
void close_and_turn(const BodySampleParams& params, const Context& context, TriangleMesh& mesh,
                    TriangleReport& report) {
  const std::size_t n_given = mesh.F.size();
  if (params.cap) report.caps = cap_plane_rims(mesh, find_patches(mesh).weld_distance);
  if (params.turn) {
    report.sides = orient_outward(mesh, context);
    require_surface(mesh, report, context);
  }
  if (params.cap && params.turn && report.caps.empty()) {
    report.caps = cap_plane_rims(mesh, report.sides.weld_distance);
    if (!report.caps.empty()) orient_outward(mesh, context);
  }
  if (report.caps.empty()) return;
  label_caps(mesh, n_given, report.caps);
  std::size_t f = n_given;
  for (PlaneCap& cap : report.caps) {
    if (mesh.area_vector(f).dot(cap.normal) < 0) cap.normal = -cap.normal;
    f += cap.n_triangles;
  }
}

}  // namespace

std::vector<std::string> problems(const BodySampleParams& params) {
  if (params.spacing >= 0 && std::isfinite(params.spacing)) return {};
  return {formatted("spacing = %g: must be >= 0", params.spacing)};
}

double default_spacing(const TriangleMesh& mesh) {
  const double area = area_of(mesh);
  const double n_corners = static_cast<double>(mesh.F.size()) / 2;
  const double spacing = std::min(kSpacingOfDiagonal * diagonal_of(mesh), std::sqrt(area / n_corners));
  return std::max(spacing, std::sqrt(area / kMostSamples));
}

BodySamples sample_body(TriangleMesh mesh, const BodySampleParams& params, const Context& context) {
  if (const auto found = problems(params); !found.empty()) throw std::invalid_argument(found.front());
  BodySamples made;
  TriangleReport& report = made.report;
  report.n_triangles = mesh.F.size();
  report.dropped = drop_useless_faces(mesh);
  if (mesh.F.empty()) throw std::invalid_argument("no triangle has an area");
  const std::size_t n_given = mesh.F.size();
  const bool has_groups = !mesh.labels.empty();
  close_and_turn(params, context, mesh, report);
  report.spacing = default_spacing(mesh);
  if (params.spacing > 0) report.spacing = std::min(report.spacing, params.spacing);
  if (const double n = area_of(mesh) / (report.spacing * report.spacing); n > kTooMany)
    throw std::invalid_argument(
        formatted("%.3g samples %.3g apart are too many: at most %.0g", n, report.spacing, kTooMany));
  TriangleSamples samples = samples_by_thickness(mesh, report, context);
  const TriangleWinding w(mesh);
  const std::vector<double> w_before = w(before(mesh, samples.points, samples.faces), context);
  std::vector<Place> place(samples.points.size());
  std::transform(w_before.begin(), w_before.end(), place.begin(), place_of);
  report.n_samples = samples.points.size();
  // Caps lie on one another where one of two rims is inside of the other, as at the end of a pipe: no body is behind.
  if (!report.caps.empty()) {
    const std::vector<double> w_behind = w(beside(mesh, samples.points, samples.faces, -kBeside), context);
    for (std::size_t i = 0; i < place.size(); ++i)
      if (samples.faces[i] >= n_given && place[i] == Place::Boundary && w_behind[i] < kOutside)
        place[i] = Place::InsideOut;
  }
  std::vector<Vec3> normals(samples.points.size());
  for (std::size_t i = 0; i < normals.size(); ++i) normals[i] = mesh.area_vector(samples.faces[i]).normalized();
  const FacePatches patches = find_patches(mesh);
  report.touching.width = kContactWidth * report.spacing;
  const std::vector<std::uint8_t> goes =
      move_from_contacts(contact_points(mesh, patches, report.spacing, report.touching), report.touching.width,
                         params.touching, samples.points, normals);
  std::size_t n_unsure = 0;
  for (std::size_t i = 0; i < place.size(); ++i) {
    n_unsure += std::abs(w_before[i] - std::round(w_before[i])) > kUnsure ? 1 : 0;
    report.n_inside += place[i] == Place::Inside ? 1 : 0;
    report.n_inside_out += place[i] == Place::InsideOut ? 1 : 0;
    if (place[i] != Place::Boundary || goes[i]) continue;
    made.cloud.points.push_back(samples.points[i]);
    made.cloud.normals.push_back(normals[i]);
    if (!mesh.labels.empty()) made.cloud.labels.push_back(mesh.labels[samples.faces[i]]);
  }
  report.unsure = static_cast<double>(n_unsure) / static_cast<double>(place.size());
  made.boundary = on_boundary(mesh, shares_on_boundary(mesh, samples, place, w, context), has_groups);
  return made;
}

}  // namespace umtet
