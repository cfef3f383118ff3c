#include "mesh/moving_mesh.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <algorithm>
#include <array>
#include <functional>
#include <set>
#include <stdexcept>
#include <utility>

#include "mesh/certify/certificate.h"
#include "mesh/certify/certificate_memory.h"
#include "mesh/core/tet_quality.h"
#include "mesh/octree/graded_mesh.h"
#include "mesh/submesh/inside_walk.h"
#include "tests/support/certified.h"
#include "tests/support/domains.h"

namespace umtet {
namespace {

namespace domains = umtet::testing;

/// |x - c|^2 - r^2.
struct Ball {
  Vec3 c = Vec3::Zero();
  double r = 1;
  double value(const Vec3& x) const { return (x - c).squaredNorm() - r * r; }
  Vec3 gradient(const Vec3& x) const { return 2 * (x - c); }
  Mat3 hessian(const Vec3&) const { return 2 * Mat3::Identity(); }
};

double least_quality(const UmResult& r) {
  double least = 1;
  for (const Tet& t : r.submesh.mesh.C) {
    least = std::min(least, mean_ratio(r.final[t[0]], r.final[t[1]], r.final[t[2]], r.final[t[3]]));
  }
  return least;
}

void expect_certified(const UmResult& r, ImplicitFunctionRef psi, double h, int components) {
  ASSERT_EQ(r.status, UmStatus::Success) << r.evidence.what;
  const TetMesh mesh{r.final, r.submesh.mesh.C};
  CertificateInput input;
  input.mesh = &mesh;
  input.h = h;
  input.positive_faces = &r.submesh.positive_faces;
  input.psi = psi;
  const MeshCertificate c = certify(input);
  for (const std::string& reason : failures(c)) ADD_FAILURE() << reason;
  EXPECT_EQ(c.boundary.components, components);
}

std::vector<std::int64_t> changed_by(const std::vector<std::int64_t>& last, const std::vector<std::int64_t>& entered,
                                     const std::vector<std::int64_t>& left) {
  std::set<std::int64_t> ids(last.begin(), last.end());
  for (const std::int64_t id : left) EXPECT_EQ(ids.erase(id), 1u);
  for (const std::int64_t id : entered) EXPECT_TRUE(ids.insert(id).second);
  return {ids.begin(), ids.end()};
}

/// psi has no zero in a ball of radius |psi| / L around a point.
std::function<bool(const Box&)> lipschitz(ImplicitFunctionRef psi, double L) {
  return [psi, L](const Box& box) { return std::abs(psi.value(box.center())) > .5 * L * box.diagonal().norm(); };
}

TEST(UniversalMesh, ADriftingBallIsMeshedAsWellAsAnew) {
  const double h = .15;
  const BackgroundMesh background(a15(), Box(Vec3(-1.5, -1.5, -1.5), Vec3(2, 1.5, 1.5)), h);
  UniversalMesh moving(background);
  Submesh last;
  std::vector<Vec3> last_V;
  for (int k = 0; k < 8; ++k) {
    SCOPED_TRACE(k);
    const Ball psi{Vec3(.065, .01, .02) * k};
    const UmUpdate& update = moving.update(psi);
    expect_certified(update.mesh, psi, h, 1);
    const Submesh& now = update.mesh.submesh;
    // What is above the target by more than that is luck: on balls as small as this, .83 to .86 with or without it.
    EXPECT_GT(least_quality(update.mesh), std::min(.83, least_quality(universal_mesh(background, psi))) - .01);
    EXPECT_EQ(changed_by(last.background_vertex, update.vertices_entered, update.vertices_left), now.background_vertex);
    EXPECT_EQ(changed_by(last.background_tet, update.tets_entered, update.tets_left), now.background_tet);
    for (std::size_t i = 0; i < last_V.size(); ++i) {
      const auto at =
          std::lower_bound(now.background_vertex.begin(), now.background_vertex.end(), last.background_vertex[i]);
      if (at == now.background_vertex.end() || *at != last.background_vertex[i]) continue;
      EXPECT_EQ(update.mesh.final[at - now.background_vertex.begin()] != last_V[i],
                std::binary_search(update.vertices_moved.begin(), update.vertices_moved.end(), *at));
    }
    EXPECT_EQ(update.n_recalled > 0, k > 0);
    last = now;
    last_V = update.mesh.final;
  }
}

void expect_equal(const MeshCertificate& a, const MeshCertificate& b) {
  const auto counts = [](const MeshCertificate& c) {
    const MeshCertificate::Boundary& s = c.boundary;
    return std::array<long, 15>{static_cast<long>(c.n_tets),
                                static_cast<long>(c.n_vertices),
                                static_cast<long>(c.n_positive_faces),
                                static_cast<long>(c.quality.n_inverted),
                                static_cast<long>(s.n_faces),
                                static_cast<long>(s.n_overused_faces),
                                static_cast<long>(s.n_same_side_faces),
                                static_cast<long>(s.n_nonmanifold_edges),
                                static_cast<long>(s.n_nonmanifold_vertices),
                                s.closed_manifold,
                                s.equals_positive_faces.value(),
                                s.components,
                                s.euler_characteristic,
                                static_cast<long>(s.n_cos_below_half),
                                static_cast<long>(s.n_unprojected_faces)};
  };
  const auto measures = [](const MeshCertificate& c) {
    return std::array<double, 13>{c.volume,
                                  c.h,
                                  c.quality.min,
                                  c.quality.p001,
                                  c.quality.p01,
                                  c.quality.mean,
                                  c.quality.dihedral_min_deg,
                                  c.quality.dihedral_max_deg,
                                  c.boundary.area,
                                  c.boundary.max_vertex_distance_over_h.value(),
                                  c.boundary.max_centroid_distance_over_h.value(),
                                  c.boundary.min_cos_normal.value(),
                                  static_cast<double>(c.boundary.genus)};
  };
  EXPECT_EQ(counts(a), counts(b));
  EXPECT_EQ(measures(a), measures(b));
}

TEST(UniversalMesh, AHundredStepsOfAQuarterCellAreCertifiedAndAsGoodAsAnew) {
  const double h = a15().mean_edge / a15().period[0];  // cells of edge 1
  const BackgroundMesh background(a15(), Box(Vec3(-8, -4, -4), Vec3(8, 4, 4)), h);
  UniversalMesh moving(background);
  for (int k = 0; k <= 100; ++k) {
    SCOPED_TRACE(k);
    const int step = k <= 40 ? k : k <= 80 ? 80 - k : k - 80;  // to and fro
    const Ball psi{Vec3(-4.8 + .25 * step, .01 * k, 0), 2.9};
    const UmUpdate update = moving.update(psi);
    ASSERT_EQ(update.mesh.status, UmStatus::Success) << update.mesh.evidence.what;
    const MeshCertificate c = moving.certify(update.mesh, psi);
    EXPECT_TRUE(failures(c).empty()) << failures(c).front();
    const UmResult anew = universal_mesh(background, psi);
    const MeshCertificate fresh = testing::certificate_of(anew, psi, h);
    EXPECT_GT(c.quality.min, std::min(.83, fresh.quality.min) - .01);  // .83: see above
    EXPECT_GT(c.quality.p01, fresh.quality.p01 - .01);
    EXPECT_GT(c.quality.mean, fresh.quality.mean - .01);
    if (k % 20 == 0) expect_equal(c, testing::certificate_of(update.mesh, psi, h));
  }
}

TEST(UniversalMesh, ItsCertificateOverlooksNothingThatHasChanged) {
  const BackgroundMesh background(a15(), domains::cube_box(1.5), .15);
  const Ball psi;
  UniversalMesh moving(background);
  const UmResult mesh = moving.update(psi).mesh;
  const auto expect_seen = [&](const UmResult& spoiled) {
    expect_equal(moving.certify(mesh, psi), testing::certificate_of(mesh, psi, .15));
    expect_equal(moving.certify(spoiled, psi), testing::certificate_of(spoiled, psi, .15));
    expect_equal(moving.certify(mesh, psi), testing::certificate_of(mesh, psi, .15));
  };
  expect_seen(mesh);
  const Ball other{Vec3(0, 0, .1), 1.01};  // of which it is no mesh
  expect_equal(moving.certify(mesh, other), testing::certificate_of(mesh, other, .15));
  EXPECT_FALSE(failures(moving.certify(mesh, other)).empty());
  UmResult uncovered = mesh;
  uncovered.submesh.positive_faces.pop_back();
  expect_seen(uncovered);
  const std::size_t middle = mesh.submesh.mesh.C.size() / 2;
  UmResult inverted = mesh;
  inverted.final[mesh.submesh.mesh.C[middle][0]] += Vec3(.2, 0, 0);
  expect_seen(inverted);
  EXPECT_GT(moving.certify(inverted, psi).quality.n_inverted, 0u);
  UmResult hole = mesh;
  hole.submesh.mesh.C.erase(hole.submesh.mesh.C.begin() + static_cast<std::ptrdiff_t>(middle));
  hole.submesh.background_tet.erase(hole.submesh.background_tet.begin() + static_cast<std::ptrdiff_t>(middle));
  expect_seen(hole);
  UmResult swapped = mesh;  // under the same id
  std::swap(swapped.submesh.mesh.C[middle][0], swapped.submesh.mesh.C[middle][1]);
  expect_seen(swapped);
  UmResult doubled = mesh;  // one tet under the id of another
  doubled.submesh.mesh.C[middle] = doubled.submesh.mesh.C[middle + 1];
  expect_seen(doubled);
}

TEST(CertificateMemory, KnowsTheTetsThatStay) {
  const BackgroundMesh background(a15(), domains::cube_box(1.5), .15);
  const auto one = universal_mesh(background, Ball{});
  const TetMesh mesh{one.final, one.submesh.mesh.C};
  CertificateMemory memory;
  memory.match(mesh, one.submesh.background_vertex, one.submesh.background_tet);
  EXPECT_EQ(memory.n_known(), 0u);
  CertificateInput input;
  input.mesh = &mesh;
  for (int k = 0; k < 2; ++k) certify(input, one.submesh.background_vertex, one.submesh.background_tet, memory);
  EXPECT_EQ(memory.n_known(), mesh.C.size());
}

TEST(UniversalMesh, ADomainThatStaysKeepsItsMesh) {
  const BackgroundMesh background(a15(), domains::torus().box, .1);
  UniversalMesh moving(background);
  const auto psi = domains::torus();
  const UmUpdate first = moving.update(psi), second = moving.update(psi);
  EXPECT_EQ(second.mesh.submesh.background_tet, first.mesh.submesh.background_tet);
  EXPECT_EQ(second.mesh.final, first.mesh.final);
  EXPECT_TRUE(second.tets_entered.empty() && second.tets_left.empty() && second.vertices_moved.empty());
  // psi is asked at vertices with a neighbour on the other side and at those of the boundary, once.
  EXPECT_EQ(second.mesh.n_psi_evaluations, second.n_searched + first.mesh.submesh.positive_vertices.size());
  expect_equal(moving.certify(second.mesh, psi), testing::certificate_of(first.mesh, psi, .1));
}

TEST(UniversalMesh, ADomainThatMovesByAHairDoesNotStay) {
  const BackgroundMesh background(a15(), domains::cube_box(1.5), .15);
  UniversalMesh moving(background);
  const UmUpdate first = moving.update(Ball{});
  const Ball moved{Vec3(1e-6, 0, 0)};  // and no vertex changes sides
  const UmUpdate& second = moving.update(moved);
  EXPECT_EQ(second.mesh.submesh.background_tet, first.mesh.submesh.background_tet);
  EXPECT_GT(second.vertices_moved.size(), .9 * static_cast<double>(first.mesh.submesh.positive_vertices.size()));
  expect_certified(second.mesh, moved, .15, 1);
  EXPECT_GE(least_quality(second.mesh), least_quality(first.mesh) - 1e-3);
  // All but what repair has moved by itself, and flat tets, begin where they were.
  EXPECT_GT(second.n_recalled, .95 * static_cast<double>(first.mesh.submesh.positive_vertices.size()));
}

TEST(UniversalMesh, ItsResultIsOverwrittenByTheNextAndTheOneBeforeIsNotLost) {
  const BackgroundMesh background(a15(), domains::cube_box(1.4), .15);
  UniversalMesh moving(background);
  const UmUpdate& at = moving.update(Ball{});
  const Submesh first = at.mesh.submesh;
  EXPECT_EQ(&moving.update(Ball{Vec3(.6, 0, 0)}), &at);
  EXPECT_NE(at.mesh.status, UmStatus::Success);
  moving.update(Ball{Vec3(.05, 0, 0)});
  EXPECT_EQ(changed_by(first.background_vertex, at.vertices_entered, at.vertices_left),
            at.mesh.submesh.background_vertex);
}

TEST(InsideWalk, FindsWhatTheFullLoopFindsAndAsksNearTheSurfaceOnly) {
  std::size_t n_near = 0;
  for (const double half : {1.6, 3.}) {
    const BackgroundMesh background(a15(), domains::cube_box(half), .15);
    InsideWalk walk(background);
    EXPECT_GT(walk.restart(Ball{}), .7 * static_cast<double>(background.n_vertices()));  // those with tets
    std::size_t n = 0;
    for (int k = 1; k < 6; ++k) {
      const Ball psi{Vec3(.07, 0, -.03) * k, 1 + .05 * k};
      n += walk.update(psi, {});
      for (std::int64_t v = 0; v < background.n_vertices(); ++v) {
        ASSERT_EQ(walk.inside().test(v), background.has_tets(v) && psi.value(background.position(v)) < 0) << k;
      }
    }
    // The lattices differ by a shift: the numbers by little, where the backgrounds differ by a factor of six.
    if (n_near > 0) {
      EXPECT_NEAR(static_cast<double>(n) / static_cast<double>(n_near), 1, .1);
    }
    n_near = n;
  }
}

TEST(UniversalMesh, NewComponentsAreFoundBySignBoundsOrSeeds) {
  const BackgroundMesh background(a15(), domains::cube_box(2.1), .12);
  const auto before = domains::equation_13(3.0), after = domains::equation_13(3.2);
  const double L = 16;  // |2 x + t cos(t x)| <= 4.2 + 3.2 + rounding of the box, on three axes
  for (const bool by_bounds : {true, false}) {
    UniversalMesh moving(background);
    expect_certified(moving.update(before).mesh, before, .12, 1);
    expect_certified(moving.update(after).mesh, after, .12, 1);  // the walk does not meet them
    UpdateHints hints;
    if (by_bounds) {
      hints.no_zero_in = lipschitz(after, L);
    } else {
      hints.seeds = after.boundary_seeds;
    }
    const UmUpdate found = moving.update(after, hints);
    expect_certified(found.mesh, after, .12, 4);
    EXPECT_LT(found.n_searched, .5 * static_cast<double>(background.n_vertices()));
  }
}

TEST(UniversalMesh, AFailureLeavesTheNextUpdateWhereItWas) {
  const BackgroundMesh background(a15(), domains::cube_box(1.4), .15);
  UniversalMesh moving(background);
  const Ball ball;
  const UmUpdate first = moving.update(ball);
  EXPECT_EQ(moving.update(Ball{Vec3(.6, 0, 0)}).mesh.status, UmStatus::DomainLeavesBackground);
  EXPECT_THROW(moving.update(ball, {}, {.cancelled = [] { return true; }}), Cancelled);
  const UmUpdate again = moving.update(ball);
  expect_certified(again.mesh, ball, .15, 1);
  EXPECT_EQ(again.mesh.submesh.background_tet, first.mesh.submesh.background_tet);
  EXPECT_TRUE(again.tets_entered.empty() && again.tets_left.empty());
  EXPECT_EQ(moving.update(Ball{Vec3::Zero(), 0}).mesh.status, UmStatus::EmptyDomain);
  expect_certified(moving.update(ball).mesh, ball, .15, 1);
  UmParams paper;
  paper.mode = UmMode::Paper;
  EXPECT_THROW(UniversalMesh(background, paper), std::invalid_argument);
}

TEST(UniversalMesh, APsiThatThrowsLeavesTheNextUpdateWhereItWas) {
  struct Throwing {
    double value(const Vec3&) const { throw std::domain_error("no value"); }
    Vec3 gradient(const Vec3&) const { return Vec3::UnitX(); }
  };
  UniversalMesh moving(BackgroundMesh(a15(), domains::cube_box(1.4), .15));
  const Ball ball, less{Vec3::Zero(), .6};
  moving.update(ball);
  EXPECT_THROW(moving.update(Throwing{}), std::domain_error);
  expect_certified(moving.update(less).mesh, less, .15, 1);
}

TEST(UniversalMesh, EveryBackgroundWillDo) {
  const Box box = domains::cube_box(1.3);
  const BackgroundMesh slab(tiling_named("slab"), box, .2), a(a15(), box, .2);
  TetMesh stored;
  for (std::int64_t v = 0; v < a.n_vertices(); ++v) stored.V.push_back(a.position(v));
  for (std::int64_t t = 0; t < a.n_tets(); ++t) {
    const auto tet = a.tet(t);
    stored.C.push_back(
        {static_cast<int>(tet[0]), static_cast<int>(tet[1]), static_cast<int>(tet[2]), static_cast<int>(tet[3])});
  }
  for (const BackgroundMesh& background : {slab, BackgroundMesh(stored)}) {
    UniversalMesh moving(background);
    for (int k = 0; k < 3; ++k) {
      const Ball psi{Vec3(.04, 0, 0) * k};
      expect_certified(moving.update(psi).mesh, psi, background.h(), 1);
    }
  }
}

TEST(UniversalMesh, AGradedBackgroundWillDo) {
  // Fine where the top of the ball comes by.
  const Grading grading{.box = domains::cube_box(1.5), .finest = .05, .size = [](const Vec3& x, double half) {
                          return .05 + .1 * std::max(0., (x - Vec3(0, 0, 1)).norm() - 2 * half - .3);
                        }};
  const BackgroundMesh background{GradedMesh(grading)};
  UniversalMesh moving(background);
  Submesh last;
  for (int k = 0; k < 5; ++k) {
    SCOPED_TRACE(k);
    const Ball psi{Vec3(.03, .01, .02) * k};
    const UmUpdate& update = moving.update(psi);
    expect_certified(update.mesh, psi, background.h(), 1);
    EXPECT_GT(least_quality(update.mesh), .68);
    const Submesh& now = update.mesh.submesh;
    EXPECT_EQ(changed_by(last.background_vertex, update.vertices_entered, update.vertices_left), now.background_vertex);
    EXPECT_EQ(update.n_recalled > 0, k > 0);
    last = now;
  }
}

TEST(UniversalMesh, ThreadsDoNotChangeTheMesh) {
  const BackgroundMesh background(a15(), domains::cube_box(1.5), .15);
  std::vector<Vec3> V[2];
  for (int n = 1; n <= 2; ++n) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(n));
    UniversalMesh moving(background);
    for (int k = 0; k < 3; ++k) V[n - 1] = moving.update(Ball{Vec3(.06, 0, 0) * k}).mesh.final;
  }
  EXPECT_EQ(V[0], V[1]);
}

TEST(SparsityPattern, HoldsEveryEdgeOfTheBackgroundTwice) {
  const BackgroundMesh background(a15(), domains::cube_box(.3), .15);
  const SparsityPattern p = sparsity_pattern(background);
  std::set<std::pair<std::int64_t, std::int64_t>> edges, rows;
  for (std::int64_t t = 0; t < background.n_tets(); ++t) {
    for (const std::int64_t a : background.tet(t)) {
      for (const std::int64_t b : background.tet(t)) {
        if (a != b) edges.emplace(a, b);
      }
    }
  }
  ASSERT_EQ(p.row_begin.size(), static_cast<std::size_t>(background.n_vertices()) + 1);
  for (std::int64_t v = 0; v < background.n_vertices(); ++v) {
    for (std::int64_t k = p.row_begin[v]; k < p.row_begin[v + 1]; ++k) {
      rows.emplace(v, p.column[k]);
      EXPECT_TRUE(k == p.row_begin[v] || p.column[k - 1] < p.column[k]);
    }
  }
  EXPECT_EQ(rows, edges);
}

}  // namespace
}  // namespace umtet
