// Measures how well the tets around a boundary vertex can be shaped, for every configuration of its link.
//
//   star_costs TILING SEED SHAPES > mesh/classification/tables/TILING.h
//
// Random smooth bodies are meshed without the table's help (classified by the sign of psi), with costs at random (so
// that configurations are met that psi alone hardly makes), and with the costs found so far (so that they are met among
// good neighbours). Each mesh is smoothed towards a target out of reach, and the worst quality around every boundary
// vertex is booked under (site, positive faces, tets). What a configuration can reach is the 95 % quantile: the best
// few owe it to luck with curvature, and most others suffer from a neighbour.

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "mesh/background/vertex_links.h"
#include "mesh/classification/classification.h"
#include "mesh/classification/configuration_costs.h"
#include "mesh/core/tet_quality.h"
#include "mesh/fast/projection/backtracking_projection.h"
#include "mesh/sizes/body_size.h"
#include "mesh/submesh/assemble_submesh.h"
#include "mesh/submesh/linked_active_layer.h"
#include "tools/star_costs/random_shape.h"

using namespace umtet;

namespace {

constexpr double kTets = 30000;  // features of the bodies are then ten edges and more
constexpr double kQuantile = .95;
constexpr std::size_t kEnough = 60;
constexpr double kOutOfReach = .93;  // no boundary vertex was seen above .90
constexpr int kRounds = 4;

using Configuration = std::tuple<int, int, int>;  // site, positive faces, tets
using Book = std::map<Configuration, std::vector<float>>;

/// Meshes one body and books its boundary vertices.
void measure(const star_costs::RandomShape& shape, const Tiling& tiling, const StarCostTable* costs, Book& book) {
  const double h = h_for_tets(tiling, shape, shape.box(), kTets);
  const Box padded(shape.box().min() - Vec3::Constant(2 * h), shape.box().max() + Vec3::Constant(2 * h));
  const BackgroundMesh background(tiling, padded, h);
  const VertexLinks links(background, configuration_costs(tiling)->links);
  std::size_t evaluations = 0;
  IdSet inside = inside_vertices(background, shape, evaluations);
  if (costs) {
    ClassificationParams params;
    params.costs = costs;
    classify_vertices(background, links, shape, params, inside);
  }
  BackgroundLayer cut = linked_active_layer(background, links, inside);
  const ProjectionReport projection = project(cut.layer, shape);
  if (!projection.not_arrived.empty()) return;
  SmoothingParams smoothing;
  smoothing.target = kOutOfReach;
  smoothing.margin = 0;
  smooth(cut.layer, shape, smoothing);
  for (std::size_t v = 0; v < cut.layer.V.size(); ++v) {
    if (cut.layer.role[v] != ActiveLayer::Role::Boundary) continue;
    const std::int64_t id = cut.background_vertex[v];
    const LinkTopology& link = links.at(id);
    const LinkState state = link.state(links.mask(id, inside));
    if (!state.manifold) continue;
    double worst = 1;
    for (int r = cut.layer.ring_begin[v]; r < cut.layer.ring_begin[v + 1]; ++r) {
      worst = std::min(worst, mean_ratio({cut.layer.V, {}}, cut.layer.C[cut.layer.ring[r]]));
    }
    book[{link.site, state.n_positive_faces, state.n_tets}].push_back(static_cast<float>(worst));
  }
}

std::vector<ConfigurationQuality> qualities(Book& book) {
  std::vector<ConfigurationQuality> list;
  for (auto& [configuration, seen] : book) {
    if (seen.size() < kEnough) continue;
    const auto at = seen.begin() + static_cast<std::ptrdiff_t>(kQuantile * static_cast<double>(seen.size()));
    std::nth_element(seen.begin(), at, seen.end());
    const auto [site, faces, tets] = configuration;
    list.push_back({site, faces, tets, static_cast<double>(*at)});
  }
  return list;
}

/// Costs up to 100 at random, one for each configuration.
StarCostTable random_costs(const ConfigurationCosts& costs, std::uint64_t seed) {
  std::vector<ConfigurationQuality> list;
  int n_sites = 0;
  for (const LinkTopology& link : costs.links) n_sites = std::max(n_sites, link.site + 1);
  std::uint64_t state = seed;
  for (int site = 0; site < n_sites; ++site) {
    for (int faces = 3; faces <= 14; ++faces) {
      for (int tets = 3; tets <= 24; ++tets) {
        state = state * 6364136223846793005u + 1442695040888963407u;
        list.push_back({site, faces, tets, costs.good - .16 + .10 * static_cast<double>(state >> 11) * 0x1p-53});
      }
    }
  }
  return StarCostTable(costs.links, list, costs.good);
}

}  // namespace

int main(int argc, char** argv) {
  const auto names = tiling_names();
  if (argc != 4 || std::find(names.begin(), names.end(), argv[1]) == names.end()) {
    std::fprintf(stderr, "usage: star_costs TILING SEED SHAPES\n");
    return 2;
  }
  const std::string name = argv[1];
  const Tiling& tiling = tiling_named(name);
  const ConfigurationCosts& costs = *configuration_costs(tiling);  // all but its qualities
  const std::uint64_t seed = std::strtoull(argv[2], nullptr, 10);
  const int n_shapes = std::atoi(argv[3]);
  Book book;
  for (int round = 0; round < kRounds; ++round) {
    const StarCostTable fitted(costs.links, qualities(book), costs.good);
    for (int s = 0; s < n_shapes; ++s) {
      const std::uint64_t number = seed + static_cast<std::uint64_t>(round * n_shapes + s);
      const star_costs::RandomShape shape(number);
      const StarCostTable dice = random_costs(costs, number);
      measure(shape, tiling, round == 0 ? nullptr : round == 1 ? &dice : &fitted, book);
    }
    std::fprintf(stderr, "round %d of %d done\n", round + 1, kRounds);
  }
  const std::vector<ConfigurationQuality> list = qualities(book);
  std::printf(
      "#pragma once\n\n#include <array>\n\n#include \"mesh/classification/star_cost_table.h\"\n\nnamespace umtet "
      "{\n\n");
  std::printf(
      "// Made by: star_costs %s %s %s (%.0f tets a body, %d rounds, quantile %.2f, at least %zu vertices each).\n",
      argv[1], argv[2], argv[3], kTets, kRounds, kQuantile, kEnough);
  std::printf("// Neighbours of a vertex of site 0, 1 ...:");
  std::map<int, int> neighbours;
  for (const LinkTopology& link : costs.links) neighbours[link.site] = link.n;
  for (const auto& [site, n] : neighbours) std::printf(" %d", n);
  std::printf(". The last column counts the vertices seen.\n");
  const std::string first(1, static_cast<char>(std::toupper(name[0])));
  std::printf("inline constexpr std::array<ConfigurationQuality, %zu> k%sConfigurationQualities = {{\n", list.size(),
              (first + name.substr(1)).c_str());
  for (const ConfigurationQuality& q : list) {
    std::printf("    {%d, %d, %d, %.4f},  // %zu\n", q.site, q.n_positive_faces, q.n_tets, q.quality,
                book.at({q.site, q.n_positive_faces, q.n_tets}).size());
  }
  std::printf("}};\n\n}  // namespace umtet\n");
  return 0;
}
