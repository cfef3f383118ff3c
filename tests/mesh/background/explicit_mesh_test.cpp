#include "mesh/background/explicit_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "mesh/background/a15_box.h"
#include "mesh/core/tet_quality.h"
#include "mesh/sizes/body_size.h"
#include "mesh/submesh/crawl.h"
#include "mesh/universal_mesh.h"
#include "tests/support/domains.h"

namespace umtet {
namespace {

/// A background mesh as its own list of tets, vertices without a tet left out, ids in the same order.
TetMesh listed(const BackgroundMesh& background) {
  TetMesh mesh;
  std::vector<int> number(background.n_vertices(), -1);
  for (std::int64_t v = 0; v < background.n_vertices(); ++v) {
    if (!background.has_tets(v)) continue;
    number[v] = static_cast<int>(mesh.V.size());
    mesh.V.push_back(background.position(v));
  }
  for (std::int64_t t = 0; t < background.n_tets(); ++t) {
    const auto tet = background.tet(t);
    mesh.C.push_back({number[tet[0]], number[tet[1]], number[tet[2]], number[tet[3]]});
  }
  return mesh;
}

TEST(ExplicitMesh, AsABackgroundIsTheLatticeItLists) {
  const auto domain = testing::torus();
  const BackgroundMesh lattice(a15(), domain.box, h_for_tets(domain, domain.box, 8000));
  const BackgroundMesh background(listed(lattice));
  EXPECT_FALSE(background.is_lattice());
  EXPECT_NEAR(background.h(), lattice.h(), .02 * lattice.h());  // edges at the background boundary have another mean
  const Submesh expected = find_submesh(lattice, domain);
  for (const Submesh& found :
       {find_submesh(background, domain), crawl(background, domain, domain.boundary_seeds).submesh}) {
    EXPECT_EQ(found.mesh.C, expected.mesh.C);
    EXPECT_EQ(found.mesh.V, expected.mesh.V);
    EXPECT_EQ(found.background_tet, expected.background_tet);
    EXPECT_EQ(found.positive_faces, expected.positive_faces);
  }
  std::size_t background_boundary = 0;
  for (std::int64_t t = 0; t < lattice.n_tets(); ++t) {
    for (int k = 0; k < 4; ++k) {
      ASSERT_EQ(background.neighbor(t, k), lattice.neighbor(t, k));
      background_boundary += lattice.neighbor(t, k) < 0;
    }
  }
  EXPECT_GT(background_boundary, 0u);
}

TEST(ExplicitMesh, IsMeshedInBothModes) {
  const auto domain = testing::torus();
  const BackgroundMesh background(listed(BackgroundMesh(z_phase(), domain.box, .12)));
  for (const UmMode mode : {UmMode::Paper, UmMode::Fast}) {
    for (const SubmeshSearch search : {SubmeshSearch::FullLoop, SubmeshSearch::Crawl}) {
      UmParams params;
      params.mode = mode;
      params.submesh.search = search;
      params.paper.relaxation_iterations = 5;
      const UmResult r = universal_mesh(background, domain, params, {}, domain.boundary_seeds);
      EXPECT_EQ(r.status, UmStatus::Success) << r.evidence.what;
      EXPECT_GT(r.conditioning_angle_max_deg, 70);
      EXPECT_LT(r.conditioning_angle_max_deg, 77.08);  // Z's greatest
    }
  }
}

TEST(ExplicitMesh, RefusesWhatIsNoMesh) {
  const std::vector<Vec3> V = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}, {1, 1, 2}};
  EXPECT_NO_THROW(ExplicitMesh({V, {{0, 1, 2, 3}, {1, 2, 3, 4}}}));
  for (const std::vector<Tet>& C : std::vector<std::vector<Tet>>{{},
                                                                 {{0, 1, 2, 6}},
                                                                 {{0, 2, 1, 3}},                // inverted
                                                                 {{0, 1, 2, 2}},                // flat
                                                                 {{1, 2, 3, 4}, {1, 2, 3, 5}},  // on one side
                                                                 {{0, 1, 2, 3}, {1, 2, 3, 4}, {1, 2, 3, 5}}}) {
    EXPECT_THROW(ExplicitMesh({V, C}), std::invalid_argument) << C.size();
  }
}

TEST(A15Box, HasFlatWallsAndNoObtuseAngle) {
  const Box box(Vec3(-1, .3, 2), Vec3(1.3, 1, 2.9));
  const double h = .12;
  const TetMesh mesh = a15_box(box, h);
  double volume = 0, q_min = 1, greatest = 0;
  std::size_t right = 0;
  for (const Tet& t : mesh.C) {
    const auto &a = mesh.V[t[0]], &b = mesh.V[t[1]], &c = mesh.V[t[2]], &d = mesh.V[t[3]];
    volume += volume6(a, b, c, d) / 6;
    q_min = std::min(q_min, mean_ratio(a, b, c, d));
    const double most = dihedral_range(a, b, c, d).max_deg;
    greatest = std::max(greatest, most);
    if (most < 90 - 1e-9) continue;
    ++right;
    double to_wall = h;  // a quarter of a cell is .43 h
    for (const Vec3& x : {a, b, c, d}) {
      to_wall = std::min({to_wall, (x - box.min()).minCoeff(), (box.max() - x).minCoeff()});
    }
    EXPECT_EQ(to_wall, 0);
  }
  EXPECT_GT(right, 0u);
  EXPECT_NEAR(volume / box.volume(), 1, 1e-12);
  EXPECT_LT(greatest, 90 + 1e-9);
  EXPECT_GT(q_min, .6);
  const ExplicitMesh stored(mesh);
  for (std::size_t v = 0; v < mesh.V.size(); ++v) {
    const double to_wall = std::min((mesh.V[v] - box.min()).minCoeff(), (box.max() - mesh.V[v]).minCoeff());
    EXPECT_EQ(stored.on_boundary(static_cast<int>(v)), to_wall == 0);
  }
  const TetMesh cell = a15_box(Box(Vec3::Zero(), Vec3::Ones()), a15().mean_edge);
  EXPECT_EQ(cell.V.size(), 33u);
  EXPECT_EQ(cell.C.size(), 64u);
  EXPECT_THROW(a15_box(box, 0), std::invalid_argument);
  EXPECT_THROW(a15_box(Box(), .1), std::invalid_argument);
  EXPECT_THROW(a15_box(box, 1e-5), std::invalid_argument);
}

}  // namespace
}  // namespace umtet
