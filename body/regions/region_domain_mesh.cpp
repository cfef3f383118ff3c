#include "body/regions/region_domain_mesh.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <set>
#include <stdexcept>
#include <utility>

#include "body/errors.h"
#include "body/option_names.h"
#include "common/formatted.h"
#include "mesh/background/a15_box.h"

namespace umtet {
namespace {

constexpr double kTets = 100000;  // where neither h nor a number of tets is given
// Points of a grid along each axis that estimate the volume of the bodies, to a per cent or two.
constexpr int kVolumeGrid = 60;

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
  return edge_length_of(volume, n);
}

Box with_room(const Box& box, double room) {
  return {box.min() - Vec3::Constant(room), box.max() + Vec3::Constant(room)};
}

void make_period(const RegionDomain& domain, const RegionBodyOptions& options, RegionBodyMesh& made) {
  if (!options.box)
    throw UsageError({"a periodic mesh needs ", Setting(option::box, "x0,y0,z0,x1,y1,z1"), ", one period"});
  made.h = edge_length(options, domain, *options.box);
  try {
    PeriodicMesh mesh =
        make_periodic_region_mesh(domain, *options.box, made.h, {.has_outside = options.has_outside}, options.context);
    if (mesh.mesh.status != UmStatus::Success) throw MeshingImpossible(mesh.mesh.evidence.what);
    made.match = match_sides(mesh);
    made.mesh = std::move(mesh.mesh);
    made.pairs = std::move(mesh.pairs);
    made.sides = mesh.sides;
  } catch (const std::invalid_argument& problem) {
    throw UsageError(std::string("regions: ") + problem.what());
  }
}

void make_in_box(const RegionDomain& domain, const Box& bodies, const RegionBodyOptions& options,
                 RegionBodyMesh& made) {
  Box box = options.box ? *options.box : bodies;
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
}

/// Returns the reasons why the sides of a periodic mesh do not match; empty if they do.
std::vector<std::string> periodic_failures(const RegionBodyMesh& made, bool has_outside) {
  std::vector<std::string> reasons;
  if (!made.match) return reasons;
  if (made.match->farthest > 0)
    reasons.push_back(formatted("a vertex is %.3g off its copy on the opposite side", made.match->farthest));
  if (has_outside && made.match->n_unmatched > 0)
    reasons.push_back(formatted("%zu boundary faces have no copy on the opposite side", made.match->n_unmatched));
  return reasons;
}

}  // namespace

double edge_length_of(double volume, double n_tets) {
  return a15().mean_edge * std::cbrt(static_cast<double>(a15().tets.size()) * volume / n_tets);
}

RegionBodyMesh mesh_region_domain(const RegionDomain& domain, std::vector<std::string> names, const Box& bodies,
                                  const RegionBodyOptions& options) {
  std::set<std::string> known;
  for (const std::string& name : names) {
    std::string lower = name;  // Abaqus does not distinguish case
    std::transform(lower.begin(), lower.end(), lower.begin(), [](unsigned char c) { return std::tolower(c); });
    if (!known.insert(lower).second) throw UsageError("regions: " + name + " is the name of another region");
  }
  RegionBodyMesh made;
  made.names = std::move(names);
  if (options.is_periodic) {
    make_period(domain, options, made);
  } else {
    make_in_box(domain, bodies, options, made);
  }
  if (made.mesh.status == UmStatus::DomainLeavesBackground)
    throw MeshingImpossible("a body reaches the boundary of the box; give a box with three edges around the bodies");
  if (made.mesh.status != UmStatus::Success) throw MeshingImpossible(made.mesh.evidence.what);
  options.context.report("certify", .9);
  made.certificate = certify_regions(made.mesh.mesh, made.mesh.region, &domain, made.h, options.context,
                                     made.match ? made.match->sides : std::vector<Triangle>());
  made.reasons = failures(made.certificate, domain.n_regions(), made.names);
  for (std::string& reason : periodic_failures(made, options.has_outside)) made.reasons.push_back(std::move(reason));
  return made;
}

}  // namespace umtet
