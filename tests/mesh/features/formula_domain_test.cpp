#include "mesh/features/formula_domain.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "mesh/expression/expression.h"
#include "mesh/features/feature_graph.h"

namespace umtet {
namespace {

const std::vector<Vec3> kPoints = {{.1, .2, .3}, {-.7, .4, 1.2}, {1.1, -.3, -.8}, {-.2, -1.4, .5}, {2, 1, -2}};

TEST(FormulaDomain, HasTheValueOfItsFormula) {
  const auto square = [](double a) { return a * a; };
  const std::vector<std::pair<std::string, std::function<double(const Vec3&)>>> cases = {
      {"max(x^2+y^2-1, abs(z)-1)",
       [&](const Vec3& p) { return std::max(square(p.x()) + square(p.y()) - 1, std::abs(p.z()) - 1); }},
      {"max(abs(x), abs(y), abs(z)) - 1", [](const Vec3& p) { return p.cwiseAbs().maxCoeff() - 1; }},
      {"-min(1-x^2-y^2-z^2, 2*z+1)", [](const Vec3& p) { return -std::min(1 - p.squaredNorm(), 2 * p.z() + 1); }},
      {"2 - -3*max(x, y) - min(z, x)/-4",
       [](const Vec3& p) { return 2 + 3 * std::max(p.x(), p.y()) + std::min(p.z(), p.x()) / 4; }},
      {"abs(x) + abs(y) + abs(z) - 1", [](const Vec3& p) { return p.cwiseAbs().sum() - 1; }},
      {"exp(max(x, y)) - 2", [](const Vec3& p) { return std::exp(std::max(p.x(), p.y())) - 2; }},
      {"max(x, y) + 3 - 1 - z", [](const Vec3& p) { return std::max(p.x(), p.y()) + 2 - p.z(); }},
      {"max(1, 2)*x - min(3, 1)", [](const Vec3& p) { return 2 * p.x() - 1; }},
      {"x^2 + y^2 + z^2 - 1", [](const Vec3& p) { return p.squaredNorm() - 1; }}};
  for (const auto& [text, f] : cases) {
    SCOPED_TRACE(text);
    const PiecewiseDomain domain = domain_of_formula(text);
    for (const Vec3& x : kPoints) EXPECT_NEAR(domain.value(x), f(x), 1e-12);
  }
  EXPECT_EQ(domain_of_formula("abs(x) + abs(y) + abs(z) - 1").n_patches(), 8);
  EXPECT_EQ(domain_of_formula("x^2 + y^2 + z^2 - 1").n_patches(), 1);
}

TEST(FormulaDomain, EqualPartsAndTheirNegativesAreOnePatch) {
  EXPECT_EQ(domain_of_formula("max(x, x)").n_patches(), 1);
  // Two balls without what they share would need a patch on both of its sides.
  EXPECT_EQ(domain_of_formula("max(x^2+y^2+z^2-1, -(x))").n_patches(), 2);
  EXPECT_THROW(domain_of_formula("max(x, -x)"), ExpressionError);
}

TEST(FormulaDomain, RefusesWhatHasNoEdgesThatCanBeFound) {
  for (const char* text : {"sin(max(x, y))", "abs(x)^2", "abs(x)*y", "x/abs(y)", "2^abs(x)", "max(x, 3)", "max(x)",
                           "max(x,", "min x", "max()", "abs(x, y)", "max(1, 2)", "1/max(x, y)", "cos(abs(z))"}) {
    EXPECT_THROW(domain_of_formula(text), ExpressionError) << text;
  }
  std::string many = "x";
  for (int k = 0; k < 9; ++k) many += "+abs(y-" + std::to_string(k) + ")";
  EXPECT_THROW(domain_of_formula(many), ExpressionError) << "512 smooth functions";
}

TEST(FormulaDomain, ExpressionsOfSmoothBodiesStillRefuseKinks) {
  EXPECT_THROW(Expression("max(x, y)"), ExpressionError);
  EXPECT_THROW(Expression("abs(x)-1"), ExpressionError);
}

TEST(FormulaDomain, ACylinderHasTwoSharpCurves) {
  const PiecewiseDomain domain = domain_of_formula("max(x^2+y^2-1, abs(z)-1)");
  std::vector<Vec3> seeds;
  for (double x = -1.2; x < 1.3; x += .2)
    for (double y = -1.2; y < 1.3; y += .2)
      for (double z = -1.2; z < 1.3; z += .2) seeds.emplace_back(x, y, z);
  const FeatureGraph graph = trace_features(domain, seeds, .2);
  ASSERT_EQ(graph.curves.size(), 2U);
  EXPECT_TRUE(graph.corners.empty());
  for (const FeatureCurve& c : graph.curves) {
    EXPECT_TRUE(c.is_closed());
    EXPECT_NEAR(c.angle_deg.front(), 90, 1e-9);
  }
}

}  // namespace
}  // namespace umtet
