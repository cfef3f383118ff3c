#include "body/sizing/thick_body.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "body/sizing/background_choice.h"
#include "body/sizing/edge_length.h"
#include "reconstruct/cloud/neighbours/neighbour_tree.h"
#include "reconstruct/triangles/body_thickness.h"
#include "reconstruct/triangles/cut_triangles.h"
#include "reconstruct/triangles/triangle_samples.h"
#include "reconstruct/triangles/triangle_tree.h"
#include "reconstruct/triangles/triangle_winding.h"

namespace umtet {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Samples of the triangles: 20 of them are thinner than the .1 % that are thinnest.
constexpr double kSamples = 20000;
// Least gap between two sheets that have come nearer to each other, in h: below it the vertices between them are inside
// or outside by chance.
constexpr double kLeastGap = 1.1;
// Thickening changes by this much a length: the thickened sheet has a slope of no more.
constexpr double kSlope = .5;
// In h: vertices that are farther from the triangles keep the sign that psi has there.
constexpr double kReach = 3;
// In h: large triangles are cut into pieces of this, which nearest neighbours are found faster among.
constexpr double kPiece = 4;
constexpr std::size_t kPieces = 400000;
// Of the size of a triangle: a foot that is so near to its border lies on several, whose normals do not say the side.
constexpr double kAtBorder = 1e-6;
// What repair reaches of the mean ratio of a slab of regular tets that is pressed flat: .69 of .89 at 1.25 h, .60 of
// .80 at 1 h, .43 of .59 at .57 h.
constexpr double kOfSlab = .75;

}  // namespace

bool may_be_thickened(const Domain& domain, const BodyOptions& options) {
  const bool has_psi = domain.fitted || domain.has_edges_of_triangles();
  return domain.triangles && domain.triangles->body.is_closed && has_psi && !domain.complement &&
         classification_source(options) == ClassificationSource::Chosen;
}

double TriangleThickness::share(double part) const {
  std::vector<double> t(body.size());
  for (std::size_t i = 0; i < t.size(); ++i) t[i] = std::min(body[i], gap[i]);
  return thin_share_of(std::move(t), part);
}

TriangleThickness triangle_thickness(const Domain& domain, double limit, const Context& context) {
  const TriangleMesh& mesh = domain.triangles->mesh;
  const double area = domain.triangles->body.area;
  TriangleSamples samples = sample_triangles(mesh, std::sqrt(area / kSamples), 0, context);
  const std::vector<FacingSheets> sheets =
      facing_sheets(mesh, TriangleTree(mesh), samples.points, samples.faces, limit, context);
  TriangleThickness t;
  for (const FacingSheets& s : sheets) {
    t.body.push_back(s.body);
    t.gap.push_back(s.gap);
  }
  t.area_of_sample = area / static_cast<double>(sheets.size());
  t.points = std::move(samples.points);
  return t;
}

double thickening(double thickness, double h) { return std::max(0., (kEdgesAcross * h - thickness) / 2); }

BodySize thickened_size(const BodySize& size, const TriangleThickness& thickness, double h) {
  double more = 0;
  for (const double t : thickness.body) more += thickness.area_of_sample * thickening(t, h);
  return {size.volume + more, size.area};
}

double quality_within_reach(double thickness, double h) {
  const double s = std::min(1., thickness / (kEdgesAcross * h));
  return kOfSlab * 3 * std::cbrt(s * s) / (2 + s * s);
}

struct ThickBody::Parts {
  const Domain& domain;
  ImplicitFunctionRef psi;
  TriangleMesh pieces;
  TriangleTree tree;
  TriangleWinding winding;
  double h;
  std::vector<double> thickening, most;  ///< of samples that are thin, or have a thin gap before them
  std::optional<NeighbourTree> thin;

  Parts(const Domain& d, const TriangleThickness& thickness, double edge)
      : domain(d),
        psi(d.body()),
        pieces(cut_triangles(d.triangles->mesh, kPiece * edge, kPieces + d.triangles->mesh.F.size()).mesh),
        tree(pieces),
        winding(pieces),
        h(edge) {
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < thickness.points.size(); ++i) {
      const double more = umtet::thickening(thickness.body[i], h);
      const double limit = std::max(0., (thickness.gap[i] - kLeastGap * h) / 2);
      if (!(more > 0) && limit >= kEdgesAcross * h / 2) continue;
      points.push_back(thickness.points[i]);
      thickening.push_back(more);
      most.push_back(limit);
    }
    if (!points.empty()) thin.emplace(points);
  }

  double thickening_at(const Vec3& foot) const {
    if (!thin) return 0;
    const double reach = kEdgesAcross * h / 2 / kSlope;
    double more = 0, limit = kInfinity;
    thin->within(foot, reach * reach, [&](std::uint32_t i, double d2) {
      const double fall = kSlope * std::sqrt(d2);
      more = std::max(more, thickening[i] - fall);
      limit = std::min(limit, most[i] + fall);
    });
    return std::min(more, limit);
  }

  bool is_inside(const Vec3& x, const TriangleHit& hit) const {
    const Vec3 &a = pieces.corner(hit.face, 0), &b = pieces.corner(hit.face, 1), &c = pieces.corner(hit.face, 2);
    const Vec3 n = (b - a).cross(c - a);
    const double least = kAtBorder * n.squaredNorm();
    const bool is_within = (b - a).cross(hit.point - a).dot(n) > least && (c - b).cross(hit.point - b).dot(n) > least &&
                           (a - c).cross(hit.point - c).dot(n) > least;
    return is_within ? (x - hit.point).dot(n) < 0 : winding(x) > .5;
  }
};

ThickBody::ThickBody(const Domain& domain, const TriangleThickness& thickness, double h)
    : parts_(std::make_unique<const Parts>(domain, thickness, h)) {}
ThickBody::~ThickBody() = default;
ThickBody::ThickBody(ThickBody&&) noexcept = default;

double ThickBody::evaluate(const Vec3& x, Vec3* gradient, Mat3* hessian) const {
  const Parts& p = *parts_;
  if (hessian) hessian->setZero();
  const auto hit = p.tree.nearest(x, kReach * p.h, [](std::uint32_t) { return true; });
  if (!hit) {
    Vec3 g;
    const double psi = gradient ? p.psi.value(x, g) : p.psi.value(x);
    if (gradient) *gradient = g.norm() > 0 ? Vec3(g.normalized()) : Vec3::UnitX();
    return psi < 0 ? -kReach * p.h : kReach * p.h;
  }
  const double side = p.is_inside(x, *hit) ? -1 : 1;
  if (gradient) {
    const Vec3 off = side * (x - hit->point);
    *gradient = hit->distance > 0 ? Vec3(off / hit->distance) : p.pieces.area_vector(hit->face).normalized();
  }
  return side * hit->distance - p.thickening_at(hit->point);
}

}  // namespace umtet
