#include "body/regions/region_bodies.h"

#include <cmath>
#include <limits>
#include <nanoflann.hpp>
#include <utility>

#include "body/errors.h"
#include "body/option_names.h"

namespace umtet {
namespace {

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

/// The box of the bodies whose boxes are known.
Box box_of(const std::vector<RegionBody>& bodies) {
  Box box;
  for (const RegionBody& body : bodies)
    if (body.box) box.extend(*body.box);
  if (box.isEmpty()) throw UsageError({"bodies of formulas need ", Setting(option::box, "x0,y0,z0,x1,y1,z1")});
  return box;
}

std::vector<std::string> names_of(const std::vector<RegionBody>& bodies) {
  if (bodies.empty()) throw UsageError("regions: there is no body");
  std::vector<std::string> names = {"outside"};
  for (const RegionBody& body : bodies) names.push_back(body.name);
  return names;
}

RegionDomain domain_of(const std::vector<RegionBody>& bodies, Overlap overlap) {
  std::vector<PatchFunction> functions;
  functions.reserve(bodies.size() + 1);
  if (overlap == Overlap::Least)
    functions.emplace_back([](const Vec3&, Vec3* gradient, Mat3* hessian) {
      if (gradient) gradient->setZero();
      if (hessian) hessian->setZero();
      return 0.;
    });
  for (const RegionBody& body : bodies) functions.push_back(body.psi);
  return overlap == Overlap::Least ? RegionDomain::of_least(std::move(functions))
                                   : RegionDomain::of_bodies(std::move(functions));
}

/// Counts the samples of a body that no other body covers, and how many of these samples are far from its interfaces.
MissedBodySamples missed_samples(const RegionDomain& domain, const RegionBody& body, int region,
                                 const RegionBodyMesh& made) {
  MissedBodySamples missed;
  missed.region = region;
  Points vertices;
  for (const InterfaceFace& f : made.mesh.interfaces)
    if (f.region == region || f.other == region)
      for (const int v : f.face) vertices.x.push_back(made.mesh.mesh.V[v]);
  const Tree tree(3, vertices);
  for (const Vec3& x : body.samples) {
    // Earlier bodies have no part in a sample that is inside of one by rounding.
    const int here = domain.region(x);
    if (domain.has_bodies() ? here > region : here != region && here != 0) continue;
    ++missed.n_visible;
    std::size_t nearest = 0;
    double squared = std::numeric_limits<double>::infinity();
    nanoflann::KNNResultSet<double> found(1);
    found.init(&nearest, &squared);
    if (!vertices.x.empty()) tree.findNeighbors(found, x.data(), nanoflann::SearchParams());
    const double distance = std::sqrt(squared);
    if (distance > kMissed * made.h) ++missed.n_missed;
    if (distance > missed.farthest) missed.farthest = distance, missed.where = x;
  }
  return missed;
}

}  // namespace

RegionBodyMesh mesh_region_bodies(const std::vector<RegionBody>& bodies, const RegionBodyOptions& options,
                                  Overlap overlap) {
  std::vector<std::string> names = names_of(bodies);
  const RegionDomain domain = domain_of(bodies, overlap);
  RegionBodyMesh made =
      mesh_region_domain(domain, std::move(names), options.box ? *options.box : box_of(bodies), options);
  for (std::size_t k = 0; k < bodies.size(); ++k) {
    if (bodies[k].samples.empty()) continue;
    made.missed.push_back(missed_samples(domain, bodies[k], static_cast<int>(k) + 1, made));
    const MissedBodySamples& m = made.missed.back();
    if (m.n_missed > kFewMissed && static_cast<double>(m.n_missed) > kMostMissed * static_cast<double>(m.n_visible))
      made.reasons.push_back(std::to_string(m.n_missed) + " samples of " + bodies[k].name +
                             " are farther than 1.5 h from its interfaces");
  }
  return made;
}

}  // namespace umtet
