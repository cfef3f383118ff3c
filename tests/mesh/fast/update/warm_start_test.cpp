#include "mesh/fast/update/warm_start.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "mesh/classification/classification.h"
#include "mesh/classification/configuration_costs.h"
#include "mesh/core/tet_quality.h"
#include "mesh/fast/fast_mesh.h"
#include "mesh/submesh/assemble_submesh.h"
#include "tests/support/domains.h"

namespace umtet {
namespace {

/// |x - c|^2 - 1, in a background of h = .15.
struct Ball {
  Vec3 c = Vec3::Zero();
  double value(const Vec3& x) const { return (x - c).squaredNorm() - 1; }
  Vec3 gradient(const Vec3& x) const { return 2 * (x - c); }
  Mat3 hessian(const Vec3&) const { return 2 * Mat3::Identity(); }
};

struct Begun {
  BackgroundMesh background{a15(), testing::cube_box(1.6), .15};
  FastMemory memory;
  IdSet inside{0};
  BackgroundLayer layer;
  WarmStart start;

  /// From the mesh of the ball at 0 to one that has moved by c.
  explicit Begun(const Vec3& c) {
    std::size_t n = 0;
    fast_mesh(background, Ball{}, {}, {}, {}, inside_vertices(background, Ball{}, n), memory);
    inside = inside_vertices(background, Ball{c}, n);
    classify_vertices(background, VertexLinks(background, a15_links()), Ball{c}, {}, inside, {}, &memory.inside);
    layer = linked_active_layer(background, VertexLinks(background, a15_links()), inside);
    start = warm_start(background, Ball{c}, inside, memory, {}, layer);
  }
};

TEST(WarmStart, BeginsOnTheSurfaceWithoutFlatTets) {
  const Vec3 c(.06, .02, 0);  // .42 h
  const Begun begun(c);
  const ActiveLayer& layer = begun.layer.layer;
  std::size_t boundary = 0, on_surface = 0, left = 0;
  for (std::size_t v = 0; v < layer.V.size(); ++v) {
    const Vec3 background = begun.background.position(begun.layer.background_vertex[v]);
    if (layer.role[v] == ActiveLayer::Role::Fixed) {
      EXPECT_EQ(layer.V[v], background);
    }
    if (layer.role[v] != ActiveLayer::Role::Boundary) continue;
    ++boundary;
    on_surface += std::abs((layer.V[v] - c).norm() - 1) < 1e-10;
    left += layer.V[v] == background;
  }
  EXPECT_GT(static_cast<double>(on_surface), .98 * static_cast<double>(boundary));
  EXPECT_EQ(begun.start.is_on_surface, left == 0);
  double least = 1, mean = 0;
  for (const Tet& t : layer.C) {
    const double Q = mean_ratio(layer.V[t[0]], layer.V[t[1]], layer.V[t[2]], layer.V[t[3]]);
    least = std::min(least, Q);
    mean += Q / static_cast<double>(layer.C.size());
  }
  EXPECT_GE(least, ProjectionParams{}.least_quality);
  EXPECT_GT(mean, .9);
}

TEST(WarmStart, RecallsWhoseNeighboursAreLabelledAsBefore) {
  const Vec3 c(.06, .02, 0);
  const Begun begun(c);
  const auto& ids = begun.layer.background_vertex;
  std::size_t n = 0;
  double farthest_boundary = 0, farthest_inner = 0, along_c = 0;
  for (const auto& [id, x] : begun.memory.moved) {
    const auto at = std::lower_bound(ids.begin(), ids.end(), id);
    if (at == ids.end() || *at != id) continue;
    const auto v = static_cast<std::size_t>(at - ids.begin());
    const auto as_before = [&](std::int64_t w) { return begun.inside.test(w) == begun.memory.inside.test(w); };
    std::vector<std::int64_t> link;
    begun.background.link(id, link);
    const bool same = as_before(id) && std::all_of(link.begin(), link.end(), as_before);
    n += begun.start.recalled[v];
    if (begun.start.recalled[v] == 0) continue;
    EXPECT_TRUE(same);
    const Vec3 moved = begun.layer.layer.V[v] - x;
    if (begun.layer.layer.role[v] == ActiveLayer::Role::Inner) {
      farthest_inner = std::max(farthest_inner, moved.norm());
      along_c += moved.dot(x) * c.dot(x);
    } else {
      farthest_boundary = std::max(farthest_boundary, moved.norm());
    }
  }
  // Inner ones follow the boundary, which moves along its normals.
  EXPECT_GT(along_c, 0);
  EXPECT_GT(farthest_inner, .1 * farthest_boundary);
  EXPECT_LT(farthest_inner, farthest_boundary);
  EXPECT_EQ(n, begun.start.n_recalled);
  EXPECT_GT(n, begun.memory.moved.size() / 4);
  EXPECT_LT(n, begun.memory.moved.size() * 9 / 10);
}

TEST(WarmStart, OfADomainThatStaysIsTheLastMesh) {
  const Begun begun(Vec3::Zero());
  EXPECT_GT(begun.start.n_recalled, begun.memory.moved.size() * 95 / 100);
  const auto& ids = begun.layer.background_vertex;
  for (const auto& [id, x] : begun.memory.moved) {
    const auto v = static_cast<std::size_t>(std::lower_bound(ids.begin(), ids.end(), id) - ids.begin());
    if (begun.start.recalled[v] != 0) {
      EXPECT_LT((begun.layer.layer.V[v] - x).norm(), 1e-9);
    }
  }
}

}  // namespace
}  // namespace umtet
