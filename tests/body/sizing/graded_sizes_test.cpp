// What the parameters ask for is what a graded background is made for.

#include "body/sizing/graded_sizes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "body/sizing/background_choice.h"
#include "mesh/sizes/graded_size.h"
#include "pipeline/case/exit_code.h"
#include "pipeline/case/label_names.h"
#include "pipeline/domain/body_options.h"
#include "mesh/expression/expression.h"

namespace umtet {
namespace {

Domain ball() {
  Domain domain;
  domain.formula = shared_function(Expression("x^2+y^2+z^2-1"));
  domain.box = Box(Vec3::Constant(-1.3), Vec3::Constant(1.3));
  domain.diagonal = domain.box.diagonal().norm();
  return domain;
}

Parameters graded(const std::vector<std::string>& more) {
  Parameters p;
  p.set("mesh.background=graded");
  for (const std::string& assignment : more) p.set(assignment);
  return p;
}

TEST(GradedSizes, OfAThickBodyAreHOnTheBoundaryAndGrowInside) {
  const Parameters p = graded({"mesh.h=.1"});
  GradedSizes sizes(body_options(p), Vec3::Zero());
  Domain domain = ball();
  sizes.add(domain);
  EXPECT_EQ(sizes.finest(), .1);
  const SizeField field = sizes.field(.1);
  EXPECT_NEAR(field.at({1, 0, 0}), .1, .005);
  EXPECT_NEAR(field.at({0, 0, 0}), .1 + .3 * .8, .02);
}

/// A lens a tenth as thick as it is wide: sizes fall towards its rim.
TEST(GradedSizes, AreNotLookedForWhereTheyMakeTooManyTets) {
  const Parameters p = graded({"mesh.h=.1"});
  Domain domain = ball();
  domain.formula = shared_function(Expression("x^2+y^2+100*z^2-1"));
  GradedSizes sizes(body_options(p), Vec3::Zero());
  EXPECT_FALSE(sizes.add(domain, {}, 100));
  EXPECT_EQ(sizes.n_domains(), 0);
  EXPECT_TRUE(sizes.add(domain, {}, 1e6));
  EXPECT_EQ(sizes.n_domains(), 1);
  const double h = sizes.finest();
  EXPECT_GT(expected_graded_tets(sizes.field(h), h, domain.psi(), domain.box, domain.steepest()), 100);
}

TEST(GradedSizes, KeepTheirGradeAtAnotherH) {
  const Parameters p = graded({"mesh.h=.1", "mesh.constant_layer=0"});
  GradedSizes sizes(body_options(p), Vec3::Zero());
  Domain domain = ball();
  sizes.add(domain);
  const SizeField half = sizes.field(.05);
  // Sources are as far apart as they were for .1: between them sizes rise by the grade.
  EXPECT_NEAR(half.at({0, 0, 1}), .05, .3 * .05 + .001);
  EXPECT_NEAR(half.at({0, 0, 0}), .05 + .3, .02);
}

TEST(GradedSizes, OfAFormulaAreItsValues) {
  const Parameters p = graded({"mesh.h=.2", "mesh.size=0.02+0.1*sqrt(x^2+y^2+(z-1)^2)"});
  GradedSizes sizes(body_options(p), Vec3::Zero());
  Domain domain = ball();
  sizes.add(domain);
  const SizeField field = sizes.field(sizes.finest());
  EXPECT_NEAR(sizes.finest(), .02, .004);
  EXPECT_NEAR(field.at({0, 0, 1}), .02, .002);
  EXPECT_NEAR(field.at({0, 0, .5}), .07, .004);
}

TEST(GradedSizes, AreNotBelowTheFloorNorAboveTheCeiling) {
  const Parameters p = graded({"mesh.h=.2", "mesh.size=0.001", "mesh.h_min=.05", "mesh.h_max=.15"});
  EXPECT_THROW(GradedSizes(body_options(p), Vec3::Zero()), UsageError);  // it does not depend on x, y or z
  const Parameters q = graded({"mesh.h=.2", "mesh.size=0.001+0.4*(z-1)^2", "mesh.h_min=.05", "mesh.h_max=.15"});
  GradedSizes sizes(body_options(q), Vec3::Zero());
  Domain domain = ball();
  sizes.add(domain);
  const SizeField field = sizes.field(sizes.finest());
  for (double z = -1; z <= 1; z += .1) {
    EXPECT_GE(field.at({0, 0, z}), .05 * .95);
    EXPECT_LE(field.at({0, 0, z}), .15);
  }
}

/// What add() says against a formula, for a ball moved by 1000; empty if nothing.
std::string complaint_about(const std::string& size, const std::vector<std::string>& more = {}) {
  Parameters p = graded({"mesh.h=.2", "mesh.size=" + size});
  for (const std::string& assignment : more) p.set(assignment);
  GradedSizes sizes(body_options(p), Vec3(1000, 0, 0));
  Domain domain = ball();
  try {
    sizes.add(domain);
  } catch (const UsageError& e) {
    return e.what();
  }
  return "";
}

TEST(GradedSizes, AFormulaThatIsNoLengthInTheBodyIsRefusedWithAPlace) {
  const std::string said = complaint_about("x-1000");
  EXPECT_NE(said.find("sizes = x-1000 is -"), std::string::npos) << said;
  EXPECT_NE(said.find("at (999"), std::string::npos) << said;
  EXPECT_NE(complaint_about(".5-(x-1000)^2-y^2-z^2"), "");  // on the boundary alone
  EXPECT_NE(complaint_about("(x-1000)^2+y^2+z^2-.3"), "");  // inside alone
  EXPECT_NE(complaint_about("sqrt(x-1000)").find("nan"), std::string::npos);
  EXPECT_EQ(complaint_about(".1*(x-1000)+.13"), "");            // above 0 in the body, not in all of the box
  EXPECT_EQ(complaint_about("x-1000", {"mesh.h_min=.1"}), "");  // raised
}

TEST(GradedSizes, ShiftedCoordinatesAreThoseOfTheModel) {
  const Vec3 shift(1000, 0, 0);
  const Parameters p = graded({"mesh.h=.2", "mesh.size=0.02+0.1*sqrt((x-1000)^2+y^2+(z-1)^2)"});
  GradedSizes sizes(body_options(p), shift);
  Domain domain = ball();
  sizes.add(domain);
  EXPECT_NEAR(sizes.field(sizes.finest()).at({0, 0, 1}), .02, .002);
}

TEST(GradedSizes, OfLabelsAreFactorsOfH) {
  const std::map<int, std::string> names = {{7, "feet"}};
  EXPECT_EQ(parse_label_sizes("1=.5,feet=.3,-2=.25", names), (std::map<int, double>{{1, .5}, {7, .3}, {-2, .25}}));
  for (const char* bad : {"1", "1=", "a=.5", "1=0", "1=2", "1=.5;2=.5", "feet=.5,7=.5"}) {
    EXPECT_THROW(parse_label_sizes(bad, names), UsageError) << bad;
  }
  const Parameters p = graded({"mesh.h=.1", "mesh.size_at=head=.5", "output.label_names=3=head"});
  GradedSizes sizes(body_options(p), Vec3::Zero());
  Domain domain = ball();
  EXPECT_THROW(sizes.add(domain), UsageError);  // no labels
  domain.cloud.points = {{0, 0, 1}, {0, 0, -1}};
  domain.cloud.labels = {3, 4};
  GradedSizes labelled(body_options(p), Vec3::Zero());
  labelled.add(domain);
  EXPECT_NEAR(labelled.field(labelled.finest()).at({0, 0, 1}), .05, .003);
  EXPECT_NEAR(labelled.field(labelled.finest()).at({0, 0, -1}), .1, .005);
}

TEST(GradedSizes, AreForGradedBackgroundsOnly) {
  EXPECT_FALSE(is_graded(Parameters()));
  for (const char* given : {"mesh.size=.1*x", "mesh.size_at=1=.5", "mesh.h_min=.1", "mesh.h_max=.1", "mesh.grade=.2",
                            "mesh.grade_inside=true", "mesh.max_turn=20"}) {
    Parameters p;
    p.set(given);
    EXPECT_TRUE(is_graded(p)) << given;  // auto: nothing else takes sizes
    EXPECT_NO_THROW(require_graded(p)) << given;
    p.set("mesh.background=a15");
    EXPECT_FALSE(is_graded(p)) << given;
    EXPECT_THROW(require_graded(p), UsageError) << given;
    EXPECT_NO_THROW(require_graded(graded({given}))) << given;
  }
  EXPECT_THROW(require_graded(graded({"mesh.h=.1", "mesh.h_min=.2"})), UsageError);
  EXPECT_THROW(require_graded(graded({"mesh.h_max=.1", "mesh.h_min=.2"})), UsageError);
  EXPECT_THROW(require_graded(graded({"mesh.grade_inside=true", "mesh.size=.1*x"})), UsageError);
}

TEST(BackgroundChoice, OfAGradedMeshHasAboutTheTetsThatWereAskedFor) {
  const Parameters p = graded({"mesh.tets=60000"});
  Domain domain = ball();
  BackgroundChoice choice(body_options(p), domain);
  const EdgeLength h = choice.edge_length(domain);
  EXPECT_NEAR(choice.expected_tets(domain, h.h), 60000, 6000);
  const SizedBackground made = choice.make(domain, h.h, 60000, 1e12);
  ASSERT_TRUE(made.sizes);
  EXPECT_EQ(made.mesh.h(), h.h);
  EXPECT_FALSE(made.mesh.is_lattice());
  // No vertex has longer edges than its size and a half, where the octree could split.
  for (std::int64_t v = 0; v < made.mesh.n_vertices(); ++v) {
    if (made.mesh.on_boundary(v)) continue;
    EXPECT_LE(made.mesh.h(v), 1.5 * made.sizes->at(made.mesh.position(v)));
  }
}

TEST(BackgroundChoice, ExpectsOfEachOfSeveralDomainsItsOwnTets) {
  const Parameters p = graded({"mesh.h=.1"});
  Domain large = ball(), small = ball();
  small.formula = shared_function(Expression("x^2+y^2+z^2-.25"));
  BackgroundChoice choice(body_options(p), large);
  choice.edge_length(large);
  const double h = choice.edge_length(small).h;
  EXPECT_GT(choice.expected_tets(large, h), 2 * choice.expected_tets(small, h));
}

TEST(BackgroundChoice, RefusesSizesThatMakeTooManyTets) {
  const Parameters p = graded({"mesh.h=.02", "mesh.max_tets=10000"});
  Domain domain = ball();
  BackgroundChoice choice(body_options(p), domain);
  EXPECT_THROW(choice.edge_length(domain), ResourceLimit);
}

}  // namespace
}  // namespace umtet
