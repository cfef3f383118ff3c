#include "distributed/second_order/part_second_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "mesh/universal_mesh.h"
#include "tests/distributed/ranks.h"
#include "tests/support/domains.h"

namespace umtet {
namespace {

using Edge = std::array<std::int64_t, 2>;

/// The mesh of one process, on all ranks.
struct Whole {
  UmResult made;
  SecondOrder second;
  SecondOrderCertificate certificate;
  std::map<Edge, Vec3> mid_side;  ///< by ids of the background

  Whole(const BackgroundMesh& background, const testing::AnalyticDomain& domain, const SecondOrderParams& params)
      : made(universal_mesh(background, domain)),
        second(quadratic_tets({made.final, made.submesh.mesh.C}, made.submesh.positive_faces, domain, background.h(),
                              params)) {
    SecondOrderInput input;
    input.mesh = &second.mesh;
    input.h = background.h();
    input.psi = domain;
    certificate = certify_second_order(input);
    for (const QuadraticTet& tet : second.mesh.C) {
      for (int k = 0; k < 6; ++k) {
        const std::int64_t a = made.submesh.background_vertex[tet[kMidSideEdge[k][0]]];
        const std::int64_t b = made.submesh.background_vertex[tet[kMidSideEdge[k][1]]];
        mid_side[{std::min(a, b), std::max(a, b)}] = second.mesh.V[tet[4 + k]];
      }
    }
  }
};

std::size_t sum(std::size_t n) {
  std::uint64_t all = n;
  MPI_Allreduce(MPI_IN_PLACE, &all, 1, MPI_UINT64_T, MPI_SUM, MPI_COMM_WORLD);
  return all;
}

/// A plate of one edge, whose rim asks for curves that tets can hardly follow.
const testing::AnalyticDomain kPlate = testing::ellipsoid({1, 1, .1});

class CurvedPartsOfPlate : public ::testing::TestWithParam<double> {};

TEST_P(CurvedPartsOfPlate, AreThoseOfOneProcess) {
  testing::AnalyticDomain domain = kPlate;
  domain.box = Box(Vec3(-1.3, -1.3, -.4), Vec3(1.3, 1.3, .4));
  SecondOrderParams params;
  params.least = GetParam();
  const BackgroundMesh background(a15(), domain.box, .1);
  const Whole whole(background, domain, params);
  const DistributedMesh mesh = distributed_mesh(MPI_COMM_WORLD, background, domain);
  const VertexOwners owners(MPI_COMM_WORLD, mesh);
  const PartEdges edges(MPI_COMM_WORLD, mesh, owners);
  const CurvedParts curved = curved_parts(MPI_COMM_WORLD, mesh, edges, domain, background.h(), params);

  EXPECT_GT(whole.second.n_slid + whole.second.n_relaxed, 100u);  // there is something to relax
  EXPECT_EQ(params.least > .2, !whole.second.off_surface.empty());
  EXPECT_EQ(curved.n_slid, whole.second.n_slid);
  EXPECT_EQ(curved.n_relaxed, whole.second.n_relaxed);
  EXPECT_EQ(curved.n_off_surface, whole.second.off_surface.size());
  EXPECT_EQ(curved.n_unprojected, whole.second.n_unprojected);
  for (std::size_t e = 0; e < edges.ends().size(); ++e) {
    const auto& [a, b] = edges.ends()[e];
    const Edge ids = {mesh.background_vertex[a], mesh.background_vertex[b]};
    ASSERT_EQ(curved.mesh.V[mesh.mesh.V.size() + e], whole.mid_side.at(ids));
  }
  // Numbers are places in the sorted list of all edges.
  EXPECT_EQ(edges.n_all(), static_cast<std::int64_t>(whole.mid_side.size()));
  for (std::size_t k = 0; k < edges.owned().size(); ++k) {
    const auto at = whole.mid_side.find(edges.owned()[k]);
    ASSERT_NE(at, whole.mid_side.end());
    if (k % 50 != 0) continue;
    ASSERT_EQ(edges.global()[k], std::distance(whole.mid_side.begin(), at));
  }
  EXPECT_EQ(sum(edges.owned().size()), whole.mid_side.size());

  const SecondOrderCertificate c =
      certify_curved_parts(MPI_COMM_WORLD, mesh, owners, edges, curved, domain, background.h(), 0);
  EXPECT_EQ(c.n_nodes, whole.certificate.n_nodes);
  EXPECT_EQ(c.n_boundary_mid_sides, whole.certificate.n_boundary_mid_sides);
  EXPECT_EQ(c.n_torn_edges, 0u);
  EXPECT_EQ(c.n_nonpositive_jacobians, whole.certificate.n_nonpositive_jacobians);
  EXPECT_EQ(c.volume, whole.certificate.volume);
  EXPECT_EQ(c.min_scaled_jacobian_lower, whole.certificate.min_scaled_jacobian_lower);
  EXPECT_EQ(c.min_scaled_jacobian_upper, whole.certificate.min_scaled_jacobian_upper);
  EXPECT_EQ(c.n_mid_sides_off_surface, whole.certificate.n_mid_sides_off_surface);
  EXPECT_EQ(c.max_mid_side_distance_over_h, whole.certificate.max_mid_side_distance_over_h);
  EXPECT_EQ(c.max_face_distance_over_h, whole.certificate.max_face_distance_over_h);
  EXPECT_EQ(c.rms_face_distance_over_h, whole.certificate.rms_face_distance_over_h);
}

// The second one puts mid-sides back to their chords.
INSTANTIATE_TEST_SUITE_P(Least, CurvedPartsOfPlate, ::testing::Values(.02, .25));

TEST(CurvedPartsTest, TornEdgesAreFound) {
  const testing::AnalyticDomain domain = testing::sphere();
  const BackgroundMesh background(a15(), testing::cube_box(1.4), .2);
  const DistributedMesh mesh = distributed_mesh(MPI_COMM_WORLD, background, domain);
  const VertexOwners owners(MPI_COMM_WORLD, mesh);
  const PartEdges edges(MPI_COMM_WORLD, mesh, owners);
  CurvedParts curved = curved_parts(MPI_COMM_WORLD, mesh, edges, domain, background.h());
  // Rank 0 has all its mid-sides elsewhere: those that others have, too, are torn.
  std::vector<int> n_users(edges.owned().size(), 0);
  std::vector<char> of_first(edges.owned().size(), 0);
  edges.exchange().ask([&](std::size_t) { return static_cast<char>(testing::rank() == 0); },
                       [&](std::size_t k, char is_first) { ++n_users[k], of_first[k] |= is_first; });
  std::size_t n_torn = 0;
  for (std::size_t k = 0; k < n_users.size(); ++k) n_torn += of_first[k] && n_users[k] > 1;
  for (std::size_t e = 0; testing::rank() == 0 && e < edges.ends().size(); ++e)
    curved.mesh.V[mesh.mesh.V.size() + e].x() += 1e-9;
  const auto c = certify_curved_parts(MPI_COMM_WORLD, mesh, owners, edges, curved, domain, background.h(), 0);
  EXPECT_EQ(sum(n_torn) > 0, testing::n_ranks() > 1);
  EXPECT_EQ(c.n_torn_edges, sum(n_torn));
}

}  // namespace
}  // namespace umtet
