// Edges of meshes whose edges are known.

#include "body/fidelity/mesh_sizes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <random>
#include <set>

#include "mesh/background/background_mesh.h"

namespace umtet {
namespace {

/// Edges of 1 from the origin, of sqrt(2) between the others.
const TetMesh kCorner{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}}};

TEST(MeshSizes, MeanEdgesAreOfEachVertex) {
  const std::vector<double> mean = mean_edges(kCorner.V, kCorner.C);
  EXPECT_DOUBLE_EQ(mean[0], 1);
  for (int i = 1; i < 4; ++i) EXPECT_DOUBLE_EQ(mean[i], (1 + 2 * std::sqrt(2.)) / 3);
}

// More vertices than are looked at together, in no order of their places.
TEST(MeshSizes, EveryEdgeCountsOnceWhateverTheNumbers) {
  const BackgroundMesh lattice(a15(), Box(Vec3(0, 0, 0), Vec3(1, 1, 1)), .032);
  std::vector<int> number(static_cast<std::size_t>(lattice.n_vertices()));
  std::iota(number.begin(), number.end(), 0);
  std::mt19937_64 random(1);
  std::shuffle(number.begin(), number.end(), random);
  TetMesh mesh;
  mesh.V.resize(number.size());
  for (std::size_t v = 0; v < number.size(); ++v) mesh.V[number[v]] = lattice.position(static_cast<std::int64_t>(v));
  std::set<std::array<int, 2>> edges;
  for (std::int64_t t = 0; t < lattice.n_tets(); ++t) {
    const auto ids = lattice.tet(t);
    Tet& tet = mesh.C.emplace_back();
    for (int k = 0; k < 4; ++k) tet[k] = number[static_cast<std::size_t>(ids[k])];
    for (int j = 0; j < 4; ++j) {
      for (int k = 0; k < j; ++k) edges.insert({std::min(tet[j], tet[k]), std::max(tet[j], tet[k])});
    }
  }
  ASSERT_GT(mesh.V.size(), 40000u);
  std::vector<double> sum(mesh.V.size()), asked(mesh.V.size());
  std::vector<int> n(mesh.V.size());
  for (std::size_t v = 0; v < asked.size(); ++v) asked[v] = .03 + .01 * mesh.V[v].x();
  std::vector<double> ratios;
  for (const auto& [i, j] : edges) {
    const double l = (mesh.V[i] - mesh.V[j]).norm();
    sum[i] += l, sum[j] += l, ++n[i], ++n[j];
    ratios.push_back(l / (.5 * (asked[i] + asked[j])));
  }
  const std::vector<double> mean = mean_edges(mesh.V, mesh.C);
  for (std::size_t v = 0; v < mean.size(); ++v) ASSERT_DOUBLE_EQ(mean[v], n[v] > 0 ? sum[v] / n[v] : 0);
  std::sort(ratios.begin(), ratios.end());
  const SizesReport r = sizes_report(mesh, {}, asked);
  const auto quantile = [&](double p) {
    const double at = p * static_cast<double>(ratios.size() - 1);
    const auto below = static_cast<std::size_t>(at);
    return ratios[below] + (at - std::floor(at)) * (ratios[std::min(below + 1, ratios.size() - 1)] - ratios[below]);
  };
  EXPECT_NEAR(r.p01, quantile(.01), 1e-6);
  EXPECT_NEAR(r.p50, quantile(.5), 1e-6);
  EXPECT_NEAR(r.p99, quantile(.99), 1e-6);
}

TEST(MeshSizes, TheReportHasWhatWasAskedForAndWhatWasMade) {
  const SizesReport r = sizes_report(kCorner, {{0, 1, 2}}, {.5, .5, .5, .5});
  EXPECT_DOUBLE_EQ(r.p50, (1 + std::sqrt(2.)) / 2 / .5);  // between three and three
  EXPECT_DOUBLE_EQ(r.p01, 2);
  EXPECT_DOUBLE_EQ(r.shortest_boundary_edge, 1);
  EXPECT_DOUBLE_EQ(r.longest_boundary_edge, std::sqrt(2.));
  EXPECT_EQ(r.least_asked, .5);
}

TEST(MeshSizes, AreAskedOfTheField) {
  const SizeField field({{{0, 0, 0}, .1}}, {.grade = .3, .h_min = .01, .h_max = 1});
  const std::vector<double> asked = asked_sizes(field, kCorner.V);
  EXPECT_NEAR(asked[0], .1, .005);
  EXPECT_NEAR(asked[1], .4, .02);
}

}  // namespace
}  // namespace umtet
