#include "body/pieces/zero_set_choice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>

#include "body/fidelity/measure.h"
#include "body/fidelity/verdict.h"
#include "body/pieces/component_proof.h"
#include "body/pieces/zero_free_blocks.h"
#include "mesh/expression/expression.h"
#include "mesh/universal_mesh.h"

namespace umtet {
namespace {

/// The function on a lattice of spacing .1 over [-2, 2]^3: coefficients that are its values move the surface by a
/// fraction of the spacing, and pieces stay pieces.
LevelSet level_set(const std::function<double(const Vec3&)>& f) {
  Lattice lattice;
  lattice.origin = Vec3::Constant(-2);
  lattice.h = .1;
  lattice.n = Eigen::Vector3i::Constant(41);
  std::vector<double> values;
  for (int k = 0; k < 41; ++k)
    for (int j = 0; j < 41; ++j)
      for (int i = 0; i < 41; ++i) values.push_back(f(lattice.origin + .1 * Vec3(i, j, k)));
  return LevelSet(LmePrior{}, {lattice, values});
}

void add_ball_samples(std::vector<Vec3>& points, const Vec3& centre, double radius, int n) {
  for (int i = 0; i < n; ++i) {
    const double z = 1 - (2 * i + 1.) / n, r = std::sqrt(1 - z * z), a = 2.399963229728653 * i;
    points.push_back(centre + radius * Vec3(r * std::cos(a), r * std::sin(a), z));
  }
}

double ball(const Vec3& x, const Vec3& centre, double radius) { return (x - centre).norm() - radius; }

/// A body with 2000 samples on the unit sphere, whose spacing is about .07.
Domain domain(const std::function<double(const Vec3&)>& psi) {
  Domain d;
  d.level_set.emplace(level_set(psi));
  d.box = Box(Vec3::Constant(-1.9), Vec3::Constant(1.9));
  d.cloud_spacing = .07;
  add_ball_samples(d.cloud.points, Vec3::Zero(), 1, 2000);
  d.cloud.normals = d.cloud.points;  // of a unit sphere; those of other samples are not used here
  return d;
}

const Vec3 kCorner(1.4, 1.4, 1.4);

TEST(ChooseComponents, SignCellsSpareValuesAndChangeNothing) {
  const Domain d = domain([](const Vec3& x) { return std::min(ball(x, {0, 0, 0}, 1), ball(x, kCorner, .25)); });
  const ZeroSetChoice c = choose_components(d, .1);
  const ZeroSetTopology all = zero_set_topology(d.psi(), d.box, counting_spacing(d, .1));
  EXPECT_EQ(c.topology.cut_points, all.cut_points);
  EXPECT_EQ(c.topology.euler_characteristic, all.euler_characteristic);
  const ZeroFreeMap far(*c.cells, d.box, .1);
  int n_far = 0;
  for (int i = 0; i < 4096; ++i) {
    const Vec3 x = -Vec3::Constant(1.75) + 3.5 / 15 * Vec3(i % 16, i / 16 % 16, i / 256);
    n_far += far(x);
    for (int q = 0; q < 27 && far(x); ++q) {
      const Vec3 y = x + .1 * Vec3(q % 3 - 1, q / 3 % 3 - 1, q / 9 - 1);
      EXPECT_EQ(d.level_set->value(y) < 0, d.level_set->value(x) < 0);
    }
  }
  EXPECT_GT(n_far, 2000);
  EXPECT_FALSE(far(d.box.min())) << "psi is not known outside";
}

TEST(ChooseComponents, ABubbleAroundOutliersIsDropped) {
  Domain d = domain([](const Vec3& x) { return std::min(ball(x, {0, 0, 0}, 1), ball(x, kCorner, .25)); });
  add_ball_samples(d.cloud.points, kCorner, .25, 6);
  const ZeroSetChoice c = choose_components(d, .15);
  ASSERT_EQ(c.topology.components.size(), 2u);
  ASSERT_EQ(c.seeds.size(), 1u);
  EXPECT_NEAR(c.seeds[0].norm(), 1, .05);
  EXPECT_EQ(c.euler_characteristic, 2);
  EXPECT_EQ(c.topology.euler_characteristic, 4);
  ASSERT_EQ(c.dropped.size(), 1u);
  EXPECT_NE(c.dropped[0].find(": 6 of at least 10 samples"), std::string::npos) << c.dropped[0];
}

TEST(ChooseComponents, AFinerCountNeedsNoSearchOfItsOwn) {
  const Domain d = domain([](const Vec3& x) { return std::min(ball(x, {0, 0, 0}, 1), ball(x, kCorner, .25)); });
  const ZeroSetChoice coarse = choose_components(d, .3);
  const ZeroSetChoice own = choose_components(d, .1), lent = choose_components(d, .1, {}, &*coarse.cells);
  EXPECT_EQ(own.topology.components.size(), 2u);
  EXPECT_EQ(lent.topology.cut_points, own.topology.cut_points);
  EXPECT_EQ(lent.seeds, own.seeds);
  EXPECT_FALSE(lent.cells);
}

TEST(ChooseComponents, ASmallBodySampledLikeTheRestIsKept) {
  // A sixteenth of the area with as many samples on it; then with three times the spacing.
  for (const int n : {125, 14}) {
    Domain d = domain([](const Vec3& x) { return std::min(ball(x, {0, 0, 0}, 1), ball(x, kCorner, .25)); });
    add_ball_samples(d.cloud.points, kCorner, .25, n);
    const ZeroSetChoice c = choose_components(d, .15);
    EXPECT_EQ(c.seeds.size(), 2u) << n;
    EXPECT_EQ(c.euler_characteristic, 4);
    EXPECT_TRUE(c.dropped.empty());
  }
}

TEST(ChooseComponents, FalseSheetsAroundAndInsideTheBodyAreDroppedThoughSamplesAreInTheirBoxes) {
  // Three concentric spheres: the body (radius 1), a false shell outside and a false cavity inside.
  const Domain d = domain([](const Vec3& x) {
    const double r = x.norm();
    return std::max(std::min(r - 1, std::abs(r - 1.45) - .2), .4 - r);
  });
  const ZeroSetChoice c = choose_components(d, .15);
  ASSERT_EQ(c.topology.components.size(), 4u);
  ASSERT_EQ(c.seeds.size(), 1u);
  EXPECT_NEAR(c.seeds[0].norm(), 1, .05);
  EXPECT_EQ(c.dropped.size(), 3u);
}

TEST(ChooseComponents, FormulasAndBodiesFarFromAllSamplesAreTakenAsTheyAre) {
  Domain formula;
  formula.formula = shared_function(Expression("(x^2+y^2+z^2-1) * ((x-3)^2+y^2+z^2-1)"));
  formula.box = Box(Vec3(-1.5, -1.5, -1.5), Vec3(4.5, 1.5, 1.5));
  EXPECT_EQ(choose_components(formula, .2).seeds.size(), 2u);

  Domain none = domain([](const Vec3& x) { return ball(x, {0, 0, 0}, .4); });
  const ZeroSetChoice c = choose_components(none, .15);
  EXPECT_TRUE(c.seeds.empty());
  EXPECT_EQ(c.dropped.size(), 1u);
}

TEST(CountingSpacing, IsBoundedByTheNodesOfTheBox) {
  Domain d;
  d.formula = shared_function(Expression("x"));
  d.box = Box(Vec3::Zero(), Vec3::Ones());
  EXPECT_EQ(counting_spacing(d, .1), .1);
  EXPECT_NEAR(counting_spacing(d, 1e-6), std::cbrt(1 / 5e7), 1e-12);
}

/// Meshes the kept pieces of `d` and measures the result against `judge`.
MeshMeasures measured(const Domain& d, const Domain& judge, double h) {
  UmParams params;
  params.mode = UmMode::Paper;
  params.submesh.search = SubmeshSearch::Crawl;
  const BackgroundMesh background(a15(), d.box, h);
  const UmResult result = universal_mesh(background, d.psi(), params, {}, choose_components(d, h).seeds);
  EXPECT_EQ(result.status, UmStatus::Success) << result.evidence.what;
  return measure(judge, {result.final, result.submesh.mesh.C}, result, choose_components(judge, h), h).measures;
}

std::string text_of(const std::vector<std::string>& reasons) {
  std::string text;
  for (const std::string& reason : reasons) text += reason + "\n";
  return text;
}

/// The distance of a bar and a ball, which counts its evaluations.
struct CountedDistance {
  mutable std::atomic<std::size_t> n = 0;
  double evaluate(const Vec3& x, Vec3*, Mat3*) const {
    ++n;
    const double bar = std::max({std::abs(x.x()) - 1.5, std::abs(x.y()) - .2, std::abs(x.z()) - .2});
    return std::min(bar, ball(x, {0, 1.3, 0}, .3));
  }
};

TEST(ZeroFreeBlocks, ACountSkipsThemAndFindsTheSame) {
  const CountedDistance f;
  const Box box(Vec3::Constant(-1.9), Vec3::Constant(1.9));
  const ZeroSetTopology all = zero_set_topology(f, box, .03);
  const std::size_t n_all = f.n.exchange(0);
  const ZeroSetTopology some = zero_set_topology(f, box, .03, {}, ZeroFreeBlocks(f, box, .03));
  EXPECT_LT(5 * f.n, n_all);
  ASSERT_EQ(some.components.size(), 2u);
  ASSERT_EQ(some.cut_points.size(), all.cut_points.size());
  EXPECT_TRUE(some.cut_points == all.cut_points);
  EXPECT_EQ(some.components[1].euler_characteristic, all.components[1].euler_characteristic);
}

TEST(Measure, TopologyIsComparedAlsoWhenAPieceIsDropped) {
  const Domain good = domain([](const Vec3& x) { return std::min(ball(x, {0, 0, 0}, 1), ball(x, kCorner, .25)); });
  const MeshMeasures whole = measured(good, good, .2);
  EXPECT_TRUE(whole.defects.empty()) << text_of(judge_shape(whole).reasons);
  EXPECT_EQ(whole.domain.topology, TopologyProof::Same);
  EXPECT_EQ(whole.domain.components_of_zero_set, 2u);
  EXPECT_EQ(whole.domain.components_meshed, 1);
  EXPECT_EQ(whole.domain.components_dropped.size(), 1u);
  EXPECT_EQ(whole.domain.euler_characteristic_of_zero_set, 4);
  EXPECT_EQ(whole.domain.euler_characteristic_of_kept_components, 2);

  // The same mesh where the kept piece has a handle that the mesh lacks: one piece again, but chi = 0.
  const Domain drilled = domain([](const Vec3& x) {
    const double hole = .35 - std::hypot(x.x(), x.y());
    return std::min(std::max(ball(x, {0, 0, 0}, 1), hole), ball(x, kCorner, .25));
  });
  const MeshMeasures lacking = measured(good, drilled, .2);
  EXPECT_EQ(lacking.domain.components_dropped.size(), 1u);
  EXPECT_EQ(lacking.domain.euler_characteristic_of_kept_components, 0);
  EXPECT_EQ(lacking.domain.topology, TopologyProof::Differs);
  const std::string reasons = text_of(judge_shape(lacking).reasons);
  EXPECT_NE(reasons.find("Euler characteristic"), std::string::npos) << reasons;
}

}  // namespace
}  // namespace umtet
