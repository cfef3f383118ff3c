#include "body/regions/region_bodies.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <nanoflann.hpp>
#include <set>
#include <utility>

#include "body/errors.h"
#include "body/option_names.h"
#include "mesh/background/a15_box.h"

namespace umtet {
namespace {

constexpr double kTets = 100000;  // where neither h nor a number of tets is given
// Points of a grid along each axis that estimate the volume of the bodies, to a per cent or two.
constexpr int kVolumeGrid = 60;
constexpr double kMissed = 1.5;         // in h
constexpr std::size_t kFewMissed = 10;  // samples
constexpr double kMostMissed = 1e-3;    // share of the samples

struct Points {
  std::vector<Vec3> x;
  std::size_t kdtree_get_point_count() const { return x.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t axis) const { return x[i][static_cast<Eigen::Index>(axis)]; }
  template <class B>
  bool kdtree_get_bbox(B&) const {
    return false;
  }
};
using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Points>, Points, 3>;

/// The share of the box that belongs to bodies.
double share_of_bodies(const RegionDomain& domain, const Box& box) {
  int n = 0;
  for (int i = 0; i < kVolumeGrid; ++i)
    for (int j = 0; j < kVolumeGrid; ++j)
      for (int k = 0; k < kVolumeGrid; ++k) {
        const Vec3 at = (Vec3(i, j, k).array() + .5).matrix() / kVolumeGrid;
        n += domain.region(box.min() + at.cwiseProduct(box.sizes())) != 0 ? 1 : 0;
      }
  return n / std::pow(kVolumeGrid, 3);
}

/// h, or the h with which the A15 tets of a volume have the requested number.
double edge_length(const RegionBodyOptions& options, const RegionDomain& domain, const Box& box) {
  if (options.h > 0) return options.h;
  const double n = options.tets > 0 ? static_cast<double>(options.tets) : kTets;
  const double volume = box.volume() * (options.has_outside ? 1 : share_of_bodies(domain, box));
  if (!(volume > 0)) throw MeshingImpossible("no body is in the box");
  return a15().mean_edge * std::cbrt(static_cast<double>(a15().tets.size()) * volume / n);
}

/// The box of the bodies whose boxes are known.
Box box_of(const std::vector<RegionBody>& bodies) {
  Box box;
  for (const RegionBody& body : bodies)
    if (body.box) box.extend(*body.box);
  if (box.isEmpty()) throw UsageError({"bodies of formulas need ", Setting(option::box, "x0,y0,z0,x1,y1,z1")});
  return box;
}

Box with_room(const Box& box, double room) {
  return {box.min() - Vec3::Constant(room), box.max() + Vec3::Constant(room)};
}

std::vector<std::string> names_of(const std::vector<RegionBody>& bodies) {
  if (bodies.empty()) throw UsageError("regions: there is no body");
  std::vector<std::string> names = {"outside"};
  std::set<std::string> known = {"outside"};
  for (const RegionBody& body : bodies) {
    std::string lower = body.name;  // Abaqus does not distinguish case
    std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return std::tolower(c); });
    if (!known.insert(lower).second) throw UsageError("regions: " + body.name + " is the name of another region");
    names.push_back(body.name);
  }
  return names;
}

/// Counts the samples of a body that no later body covers, and how many of these samples are far from its interfaces.
MissedBodySamples missed_samples(const std::vector<RegionBody>& bodies, std::size_t k, const RegionMesh& mesh,
                                 double h) {
  MissedBodySamples missed;
  missed.region = static_cast<int>(k) + 1;
  Points vertices;
  for (const InterfaceFace& f : mesh.interfaces)
    if (f.region == missed.region || f.other == missed.region)
      for (const int v : f.face) vertices.x.push_back(mesh.mesh.V[v]);
  const Tree tree(3, vertices);
  for (const Vec3& x : bodies[k].samples) {
    const bool is_covered = std::any_of(bodies.begin() + static_cast<std::ptrdiff_t>(k) + 1, bodies.end(),
                                        [&](const RegionBody& later) { return later.psi(x, nullptr, nullptr) < 0; });
    if (is_covered) continue;
    ++missed.n_visible;
    std::size_t nearest = 0;
    double squared = std::numeric_limits<double>::infinity();
    nanoflann::KNNResultSet<double> found(1);
    found.init(&nearest, &squared);
    if (!vertices.x.empty()) tree.findNeighbors(found, x.data(), nanoflann::SearchParams());
    const double distance = std::sqrt(squared);
    if (distance > kMissed * h) ++missed.n_missed;
    if (distance > missed.farthest) missed.farthest = distance, missed.where = x;
  }
  return missed;
}

}  // namespace

RegionBodyMesh mesh_region_bodies(const std::vector<RegionBody>& bodies, const RegionBodyOptions& options) {
  RegionBodyMesh made;
  made.names = names_of(bodies);
  std::vector<PatchFunction> functions;
  functions.reserve(bodies.size());
  for (const RegionBody& body : bodies) functions.push_back(body.psi);
  const RegionDomain domain = RegionDomain::of_bodies(std::move(functions));
  Box box = options.box ? *options.box : box_of(bodies);
  double h = edge_length(options, domain, box);
  if (!options.box) {
    box = with_room(box, kRoom * h);
    // The room belongs to the tets that were requested.
    if (options.h <= 0 && options.has_outside) h = edge_length(options, domain, box);
  }
  const BackgroundMesh background =
      options.has_outside ? BackgroundMesh(a15_box(box, h)) : BackgroundMesh(a15(), box, h);
  made.h = background.h();
  made.mesh = make_region_mesh(domain, background, {.has_outside = options.has_outside}, options.context);
  if (made.mesh.status == UmStatus::DomainLeavesBackground)
    throw MeshingImpossible("a body reaches the boundary of the box; give a box with three edges around the bodies");
  if (made.mesh.status != UmStatus::Success) throw MeshingImpossible(made.mesh.evidence.what);
  options.context.report("certify", .9);
  made.certificate = certify_regions(made.mesh.mesh, made.mesh.region, &domain, made.h, options.context);
  made.reasons = failures(made.certificate, domain.n_regions());
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    if (bodies[k].samples.empty()) continue;
    made.missed.push_back(missed_samples(bodies, k, made.mesh, made.h));
    const MissedBodySamples& m = made.missed.back();
    if (m.n_missed > kFewMissed && static_cast<double>(m.n_missed) > kMostMissed * static_cast<double>(m.n_visible))
      made.reasons.push_back(std::to_string(m.n_missed) + " samples of " + bodies[k].name +
                             " are farther than 1.5 h from its interfaces");
  }
  return made;
}

}  // namespace umtet
