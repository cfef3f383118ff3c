#include "body/search/mesh_maker.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "pipeline/domain/body_options.h"
#include "mesh/expression/expression.h"

namespace umtet {
namespace {

TEST(MeshMaker, TwoBallsThatNearlyTouchHaveTheSameBytesInEveryRun) {
  // Rotated by numbers with many digits and two fifths of an edge apart: classification, steps back and repair depend
  // on the last bits of psi, and psi on how its text is read.
  const auto ball = [](const char* sign) {
    return std::string("((0.7243*(x-0.2499)-0.5327*y+0.4373*z") + sign +
           "1.7)^2+(0.6531*(x-0.2499)+0.7242*y-0.2219*z)^2+(-0.2205*(x-0.2499)+0.4378*y+0.8716*z)^2-9/4)";
  };
  const std::string text = ball("+") + "*" + ball("-");
  const auto mesh = [&] {
    Domain domain;
    domain.formula = shared_function(Expression(text));
    domain.box = Box(Vec3::Constant(-5.5), Vec3::Constant(5.5));
    domain.diagonal = domain.box.diagonal().norm();
    const Parameters parameters;
    return MeshMaker(domain, body_options(parameters), {}).attempt({BackgroundMesh(a15(), domain.box, 1)}, 1);
  };
  const MeshAttempt first = mesh();
  ASSERT_TRUE(first.made());
  for (const std::size_t threads : {1, 2, 4}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    const MeshAttempt again = mesh();
    ASSERT_EQ(first.result.submesh.positive_faces, again.result.submesh.positive_faces) << threads;
    ASSERT_EQ(first.result.final.size(), again.result.final.size()) << threads;
    for (std::size_t i = 0; i < first.result.final.size(); ++i) {
      ASSERT_EQ(first.result.final[i], again.result.final[i]) << threads;
    }
    EXPECT_EQ(first.reasons, again.reasons);
    EXPECT_EQ(first.defects.size(), again.defects.size());
  }
}

TEST(MeshMaker, CellsOfAnEarlierHAreThoseOfASearch) {
  const Lattice lattice{.origin = Vec3::Constant(-2), .h = .2, .n = Eigen::Vector3i::Constant(21)};
  std::vector<double> values;
  for (int node = 0; node < 21 * 21 * 21; ++node) {
    values.push_back((Vec3::Constant(-2) + .2 * Vec3(node % 21, node / 21 % 21, node / 441)).norm() - 1);
  }
  Domain domain;
  domain.level_set.emplace(LmePrior{}, LevelSetLevel{lattice, values});
  domain.box = Box(Vec3::Constant(-1.9), Vec3::Constant(1.9));
  domain.cloud.points = domain.cloud.normals = {{1, 0, 0}};
  domain.cloud_spacing = .1;
  const Parameters parameters;
  MeshMaker maker(domain, body_options(parameters), {});
  for (const double h : {.3, .29, .22, .19, .25}) {  // cubes of .1, .1, .1, .05, .1
    const SignCells cells = maker.pieces_at(h).cells.value(), found = sign_cells(*domain.level_set, h / 2);
    EXPECT_EQ(cells.size, found.size) << h;
    EXPECT_EQ(cells.cells, found.cells) << h;
    EXPECT_FALSE(cells.cells.empty());
  }
}

/// Two balls of .5 and a rod of .15 between them.
double dumbbell(const Vec3& x) {
  const double balls = std::min((x - Vec3(.8, 0, 0)).norm(), (x + Vec3(.8, 0, 0)).norm()) - .5;
  return std::min(balls, std::max(std::hypot(x[1], x[2]) - .15, std::abs(x[0]) - .8));
}

Domain dumbbell_domain() {
  const Eigen::Vector3i n(61, 33, 33);
  const Lattice lattice{.origin = Vec3(-1.5, -.8, -.8), .h = .05, .n = n};
  std::vector<double> values;
  for (int k = 0; k < n[2]; ++k) {
    for (int j = 0; j < n[1]; ++j) {
      for (int i = 0; i < n[0]; ++i) values.push_back(dumbbell(lattice.origin + lattice.h * Vec3(i, j, k)));
    }
  }
  Domain domain;
  domain.level_set.emplace(LmePrior{}, LevelSetLevel{lattice, values});
  domain.fitted = domain.level_set;
  domain.box = domain.level_set->domain();
  domain.diagonal = 3;
  domain.cloud.points = domain.cloud.normals = {{1.3, 0, 0}};
  domain.cloud_spacing = .1;
  return domain;
}

/// Nodes near psi = 0, but for the rod: no sample asks for small edges.
void add_samples_of_the_balls(Domain& domain) {
  constexpr double kStep = .05, kNear = .025, kEnd = .5;
  domain.cloud = {};
  for (double x = -1.4; x <= 1.4; x += kStep) {
    for (double y = -.7; y <= .7; y += kStep) {
      for (double z = -.7; z <= .7; z += kStep) {
        const Vec3 at(x, y, z);
        Vec3 gradient;
        const double value = domain.level_set->evaluate(at, &gradient, nullptr);
        if (std::abs(x) < kEnd || std::abs(value) > kNear * gradient.norm()) continue;
        domain.cloud.points.push_back(at - value / gradient.squaredNorm() * gradient);
        domain.cloud.normals.push_back(gradient.normalized());
      }
    }
  }
}

TEST(MeshMaker, WhereNoOneEdgeLengthDoesEdgesFollowTheBody) {
  for (const char* background : {"auto", "a15"}) {
    Domain domain = dumbbell_domain();
    add_samples_of_the_balls(domain);
    Parameters parameters;
    parameters.set(std::string("mesh.background=") + background);
    BackgroundChoice backgrounds(body_options(parameters), domain);
    const EdgeLength choice = backgrounds.edge_length(domain);
    ASSERT_FALSE(backgrounds.is_graded());
    // Lattices in which the rod gets lost.
    const auto make = [&](double h) {
      return backgrounds.is_graded() ? backgrounds.make(domain, h, 0, 1e12)
                                     : SizedBackground{BackgroundMesh(a15(), domain.box, 8 * h)};
    };
    std::vector<std::string> said;
    MeshMaker maker(domain, body_options(parameters), {},
                    {.say = [&](const Message& line) { said.push_back(text_of(line)); }});
    const MeshAttempt best = maker.best(backgrounds, choice, make);
    ASSERT_TRUE(best.made());
    const bool may_be_graded = std::string(background) == "auto";
    EXPECT_EQ(best.is_right(), may_be_graded);
    EXPECT_EQ(best.sizes != nullptr, may_be_graded);
    EXPECT_EQ(backgrounds.is_graded(), may_be_graded);
    const auto is_of_grading = [](const std::string& line) { return line.find("no one h does") != std::string::npos; };
    EXPECT_EQ(std::any_of(said.begin(), said.end(), is_of_grading), may_be_graded);
  }
}

TEST(MeshMaker, PiecesAreCountedOnTheEdgesOfTheMeshThatIsMade) {
  Domain domain = dumbbell_domain();
  const Parameters parameters;
  MeshMaker maker(domain, body_options(parameters), {});
  const double h = .02 * domain.diagonal;
  const SizeField sizes({{domain.box.center(), h, domain.diagonal}}, {.h_min = h});
  EXPECT_EQ(maker.pieces_at(h).share, 0) << "a grid";
  EXPECT_GT(maker.pieces_at(h, &sizes).share, 0) << "a graded mesh of the same h";
  EXPECT_EQ(maker.pieces_at(h).share, 0);
}

}  // namespace
}  // namespace umtet
