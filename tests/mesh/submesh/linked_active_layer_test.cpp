#include "mesh/submesh/linked_active_layer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <memory>
#include <set>

#include "mesh/classification/configuration_costs.h"
#include "mesh/core/tet_quality.h"
#include "mesh/octree/graded_mesh.h"
#include "mesh/sizes/body_size.h"
#include "mesh/submesh/assemble_submesh.h"
#include "tests/support/domains.h"

namespace umtet {
namespace {

using testing::AnalyticDomain;

struct Cut {
  BackgroundMesh background;
  IdSet inside;
  Submesh submesh;

  explicit Cut(const AnalyticDomain& domain, double n_tets = 8000)
      : background(a15(), domain.box, h_for_tets(domain, domain.box, n_tets)), inside(0), submesh() {
    std::size_t n = 0;
    inside = inside_vertices(background, domain, n);
    submesh = find_submesh(background, domain);
  }
};

TEST(EmitSubmesh, IsThePapersOmegaHWhenNoLabelIsChanged) {
  for (const AnalyticDomain& domain : testing::domains()) {
    SCOPED_TRACE(domain.name);
    const Cut cut(domain);
    const Submesh emitted = emit_submesh(cut.background, cut.inside);
    EXPECT_EQ(emitted.mesh.V, cut.submesh.mesh.V);
    EXPECT_EQ(emitted.mesh.C, cut.submesh.mesh.C);
    EXPECT_EQ(emitted.background_vertex, cut.submesh.background_vertex);
    EXPECT_EQ(emitted.background_tet, cut.submesh.background_tet);
    EXPECT_EQ(emitted.positive_faces, cut.submesh.positive_faces);
    EXPECT_EQ(emitted.positive_tets, cut.submesh.positive_tets);
    EXPECT_EQ(emitted.positive_vertices, cut.submesh.positive_vertices);
    const SubmeshOutline outline = outline_submesh(cut.background, cut.inside);
    EXPECT_EQ(outline.submesh.mesh.V, cut.submesh.mesh.V);
    EXPECT_EQ(outline.submesh.background_vertex, cut.submesh.background_vertex);
    EXPECT_EQ(outline.submesh.positive_vertices, cut.submesh.positive_vertices);
    EXPECT_EQ(outline.n_tets, cut.submesh.mesh.C.size());
  }
}

TEST(OutlineSubmesh, HasTheVerticesOfOmegaHOnAGradedBackground) {
  const AnalyticDomain domain = testing::sphere();
  Grading grading{.box = domain.box, .finest = .04, .size = {}};
  grading.size = [](const Vec3& x, double) { return .04 + .1 * (x - Vec3(0, 0, 1)).norm(); };
  const BackgroundMesh background{GradedMesh(grading)};
  std::size_t n = 0;
  const IdSet inside = inside_vertices(background, domain, n);
  const Submesh emitted = emit_submesh(background, inside);
  const SubmeshOutline outline = outline_submesh(background, inside);
  EXPECT_GT(outline.n_tets, 10000u);
  EXPECT_EQ(outline.n_tets, emitted.mesh.C.size());
  EXPECT_EQ(outline.submesh.mesh.V, emitted.mesh.V);
  EXPECT_EQ(outline.submesh.background_vertex, emitted.background_vertex);
  EXPECT_EQ(outline.submesh.positive_vertices, emitted.positive_vertices);
}

TEST(CrawlInside, FindsTheVerticesOfTheFullLoop) {
  for (const AnalyticDomain& domain : testing::domains()) {
    SCOPED_TRACE(domain.name);
    const Cut cut(domain);
    const CrawledVertices crawled = crawl_inside(cut.background, domain, domain.boundary_seeds);
    EXPECT_TRUE(crawled.lost_seeds.empty());
    for (std::size_t w = 0; w < cut.inside.n_words(); ++w) ASSERT_EQ(crawled.inside.word(w), cut.inside.word(w));
  }
}

std::vector<int> tets_at(const Submesh& submesh) {
  std::vector<int> n(submesh.mesh.V.size(), 0);
  for (const Tet& t : submesh.mesh.C) {
    for (const int v : t) ++n[v];
  }
  return n;
}

void check(const Cut& cut, const BackgroundLayer& part) {
  const ActiveLayer& layer = part.layer;
  const std::vector<int> whole = tets_at(cut.submesh);
  const auto& ids = cut.submesh.background_vertex;
  EXPECT_TRUE(std::is_sorted(part.background_vertex.begin(), part.background_vertex.end()));
  std::set<std::set<int>> seen;
  for (const Tet& t : layer.C) {
    EXPECT_GT(volume6(layer.V[t[0]], layer.V[t[1]], layer.V[t[2]], layer.V[t[3]]), 0);
    EXPECT_TRUE(seen.insert(std::set<int>(t.begin(), t.end())).second);
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < a; ++b) EXPECT_NE(layer.colour[t[a]], layer.colour[t[b]]);
    }
  }
  for (std::size_t v = 0; v < layer.V.size(); ++v) {
    const auto at = std::lower_bound(ids.begin(), ids.end(), part.background_vertex[v]);
    ASSERT_TRUE(at != ids.end() && *at == part.background_vertex[v]);
    const int local = static_cast<int>(at - ids.begin());
    EXPECT_EQ(layer.V[v], cut.submesh.mesh.V[local]);
    EXPECT_LT(layer.colour[v], 7);
    const int n = layer.ring_begin[v + 1] - layer.ring_begin[v];
    for (int r = layer.ring_begin[v]; r < layer.ring_begin[v + 1]; ++r) {
      const Tet& t = layer.C[layer.ring[r]];
      EXPECT_NE(std::find(t.begin(), t.end(), static_cast<int>(v)), t.end());
    }
    if (layer.role[v] != ActiveLayer::Role::Fixed) {
      EXPECT_EQ(n, whole[local]);
    }
    const bool positive =
        std::binary_search(cut.submesh.positive_vertices.begin(), cut.submesh.positive_vertices.end(), local);
    if (layer.role[v] != ActiveLayer::Role::Fixed) {
      EXPECT_EQ(layer.role[v] == ActiveLayer::Role::Boundary, positive);
    }
  }
}

TEST(LinkedActiveLayer, RingsAreCompleteAndColoursProper) {
  for (const AnalyticDomain& domain : testing::domains()) {
    SCOPED_TRACE(domain.name);
    const Cut cut(domain);
    std::size_t last = 0;
    for (const int layers : {1, 2, 100}) {
      const BackgroundLayer part =
          linked_active_layer(cut.background, VertexLinks(cut.background, a15_links()), cut.inside, layers);
      check(cut, part);
      const auto n_boundary = std::count(part.layer.role.begin(), part.layer.role.end(), ActiveLayer::Role::Boundary);
      EXPECT_EQ(static_cast<std::size_t>(n_boundary), cut.submesh.positive_vertices.size());
      EXPECT_GE(part.layer.C.size(), last);
      last = part.layer.C.size();
    }
    EXPECT_EQ(last, cut.submesh.mesh.C.size());  // a hundred layers are all of it
  }
}

TEST(LinkedActiveLayer, APatchHoldsEveryTetNearItsCentres) {
  const Cut cut(testing::torus());
  for (const std::size_t k : {0u, 100u, 333u}) {
    const std::int64_t centre = cut.submesh.background_vertex[cut.submesh.positive_vertices[k]];
    const BackgroundLayer part =
        active_patch(cut.background, VertexLinks(cut.background, a15_links()), cut.inside, {centre}, 2);
    check(cut, part);
    std::set<std::int64_t> ball = {centre};
    for (int ring = 0; ring < 2; ++ring) {
      std::vector<std::int64_t> more;
      for (const std::int64_t v : ball) cut.background.link(v, more);
      ball.insert(more.begin(), more.end());
    }
    std::size_t n = 0;
    for (const Tet& t : cut.submesh.mesh.C) {
      n += std::any_of(t.begin(), t.end(), [&](int v) { return ball.count(cut.submesh.background_vertex[v]) != 0; });
    }
    EXPECT_EQ(part.layer.C.size(), n);
  }
}

TEST(LayerPart, TwoPartsHaveTheTetsOfTheWholeLayerInItsOrder) {
  for (const AnalyticDomain& domain : testing::domains()) {
    SCOPED_TRACE(domain.name);
    const Cut cut(domain);
    const std::shared_ptr<const VertexLinks> kept = background_costs(cut.background)->links;
    const VertexLinks& links = *kept;
    const BackgroundLayer whole = linked_active_layer(cut.background, links, cut.inside);
    const IdSet movable = movable_vertices(cut.background, links, cut.inside);
    std::size_t n_movable = 0;
    movable.for_each([&](std::int64_t) { ++n_movable; });
    using Ids = std::array<std::int64_t, 4>;
    const auto ids = [](const BackgroundLayer& layer) {
      std::vector<Ids> list;
      for (const Tet& t : layer.layer.C) {
        Ids own{};
        for (std::size_t k = 0; k < 4; ++k) own[k] = layer.background_vertex[t[k]];
        list.push_back(own);
      }
      return list;
    };
    std::size_t n_own = 0;
    for (const int half : {0, 1}) {
      IdSet own(cut.background.n_vertices());
      movable.for_each([&](std::int64_t v) {
        if ((cut.background.position(v).x() < .1) == (half == 0)) own.insert(v);
      });
      const BackgroundLayer part = layer_part(cut.background, links, cut.inside, movable, own);
      std::vector<Ids> expected = ids(whole);
      std::erase_if(expected, [&](const Ids& t) {
        return std::none_of(t.begin(), t.end(), [&](std::int64_t v) { return own.test(v); });
      });
      EXPECT_EQ(ids(part), expected);
      for (std::size_t v = 0; v < part.layer.role.size(); ++v) {
        const auto at = std::lower_bound(whole.background_vertex.begin(), whole.background_vertex.end(),
                                         part.background_vertex[v]) -
                        whole.background_vertex.begin();
        const bool is_own = own.test(part.background_vertex[v]);
        n_own += is_own;
        EXPECT_EQ(part.layer.role[v], is_own ? whole.layer.role[at] : ActiveLayer::Role::Fixed);
      }
    }
    EXPECT_EQ(n_own, n_movable);
  }
}

}  // namespace
}  // namespace umtet
