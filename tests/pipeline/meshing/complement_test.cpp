// umtet mesh --complement, from outside: the fluid around a body, up to the walls of a box.

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "mesh/certify/boundary_surface.h"
#include "mesh/io/tet_mesh_io.h"
#include "reconstruct/io/point_cloud_io.h"
#include "tests/pipeline/cli/program_fixture.h"
#include "tests/support/data_files.h"

namespace umtet {
namespace {

constexpr double kPi = std::numbers::pi;

/// Area of the boundary faces of a mesh with walls: in the planes of the box, and elsewhere.
struct Areas {
  double walls = 0, body = 0;

  Areas(const MeshFile& file, const Eigen::AlignedBox3d& box) {
    const auto& marked = std::get<std::vector<std::uint8_t>>(file.point_data.at("wall"));
    const std::vector<Vec3>& V = file.mesh.V;
    for (const Triangle& f : boundary_faces(file.mesh.C, V.size()).triangles) {
      bool in_plane = false;
      for (int a = 0; a < 3; ++a) {
        for (const double at : {box.min()[a], box.max()[a]}) {
          in_plane |= V[f[0]][a] == at && V[f[1]][a] == at && V[f[2]][a] == at;
        }
      }
      EXPECT_EQ(in_plane, marked[f[0]] && marked[f[1]] && marked[f[2]]);
      (in_plane ? walls : body) += .5 * (V[f[1]] - V[f[0]]).cross(V[f[2]] - V[f[0]]).norm();
    }
  }
};

struct Body {
  const char* formula;
  double volume, area;
  int genus;
};

TEST_F(Program, FluidAroundABodyIsCertifiedUpToFlatWalls) {
  const Eigen::AlignedBox3d box(Vec3(-2, -2, -1.5), Vec3(3, 2, 1.5));
  for (const Body& body : {Body{"x^2+y^2+z^2-1", 4. / 3 * kPi, 4 * kPi, 0},
                           Body{"(x^2+y^2+z^2+0.84)^2-4*(x^2+y^2)", 2 * kPi * kPi * .16, 4 * kPi * kPi * .4, 1}}) {
    for (const char* order : {"1", "2"}) {
      SCOPED_TRACE(std::string(body.formula) + ", order " + order);
      const Result r =
          run(std::string("mesh --implicit '") + body.formula +
              "' --box=-2,-2,-1.5,3,2,1.5 --box-walls --complement --h .2 -o fluid --json --order " + order);
      ASSERT_EQ(r.code, 0) << r.out << r.err;
      const Json c = Json::parse(content(folder / "fluid/certificate.json"));
      EXPECT_EQ(c["verdict"], "pass");
      EXPECT_EQ(c["boundary"]["components"], 2);
      EXPECT_EQ(c["boundary"]["genus"], body.genus);
      EXPECT_EQ(c["domain"]["components_meshed"], 1);
      EXPECT_EQ(c["n_positive_faces"].get<int>() + c["n_wall_faces"].get<int>(), c["boundary"]["n_faces"]);
      EXPECT_NEAR(c["volume"].get<double>(), box.volume() - body.volume, .06 * body.volume);
      const MeshFile file = read_tet_mesh(folder / "fluid/3-mesh/mesh.vtu");
      const Areas areas(file, box);
      EXPECT_NEAR(areas.walls, 2 * (5 * 4 + 5 * 3 + 4 * 3), 1e-9);
      EXPECT_NEAR(areas.body, body.area, .03 * body.area);
      const Result check = run("check fluid/3-mesh/mesh.vtu --against fluid --json");
      EXPECT_EQ(check.code, 0) << check.out;
      EXPECT_EQ(Json::parse(check.out)["check"]["n_wall_faces"], c["n_wall_faces"]);
    }
  }
}

TEST_F(Program, ComplementNeedsWallsAndRoom) {
  const std::string fluid = "mesh --implicit 'x^2+y^2+z^2-1' --complement -o fluid ";
  const Result no_walls = run(fluid + "--box=-2,-2,-2,2,2,2 --h .2");
  EXPECT_EQ(no_walls.code, 2);
  EXPECT_NE(no_walls.err.find("--complement needs --box-walls"), std::string::npos) << no_walls.err;
  EXPECT_FALSE(fs::exists(folder / "fluid"));
  EXPECT_EQ(run("run egg.ply -o egg --complement").code, 2);
  EXPECT_FALSE(fs::exists(folder / "egg"));
  EXPECT_EQ(run(fluid + "--box=-2,-2,-2,2,2,2 --h .2 --box-walls --background z").code, 2);
  const Result tight = run(fluid + "--box=-1.2,-2,-2,2,2,2 --h .2 --box-walls");
  EXPECT_EQ(tight.code, 5);
  EXPECT_NE(tight.err.find("give a larger --box"), std::string::npos) << tight.err;
}

TEST_F(Program, ABodyThatFallsThroughTheBackgroundIsNoSuccess) {
  const std::string call = "run egg.ply --complement --box-walls --box=-4,-4,-4,4,4,4 -o egg --h ";
  const Result large = run(call + "9");
  EXPECT_EQ(large.code, 6) << large.out << large.err;
  EXPECT_TRUE(Json::parse(content(folder / "egg/certificate.json")).at("cloud").is_null());
  const Result thin = run(call + "3");
  EXPECT_EQ(thin.code, 6) << thin.out << thin.err;
  EXPECT_NE(thin.err.find("1 place is thinner"), std::string::npos) << thin.err;
}

TEST_F(Program, WallsArePatchesOfTheirOwn) {
  const std::string walls = " --complement --box-walls --box=-2,-2,-2,2,2,2 --h .25 ";
  const auto patches = [&](const std::string& name) {
    std::set<std::string> names;
    for (const fs::directory_entry& e : fs::directory_iterator(folder / name / "4-export")) {
      const std::string file = e.path().filename();
      if (file != "mesh.stl") names.insert(file.substr(5, file.size() - 9));
    }
    return names;
  };
  const Result one = run("run egg.ply -o egg --export stl --json" + walls);
  ASSERT_EQ(one.code, 0) << one.err << one.out;
  EXPECT_EQ(patches("egg"), (std::set<std::string>{"boundary_1", "walls"}));
  EXPECT_EQ(fs::file_size(folder / "egg/4-export/mesh.walls.stl"),
            84 + 50 * Json::parse(content(folder / "egg/certificate.json"))["n_wall_faces"].get<std::uintmax_t>());
  ASSERT_EQ(run("export egg --format stl --patch-angle 45").code, 0);
  EXPECT_EQ(patches("egg"),
            (std::set<std::string>{"region_1", "walls_1", "walls_2", "walls_3", "walls_4", "walls_5", "walls_6"}));
  OrientedPointCloud labelled = read_point_cloud(cloud).cloud;
  for (const Vec3& x : labelled.points) labelled.labels.push_back(x.z() < .1 ? 4 : 2);
  {
    std::ofstream out(folder / "labelled.ply", std::ios::binary);
    write_ply(out, labelled);
  }
  ASSERT_EQ(run("run labelled.ply -o named --export stl --label-names 4=inlet,2=top" + walls).code, 0);
  EXPECT_EQ(patches("named"), (std::set<std::string>{"inlet", "top", "walls"}));
  const Result taken = run("export named --format stl --label-names 4=Walls");
  EXPECT_EQ(taken.code, 2);
  EXPECT_NE(taken.err.find("walls of the box"), std::string::npos) << taken.err;
}

TEST_F(Program, FluidAroundAMovingBodyIsCertifiedAtEveryInstant) {
  const Result r = run(
      "evolve --implicit '(x-t)^2+y^2+z^2-1' --box=-2,-2,-2,3,2,2 --complement --box-walls --h .25 -o moving --json "
      "--t 0:0.5:1");
  ASSERT_EQ(r.code, 0) << r.err << r.out;
  const Json answer = Json::parse(r.out);
  ASSERT_EQ(answer.at("steps").size(), 3u);
  for (const Json& step : answer.at("steps")) {
    EXPECT_EQ(step["boundary"]["components"], 2);
    EXPECT_NEAR(step["volume"].get<double>(), 80 - 4. / 3 * kPi, .25);
  }
}

}  // namespace
}  // namespace umtet
