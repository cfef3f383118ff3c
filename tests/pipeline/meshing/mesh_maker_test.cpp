#include "pipeline/meshing/mesh_maker.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <string>
#include <vector>

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
    domain.formula.emplace(text);
    domain.box = Box(Vec3::Constant(-5.5), Vec3::Constant(5.5));
    domain.diagonal = domain.box.diagonal().norm();
    const Parameters parameters;
    return MeshMaker(domain, parameters, {}).attempt({BackgroundMesh(a15(), domain.box, 1)}, 1);
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
    EXPECT_EQ(first.places.size(), again.places.size());
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
  MeshMaker maker(domain, parameters, {});
  for (const double h : {.3, .29, .22, .19, .25}) {  // cubes of .1, .1, .1, .05, .1
    const SignCells cells = maker.pieces_at(h).cells.value(), found = sign_cells(*domain.level_set, h / 2);
    EXPECT_EQ(cells.size, found.size) << h;
    EXPECT_EQ(cells.cells, found.cells) << h;
    EXPECT_FALSE(cells.cells.empty());
  }
}

}  // namespace
}  // namespace umtet
