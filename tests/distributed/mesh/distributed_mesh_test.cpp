#include "distributed/mesh/distributed_mesh.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <optional>
#include <stdexcept>

#include "mesh/sizes/body_size.h"
#include "mesh/universal_mesh.h"
#include "tests/distributed/ranks.h"
#include "tests/support/domains.h"

namespace umtet {
namespace {

using testing::AnalyticDomain;
using testing::gathered;
using testing::rank;

using Bits = std::array<std::uint64_t, 3>;

Bits bits(const Vec3& x) {
  Bits b;
  std::memcpy(b.data(), x.data(), sizeof b);
  return b;
}

/// By ids of the background: what does not depend on how a mesh is numbered or divided.
struct WholeMesh {
  std::map<std::int64_t, std::array<std::int64_t, 4>> tets;
  std::map<std::int64_t, Bits> places;
  std::size_t n_psi_evaluations = 0;
};

FastParams without_repair() {
  FastParams params;
  params.repair.max_tries = 0;
  return params;
}

/// That of one process.
WholeMesh made_by_one(const BackgroundMesh& background, const AnalyticDomain& domain, const FastParams& params,
                      const std::vector<Vec3>& seeds = {}) {
  UmParams all{.fast = params};
  if (!seeds.empty()) all.submesh.search = SubmeshSearch::Crawl;
  const UmResult made = universal_mesh(background, domain, all, {}, seeds);
  EXPECT_EQ(made.status, UmStatus::Success) << made.evidence.what;
  WholeMesh mesh;
  mesh.n_psi_evaluations = made.n_psi_evaluations;
  const auto& id = made.submesh.background_vertex;
  for (std::size_t t = 0; t < made.submesh.mesh.C.size(); ++t) {
    const Tet& c = made.submesh.mesh.C[t];
    mesh.tets[made.submesh.background_tet[t]] = {id[c[0]], id[c[1]], id[c[2]], id[c[3]]};
  }
  for (std::size_t v = 0; v < id.size(); ++v) mesh.places[id[v]] = bits(made.final[v]);
  return mesh;
}

/// On rank 0. No tet is on two ranks, and all who have a vertex have it at one place and know the same owner.
WholeMesh gathered_mesh(const DistributedMesh& part) {
  struct OneTet {
    std::int64_t id;
    std::array<std::int64_t, 4> corners;
  };
  struct OneVertex {
    std::int64_t id;
    Bits place;
    std::int64_t owner;
  };
  std::vector<OneTet> tets;
  for (std::size_t t = 0; t < part.mesh.C.size(); ++t) {
    OneTet one{part.background_tet[t], {}};
    for (std::size_t k = 0; k < 4; ++k) one.corners[k] = part.background_vertex[part.mesh.C[t][k]];
    tets.push_back(one);
  }
  std::vector<OneVertex> vertices;
  for (std::size_t v = 0; v < part.mesh.V.size(); ++v)
    vertices.push_back({part.background_vertex[v], bits(part.mesh.V[v]), part.owner[v]});
  EXPECT_TRUE(std::is_sorted(part.background_tet.begin(), part.background_tet.end()));
  EXPECT_TRUE(std::is_sorted(part.background_vertex.begin(), part.background_vertex.end()));
  WholeMesh mesh;
  for (const OneTet& one : gathered(tets)) EXPECT_TRUE(mesh.tets.emplace(one.id, one.corners).second) << one.id;
  std::map<std::int64_t, std::int64_t> owners;
  for (const OneVertex& one : gathered(vertices)) {
    EXPECT_EQ(mesh.places.emplace(one.id, one.place).first->second, one.place) << one.id;
    EXPECT_EQ(owners.emplace(one.id, one.owner).first->second, one.owner) << one.id;
  }
  return mesh;
}

/// @return the part of this rank
DistributedMesh expect_same(const BackgroundMesh& background, const AnalyticDomain& domain,
                            const FastParams& params = {}, const std::vector<Vec3>& seeds = {}) {
  SCOPED_TRACE(domain.name);
  const DistributedMesh part = distributed_mesh(MPI_COMM_WORLD, background, domain, params, seeds);
  EXPECT_EQ(part.status, PartsStatus::Success) << to_string(part.status) << " " << part.n_places;
  const WholeMesh mesh = gathered_mesh(part);
  if (rank() != 0) return part;
  const WholeMesh one = made_by_one(background, domain, params, seeds);
  EXPECT_EQ(mesh.tets.size(), one.tets.size());
  EXPECT_TRUE(mesh.tets == one.tets);
  EXPECT_EQ(mesh.places.size(), one.places.size());
  std::size_t n_elsewhere = 0;
  for (const auto& [v, x] : mesh.places) n_elsewhere += !one.places.contains(v) || one.places.at(v) != x;
  EXPECT_EQ(n_elsewhere, 0U);
  EXPECT_GE(part.n_psi_evaluations, one.n_psi_evaluations);  // more than one rank looks at what is between them
  return part;
}

BackgroundMesh lattice_for(const AnalyticDomain& domain, double n_tets) {
  const Vec3 more = .1 * domain.box.sizes();
  const Box box(domain.box.min() - more, domain.box.max() + more);
  return {a15(), box, h_for_tets(domain, box, n_tets, ClassificationSource::Chosen)};
}

TEST(DistributedMesh, IsThatOfOneProcessToTheBit) {
  for (const AnalyticDomain& domain : {testing::sphere(), testing::ellipsoid(), testing::torus()})
    expect_same(lattice_for(domain, 60'000), domain);
}

TEST(DistributedMesh, IsThatOfOneProcessWithoutRepairToo) {
  for (const AnalyticDomain& domain : {testing::sphere(), testing::torus()})
    expect_same(lattice_for(domain, 60'000), domain, without_repair());
}

TEST(DistributedMesh, RepairsWhatOneProcessRepairs) {
  std::size_t n_flipped = 0;
  for (const AnalyticDomain& domain :
       {testing::equation_9(), testing::equation_13(3.2), testing::banchoff_chmutov_4()}) {
    for (const double n_tets : {12'000., 25'000., 50'000.}) {
      const BackgroundMesh background = lattice_for(domain, n_tets);
      expect_same(background, domain);
      if (rank() != 0) continue;
      const WholeMesh before = made_by_one(background, domain, without_repair());
      n_flipped += before.tets != made_by_one(background, domain, {}).tets;
    }
  }
  if (rank() == 0) {
    EXPECT_GE(n_flipped, 2U) << "there is little to repair";
  }
}

TEST(DistributedMesh, IsThatOfOneProcessWhereHBarelyShowsTheBody) {
  for (const double n_tets : {2'000., 6'000.}) {
    for (const AnalyticDomain& domain : {testing::torus(1, .3), testing::ellipsoid({1, .4, .2})})
      expect_same(lattice_for(domain, n_tets), domain);
  }
}

/// Two unit balls with a gap between them, at x = middle.
AnalyticDomain two_balls(double gap, double middle = 0) {
  const Vec3 c(1 + gap / 2, 0, 0), m(middle, 0, 0);
  AnalyticDomain domain = testing::sphere();
  domain.name = "two balls";
  domain.box = Box(Vec3(-2.6, -1.5, -1.5), Vec3(2.6, 1.5, 1.5));
  domain.psi = [c, m](const Vec3& x, Vec3* g, Mat3* H) {
    const Vec3 d = x - m - (x.x() > m.x() ? c : -c);
    if (g) *g = 2 * d;
    if (H) *H = 2 * Mat3::Identity();
    return d.squaredNorm() - 1;
  };
  return domain;
}

TEST(DistributedMesh, MendsABoundaryThatIsNoManifoldAsOneProcessDoes) {
  for (const double thickness : {.3, .5, .9, 1.1}) {
    const AnalyticDomain plate = testing::ellipsoid({1, .8, .5 * thickness * .1});
    const Vec3 more = Vec3::Constant(.3);
    const BackgroundMesh background(a15(), Box(plate.box.min() - more, plate.box.max() + more), .1);
    EXPECT_FALSE(expect_same(background, plate, without_repair()).manifold_flips.empty());
  }
}

TEST(DistributedMesh, FacesThatMeetStepBackAsInOneProcess) {
  for (const double gap : {.1, .25, .5, .75, 1., 1.25}) {
    const AnalyticDomain balls = two_balls(gap * .1);
    EXPECT_GT(expect_same({a15(), balls.box, .1}, balls, without_repair()).n_stepped_back, 10U);
  }
}

TEST(DistributedMesh, FacesOfTwoRanksThatMeetStepBack) {
  // Half of the curve ends at the beginning of block 8 along x: of two and of four ranks, others have each ball.
  const double h = .13;
  const BackgroundMesh background(a15(), Box(Vec3(-57 * h, -1.5, -1.5), Vec3(57 * h, 1.5, 1.5)), h);
  const double border = background.position(background.vertex_id(0, {31, 0, 0})).x();
  for (const double off : {-.01, 0., .01}) {
    for (const double gap : {.2, .3, .4}) {
      const AnalyticDomain balls = two_balls(gap * h, border + off * h);
      EXPECT_GT(expect_same(background, balls, without_repair()).n_stepped_back, 5U);
    }
  }
}

TEST(DistributedMesh, PiecesWithoutASeedAreLeftOut) {
  const AnalyticDomain balls = two_balls(.4);
  const BackgroundMesh background(a15(), balls.box, .1);
  const std::size_t n_both = expect_same(background, balls).n_chosen_tets;
  const std::size_t n = expect_same(background, balls, {}, {Vec3(-.2, 0, 0)}).n_chosen_tets;
  EXPECT_NEAR(static_cast<double>(n), .5 * static_cast<double>(n_both), .02 * static_cast<double>(n_both));
}

TEST(DistributedMesh, ACavityWithoutASeedIsFilled) {
  AnalyticDomain shell = testing::sphere();
  shell.name = "shell";
  shell.psi = [](const Vec3& x, Vec3* g, Mat3* H) {  // between radii .5 and 1
    const double r2 = x.squaredNorm();
    if (g) *g = (4 * r2 - 2.5) * x;
    if (H) *H = (4 * r2 - 2.5) * Mat3::Identity() + 8 * x * x.transpose();
    return (r2 - 1) * (r2 - .25);
  };
  const BackgroundMesh background(a15(), testing::cube_box(1.5), .12);
  const std::size_t n_with = expect_same(background, shell, {}, {Vec3(1, 0, 0), Vec3(.5, 0, 0)}).n_chosen_tets;
  EXPECT_GT(expect_same(background, shell, {}, {Vec3(1, 0, 0)}).n_chosen_tets, n_with + 1000);
}

TEST(DistributedMesh, AllThatOneProcessMendsIsMended) {
  const AnalyticDomain balls = two_balls(.2 * .1);
  const DistributedMesh made = expect_same({a15(), balls.box, .1}, balls);
  EXPECT_FALSE(made.manifold_flips.empty());
  EXPECT_GT(made.n_stepped_back, 0U);
}

TEST(DistributedMesh, IsThatOfOneProcessOnEveryTilingWithCosts) {
  const AnalyticDomain domain = testing::torus();
  const Vec3 more = Vec3::Constant(.2);
  for (const char* name : {"z", "slab", "cube"}) {
    SCOPED_TRACE(name);
    expect_same({tiling_named(name), Box(domain.box.min() - more, domain.box.max() + more), .06}, domain);
  }
}

TEST(DistributedMesh, ABodyInACornerOfTheLatticeMayLeaveRanksWithoutTets) {
  AnalyticDomain small = testing::sphere();
  small.box = Box(Vec3::Constant(-1.5), Vec3::Constant(12));
  expect_same({a15(), small.box, .4}, small);
}

TEST(DistributedMesh, ALatticeOfFewerBlocksThanRanksIsNoTrouble) {
  AnalyticDomain small = testing::sphere();
  small.box = testing::cube_box(1.5);
  expect_same({a15(), small.box, .5}, small);
}

TEST(DistributedMesh, ThreadsInsideRanksChangeNothing) {
  const AnalyticDomain domain = testing::torus();
  const BackgroundMesh background = lattice_for(domain, 40'000);
  std::optional<WholeMesh> first;
  for (const std::size_t n : {1, 2, 3}) {
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism, n);
    const WholeMesh mesh = gathered_mesh(distributed_mesh(MPI_COMM_WORLD, background, domain));
    if (!first) first = mesh;
    EXPECT_TRUE(mesh.tets == first->tets && mesh.places == first->places);
  }
}

TEST(DistributedMesh, AllRanksKnowWhyThereIsNone) {
  AnalyticDomain domain = testing::sphere();
  domain.box = testing::cube_box(.9);
  const DistributedMesh out = distributed_mesh(MPI_COMM_WORLD, {a15(), domain.box, .1}, domain);
  EXPECT_EQ(out.status, PartsStatus::DomainLeavesBackground);
  EXPECT_GT(out.n_places, 0U);
  domain.box = Box(Vec3::Constant(2), Vec3::Constant(3));
  EXPECT_EQ(distributed_mesh(MPI_COMM_WORLD, {a15(), domain.box, .1}, domain).status, PartsStatus::EmptyDomain);
  FastParams wrong;
  wrong.layers = 0;
  EXPECT_THROW(distributed_mesh(MPI_COMM_WORLD, {a15(), domain.box, .1}, domain, wrong), std::invalid_argument);
}

TEST(DistributedMesh, EveryRankHasItsShare) {
  const AnalyticDomain domain = testing::torus();
  const DistributedMesh part = distributed_mesh(MPI_COMM_WORLD, lattice_for(domain, 200'000), domain);
  const auto n = static_cast<double>(part.mesh.C.size());
  double all = 0;
  MPI_Allreduce(&n, &all, 1, MPI_DOUBLE, MPI_SUM, MPI_COMM_WORLD);
  EXPECT_LT(n, 1.5 * all / testing::n_ranks());
  EXPECT_EQ(part.traffic.bytes > 0, testing::n_ranks() > 1);
}

}  // namespace
}  // namespace umtet
