#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "mesh/io/tet_mesh_io.h"
#include "pipeline/case/artefact.h"
#include "pipeline/case/exit_code.h"
#include "examples/swimmer/channel_mesher.h"
#include "tests/support/domains.h"
#include "tests/support/sphere_in_channel.h"

namespace umtet {
namespace {

/// Of a sphere of radius 1 on the axis that moves along it, over 6 pi mu a U.
double drag(double n_tets) {
  const ChannelMesher mesher(n_tets);
  const auto sphere = testing::sphere();
  const FluidMesh fluid = mesher.mesh(Complement(sphere));
  StokesSolver solver(mesher.n_vertices(), mesher.tets(), {});
  std::vector<int> fixed = fluid.walls;
  fixed.insert(fixed.end(), fluid.swimmer.begin(), fluid.swimmer.end());
  solver.assemble(fluid.V, fluid.tets, fixed);
  std::vector<Vec3> velocity(fluid.V.size(), Vec3::Zero());
  for (const int i : fluid.swimmer) velocity[i] = Vec3::UnitZ();
  const std::vector<Vec3> forces = solver.forces(solver.solve(velocity));
  double sum = 0;
  for (const int i : fluid.swimmer) sum -= forces[i].z();
  return sum / (6 * std::numbers::pi);
}

TEST(ChannelMesher, DragOfASphereIsThatOfHappelAndBart) {
  // swimmer_bench 300000 and 850000 are nearer; with fewer tets the facets of the sphere decide.
  const double of_um = drag(160000), published = testing::wall_corrected_drag(1. / 6);
  std::printf("drag over 6 pi mu a U: %.4f, published %.4f\n", of_um, published);
  EXPECT_NEAR(of_um / published, 1, .05);
  const double around = testing::drag_in_cylinder(1 / std::sqrt(72.)), within = testing::drag_in_cylinder(1. / 6);
  for (const double drag : {of_um, published}) {
    EXPECT_GT(drag, around);
    EXPECT_LT(drag, within);
  }
}

TEST(ChannelMesher, KeepsTheWallsAndFindsTheSwimmerThinnerThanAnEdge) {
  const ChannelMesher mesher(50000);  // edges of .91: positively cut tets meet across a tip
  const Swimmer swimmer(-8, 0);
  const FluidMesh fluid = mesher(swimmer);
  for (const int i : fluid.swimmer) EXPECT_NEAR(swimmer.value(fluid.V[i]), 0, 1e-8);
  std::vector<char> moved(fluid.V.size(), 0);
  for (std::size_t i = 0; i < moved.size(); ++i) {
    moved[i] = fluid.V[i] != mesher.background().position(static_cast<std::int64_t>(i));
  }
  for (const int i : fluid.walls) {
    EXPECT_FALSE(moved[i]);
    EXPECT_TRUE(fluid.V[i].head<2>().cwiseAbs().maxCoeff() == 6 || fluid.V[i].z() == -14.58);
  }
  const auto open = std::count_if(fluid.V.begin(), fluid.V.end(), [](const Vec3& x) {
    return x.z() == 14.58 && x.head<2>().cwiseAbs().maxCoeff() < 6;
  });
  EXPECT_GT(open, 0);
  EXPECT_THROW(mesher(Swimmer(-8, 7)), MeshingImpossible);  // its head is in the open end
  EXPECT_THROW(ChannelMesher(0), std::invalid_argument);
}

int run(const std::string& arguments) {
  const int status = std::system((UMTET_SWIMMER " " + arguments + " > /dev/null 2>&1").c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

TEST(SwimmerProgram, TwoStepsMakeTheTableThePictureAndTheFields) {
  const std::filesystem::path folder = std::filesystem::path(::testing::TempDir()) / "umtet_swimmer";
  std::filesystem::remove_all(folder);
  ASSERT_EQ(run("-o " + folder.string() + " --tets 50000 --steps 2 --dt 8"), 0);

  std::istringstream csv(read_text(folder / "swimmer.csv"));
  std::string line;
  std::getline(csv, line);
  EXPECT_EQ(line, "t,velocity,z0,F_deformation,F_translation,min_Q,tets,volume_gap,seconds");
  std::vector<std::vector<double>> rows;
  while (std::getline(csv, line)) {
    rows.emplace_back();
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(std::stod(cell));
    ASSERT_EQ(rows.back().size(), 9u);
  }
  ASSERT_EQ(rows.size(), 3u);
  const std::string pvd = read_text(folder / "swimmer.pvd");
  for (std::size_t k = 0; k < 3; ++k) {
    EXPECT_EQ(rows[k][0], -8 + 8 * static_cast<double>(k));
    if (k > 0) {
      EXPECT_NEAR(rows[k][2], rows[k - 1][2] + 8 * rows[k - 1][1], 1e-12);
    }
    EXPECT_NEAR(rows[k][1], -rows[k][3] / rows[k][4], 1e-12);
    EXPECT_GT(rows[k][5], .6);
    EXPECT_TRUE(rows[k][7] > .05 && rows[k][7] < .4) << rows[k][7];  // edges of .98 on a swimmer of radius 1
    const std::string name = "fields/00" + std::to_string(k) + ".vtu";
    EXPECT_NE(pvd.find(name), std::string::npos);
    const MeshFile file = read_tet_mesh(folder / name);
    EXPECT_EQ(static_cast<double>(file.mesh.C.size()), rows[k][6]);
    const auto& w = std::get<std::vector<double>>(file.point_data.at("u_z_z"));
    EXPECT_EQ(*std::max_element(w.begin(), w.end()), 1);  // the body's own velocity
    EXPECT_TRUE(file.point_data.contains("p_phi") && file.cell_data.contains("background_tet"));
  }
  const std::string svg = read_text(folder / "swimmer.svg");
  std::size_t marks = 0;
  for (std::size_t at = 0; (at = svg.find("<circle", at)) != std::string::npos; ++at) ++marks;
  EXPECT_EQ(marks, 6u);
  EXPECT_TRUE(svg.ends_with("</svg>\n"));
  std::filesystem::remove_all(folder);
}

TEST(SwimmerProgram, WhatItCannotDoHasItsExitCode) {
  EXPECT_EQ(run("--tets 30000"), static_cast<int>(ExitCode::Usage));
  EXPECT_EQ(run("-o /proc/none --tets 30000"), static_cast<int>(ExitCode::FileTrouble));
  const std::string folder = (std::filesystem::path(::testing::TempDir()) / "umtet_swimmer_thin").string();
  // In so coarse a channel vertices stay off the body, which is thinner than an edge.
  EXPECT_EQ(run("-o " + folder + " --tets 10000 --t0 0 --steps 1"), static_cast<int>(ExitCode::GateFailed));
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace umtet
