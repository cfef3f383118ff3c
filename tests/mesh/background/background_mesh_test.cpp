#include "mesh/background/background_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "mesh/core/tet_quality.h"
#include "mesh/sizes/body_size.h"
#include "mesh/submesh/assemble_submesh.h"
#include "mesh/submesh/crawl.h"
#include "mesh/submesh/linked_active_layer.h"
#include "tests/support/domains.h"

namespace umtet {
namespace {

const Box kUnitBox(Vec3::Zero(), Vec3::Ones());

/// The laws of a background mesh, for one over each tiling.
class OnEveryTiling : public ::testing::TestWithParam<std::string_view> {
 protected:
  const Tiling& tiling() const { return tiling_named(GetParam()); }
};
INSTANTIATE_TEST_SUITE_P(BackgroundMesh, OnEveryTiling,
                         ::testing::ValuesIn(tiling_names().begin(), tiling_names().end()),
                         [](const auto& info) { return std::string(info.param); });

TEST_P(OnEveryTiling, NeighborsShareTheirFaceAndAgree) {
  const BackgroundMesh mesh(tiling(), kUnitBox, .2);
  std::map<std::array<std::int64_t, 3>, int> faces;
  for (std::int64_t t = 0; t < mesh.n_tets(); ++t) {
    const auto tet = mesh.tet(t);
    for (int k = 0; k < 4; ++k) {
      std::array<std::int64_t, 3> face;
      for (int j = 0, m = 0; j < 4; ++j) {
        if (j != k) face[m++] = tet[j];
      }
      std::sort(face.begin(), face.end());
      ++faces[face];
      const std::int64_t other = mesh.neighbor(t, k);
      if (other < 0) continue;
      const auto shared = mesh.tet(other);
      int back = -1;
      for (int j = 0; j < 4; ++j) {
        if (std::find(face.begin(), face.end(), shared[j]) == face.end()) back = j;
      }
      for (const std::int64_t v : face) ASSERT_NE(std::find(shared.begin(), shared.end(), v), shared.end());
      ASSERT_EQ(mesh.neighbor(other, back), t);
    }
  }
  std::size_t background_boundary = 0;
  for (std::int64_t t = 0; t < mesh.n_tets(); ++t) {
    for (int k = 0; k < 4; ++k) background_boundary += mesh.neighbor(t, k) < 0;
  }
  std::size_t single = 0;
  for (const auto& [face, n] : faces) {
    ASSERT_LE(n, 2);
    single += n == 1;
  }
  EXPECT_EQ(single, background_boundary);
}

TEST_P(OnEveryTiling, StarAndLinkAreWhatTheTetsSay) {
  const BackgroundMesh mesh(tiling(), kUnitBox, .3);
  std::vector<std::set<std::int64_t>> star(mesh.n_vertices()), link(mesh.n_vertices());
  for (std::int64_t t = 0; t < mesh.n_tets(); ++t) {
    for (const std::int64_t v : mesh.tet(t)) {
      star[v].insert(t);
      for (const std::int64_t w : mesh.tet(t)) {
        if (w != v) link[v].insert(w);
      }
    }
  }
  for (std::int64_t v = 0; v < mesh.n_vertices(); ++v) {
    std::vector<std::int64_t> s, l;
    mesh.star(v, s);
    mesh.link(v, l);
    ASSERT_EQ(s, std::vector<std::int64_t>(star[v].begin(), star[v].end()));
    ASSERT_EQ(l, std::vector<std::int64_t>(link[v].begin(), link[v].end()));
    ASSERT_EQ(mesh.has_tets(v), !star[v].empty());
    ASSERT_EQ(mesh.on_boundary(v), star[v].size() < mesh.tiling_tables().star[mesh.type(v)].size());
  }
}

TEST_P(OnEveryTiling, CoversTheBox) {
  const Box box(Vec3(-1, .5, 3), Vec3(.3, 1.1, 3.9));
  const BackgroundMesh mesh(tiling(), box, .21);
  EXPECT_TRUE(mesh.box().contains(box));
  EXPECT_EQ(mesh.tet_near(box.min() - Vec3::Ones()), -1);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int n = 0; n < 2000; ++n) {
    // Every point of the box, corners included, is in a tet: walk to it.
    Vec3 x = box.min() + box.sizes().cwiseProduct(Vec3(unit(random), unit(random), unit(random)));
    if (n < 8) x = box.corner(static_cast<Box::CornerType>(n));
    std::int64_t t = mesh.tet_near(x);
    bool found = false;
    for (int step = 0; step < 200 && t >= 0 && !found; ++step) {
      const auto tet = mesh.tet(t);
      std::array<Vec3, 4> p;
      for (int k = 0; k < 4; ++k) p[k] = mesh.position(tet[k]);
      int worst = -1;
      double least = -1e-12;
      for (int k = 0; k < 4; ++k) {
        std::array<Vec3, 4> q = p;
        q[k] = x;
        const double b = volume6(q[0], q[1], q[2], q[3]) / volume6(p[0], p[1], p[2], p[3]);
        if (b < least) least = b, worst = k;
      }
      found = worst < 0;
      if (!found) t = mesh.neighbor(t, worst);
    }
    ASSERT_TRUE(found) << x.transpose();
  }
}

TEST(BackgroundMesh, RunsOffTheRimHaveNoVertexOnIt) {
  const BackgroundMesh mesh(a15(), kUnitBox, .05);
  std::vector<char> on_boundary;
  for (std::int64_t v = 0; v < mesh.n_vertices(); ++v) on_boundary.push_back(mesh.on_boundary(v));
  const auto n = static_cast<std::int64_t>(on_boundary.size());
  std::int64_t said = 0;
  for (std::int64_t first = 0; first < n; ++first) {
    for (const std::int64_t last : {first, std::min(first + 63, n - 1)}) {
      if (!mesh.is_off_boundary(first, last)) continue;
      ++said;
      ASSERT_EQ(std::count(on_boundary.begin() + first, on_boundary.begin() + last + 1, 1), 0) << first;
    }
  }
  EXPECT_GT(said, n / 2);
}

TEST(BackgroundMesh, RefusesWhatCannotBeBuilt) {
  EXPECT_THROW(BackgroundMesh(a15(), kUnitBox, 0), std::invalid_argument);
  EXPECT_THROW(BackgroundMesh(a15(), kUnitBox, std::nan("")), std::invalid_argument);
  EXPECT_THROW(BackgroundMesh(a15(), Box(), .1), std::invalid_argument);
  EXPECT_THROW(BackgroundMesh(a15(), kUnitBox, 1e-5), std::invalid_argument);
}

BackgroundMesh background_of(const Tiling& tiling, const testing::AnalyticDomain& domain, double n_tets) {
  return BackgroundMesh(tiling, domain.box, h_for_tets(tiling, domain, domain.box, n_tets));
}

TEST_P(OnEveryTiling, CrawlingAndCellsFindWhatTheFullLoopFinds) {
  for (const auto& domain : {testing::torus(), testing::equation_9()}) {
    const BackgroundMesh background = background_of(tiling(), domain, 20000);
    const Submesh all = find_submesh(background, domain);
    const Crawl crawled = crawl(background, domain, domain.boundary_seeds);
    EXPECT_TRUE(crawled.lost_seeds.empty()) << domain.name;
    const CrawledVertices flooded = crawl_inside(background, domain, domain.boundary_seeds);
    for (const Submesh& other : {crawled.submesh, emit_submesh(background, flooded.inside)}) {
      EXPECT_EQ(other.background_tet, all.background_tet) << domain.name;
      EXPECT_EQ(other.background_vertex, all.background_vertex) << domain.name;
      EXPECT_EQ(other.mesh.C, all.mesh.C) << domain.name;
      EXPECT_EQ(other.positive_faces, all.positive_faces) << domain.name;
    }
  }
}

TEST_P(OnEveryTiling, TheNumberOfTetsAskedForIsMade) {
  for (const double n : {15000., 100000.}) {
    const auto domain = testing::equation_9();
    const auto made = static_cast<double>(find_submesh(background_of(tiling(), domain, n), domain).mesh.C.size());
    EXPECT_NEAR(made / n, 1, .1);
  }
}

TEST_P(OnEveryTiling, APartHasThePlacesOfTheWholeAndItsOrder) {
  const BackgroundMesh whole(tiling(), Box(Vec3::Zero(), Vec3(1, 1.4, 1.2)), .06);
  const BackgroundMesh::Cell& n = whole.n_cells();
  const BackgroundMesh::Cell first = {n[0] / 3, n[1] / 4, n[2] / 2};
  const BackgroundMesh part = whole.part(first, {n[0] - first[0], n[1] / 2, std::max<std::int64_t>(1, n[2] / 3)});
  std::int64_t last = -1;
  for (std::int64_t v = 0; v < part.n_vertices(); ++v) {
    BackgroundMesh::Cell cell = part.cell(v);
    for (int a = 0; a < 3; ++a) cell[a] += part.first_cell()[a];
    const std::int64_t there = whole.vertex_id(part.type(v), cell);
    ASSERT_EQ(part.position(v), whole.position(there));
    ASSERT_GT(there, last);
    last = there;
  }
  for (std::int64_t t = 0; t < part.n_tets(); t += 7) {
    Vec3 middle = Vec3::Zero();
    for (const std::int64_t v : part.tet(t)) middle += .25 * part.position(v);
    const std::int64_t near = part.tet_near(middle);
    if (near < 0) continue;  // a tet of an outermost cell may look out of it
    ASSERT_EQ(part.position(part.tet(near)[0]), whole.position(whole.tet(whole.tet_near(middle))[0]));
    ASSERT_TRUE(part.box().contains(middle));
  }
  // A part of a part is one of the whole.
  const BackgroundMesh deeper = part.part({1, 0, 0}, {1, 1, 1});
  EXPECT_EQ(deeper.first_cell()[0], first[0] + 1);
  EXPECT_THROW(part.part({0, 0, 0}, {n[0] + 1, 1, 1}), std::invalid_argument);
}

}  // namespace
}  // namespace umtet
