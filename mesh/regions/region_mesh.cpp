#include "mesh/regions/region_mesh.h"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "mesh/classification/configuration_costs.h"
#include "mesh/regions/detail/region_fit.h"
#include "mesh/regions/detail/region_parts.h"

namespace umtet {
namespace {

// Where projection and the flips begin, as shares of the time.
constexpr double kProject = .3, kRepair = .6;

/// All tets of the background, with the greatest label of their vertices.
void list_tets(const BackgroundMesh& background, const std::vector<std::uint8_t>& label, RegionMesh& made) {
  std::vector<int> number(label.size(), -1);
  const auto region_of = [&](const std::array<std::int64_t, 4>& tet) {
    std::uint8_t region = 0;
    for (const std::int64_t v : tet) region = std::max(region, label[static_cast<std::size_t>(v)]);
    return region;
  };
  const std::int64_t n = background.n_tets();
  if (n > std::numeric_limits<int>::max()) throw std::length_error("a mesh of more than 2^31 - 1 tets");
  for (std::int64_t t = 0; t < n; ++t)
    for (const std::int64_t v : background.tet(t)) number[static_cast<std::size_t>(v)] = 0;
  for (std::size_t v = 0; v < number.size(); ++v) {
    if (number[v] < 0) continue;
    number[v] = static_cast<int>(made.background_vertex.size());
    made.background_vertex.push_back(static_cast<std::int64_t>(v));
    made.mesh.V.push_back(background.position(static_cast<std::int64_t>(v)));
    made.h.push_back(background.h(static_cast<std::int64_t>(v)));
  }
  made.mesh.C.reserve(static_cast<std::size_t>(n));
  made.region.reserve(static_cast<std::size_t>(n));
  for (std::int64_t t = 0; t < n; ++t) {
    const auto tet = background.tet(t);
    Tet local{};
    for (int k = 0; k < 4; ++k) local[k] = number[static_cast<std::size_t>(tet[k])];
    made.mesh.C.push_back(local);
    made.region.push_back(region_of(tet));
    made.background_tet.push_back(t);
  }
}

}  // namespace

RegionMesh make_region_mesh(const RegionDomain& domain, const BackgroundMesh& background,
                            const RegionMeshParams& params, const Context& context) {
  if (params.layers < 1) throw std::invalid_argument("layers must be >= 1");
  RegionMesh made;
  context.report("search", 0);
  const auto costs = background_costs(background);
  if (!costs) throw std::invalid_argument("regions need a background whose links fit into masks");
  made.labels = choose_labels(domain, background, *costs->links, params.labels, context);
  if (made.labels.leaves_background) {
    made.status = UmStatus::DomainLeavesBackground;
    made.evidence.what = "a region reaches the boundary of the background mesh";
    return made;
  }
  if (made.labels.n_interface == 0) {
    made.status = UmStatus::EmptyDomain;
    made.evidence.what = "no vertex of the background is in a region";
    return made;
  }
  list_tets(background, made.labels.of_vertex, made);
  made.labels.of_vertex = {};
  detail::find_regions_at_vertices(made);
  std::vector<char> is_fixed;
  is_fixed.reserve(made.mesh.V.size());
  for (const std::int64_t v : made.background_vertex) is_fixed.push_back(background.on_boundary(v) ? 1 : 0);
  context.report("project", kProject);
  detail::move_onto_strata(domain, is_fixed, params, made, context);
  context.report("repair", kRepair);
  detail::flip_regions(domain, is_fixed, params.flips, made, context);
  detail::find_regions_at_vertices(made);
  detail::finish(
      domain, params, [&](std::int64_t v) { return background.position(v); }, made);
  return made;
}

}  // namespace umtet
