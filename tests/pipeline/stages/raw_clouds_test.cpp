// Scans as they come: without normals, with normals turned over, with junk, too large; and what inspect says of them.

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <sstream>

#include "mesh/io/tet_mesh_io.h"
#include "reconstruct/io/point_cloud_io.h"
#include "tests/pipeline/cli/program_fixture.h"

namespace umtet {
namespace {

Json record(const fs::path& stage) { return Json::parse(content(stage / "record.json")); }

TEST_F(Program, NormalsAreEstimatedWhereThereAreNone) {
  std::ofstream out(folder / "bare.xyz");
  write_cloud("bare.ply", [&](const double(&x)[6]) {
    out << x[0] << ' ' << x[1] << ' ' << x[2] << '\n';
    return std::string();
  });
  out.close();
  const Result r = run("run bare.xyz -o bare --tets 4000 --json");
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_NE(r.err.find("estimated the normals"), std::string::npos) << r.err;
  const Json normals = record(folder / "bare/1-cloud")["numbers"]["normals"];
  EXPECT_EQ(normals["source"], "estimated");
  EXPECT_EQ(normals["pieces"], 1);
  // The same body as with the given normals.
  const Result given = run("run egg.ply -o egg --tets 4000 --json");
  EXPECT_NEAR(Json::parse(r.out)["certificate"]["volume"].get<double>(),
              Json::parse(given.out)["certificate"]["volume"].get<double>(), 3e-3);
  // --flip turns the body inside out: there is none.
  EXPECT_EQ(run("run bare.xyz -o flipped --tets 4000 --flip").code, 4);
}

TEST_F(Program, ThinPlatesWithoutNormalsGetTheirSidesFromTheWindingNumber) {
  constexpr int kAlong = 24;  // a plate one spacing thick: the nearest neighbours of a sample are on both sheets
  std::ofstream out(folder / "plate.xyz");
  for (int i = 0; i <= kAlong; ++i)
    for (int j = 0; j <= kAlong; ++j)
      for (const int k : {0, 1}) out << i + .1 * (j % 2) << ' ' << j + .1 * (i % 2) << ' ' << k << '\n';
  out.close();
  const Result r = run("reconstruct plate.xyz -o plate");
  EXPECT_EQ(r.code, 0) << r.err;
  EXPECT_NE(r.err.find("the winding number decided"), std::string::npos) << r.err;
  const Json normals = record(folder / "plate/1-cloud")["numbers"]["normals"];
  EXPECT_GT(normals["turned_by_winding"], kAlong * kAlong / 2);
}

TEST_F(Program, DirectionsToTheScannerAreNoNormals) {
  // Of a ball that is seen from four sides, and a direction that is the same everywhere: neither says how it lies.
  for (const bool is_same : {false, true}) {
    write_cloud("sight.ply", [&](const double(&x)[6]) {
      const Eigen::Vector3d at(x[0], x[1], x[2]), from(x[0] > 0 ? 3 : -3, x[1] > 0 ? 3 : -3, .5);
      const Eigen::Vector3d sight = is_same ? Eigen::Vector3d(0, 0, 1) : Eigen::Vector3d(from - at);
      std::ostringstream line;
      line << at.transpose() << ' ' << sight.transpose();
      return line.str();
    });
    const Result r = run("run sight.ply -o sight --force --tets 4000 --json");
    ASSERT_EQ(r.code, 0) << r.err;
    EXPECT_NE(r.err.find("the normals of the file are none"), std::string::npos) << r.err;
    EXPECT_EQ(r.err.find("look to the scanner") != std::string::npos, !is_same) << r.err;
    EXPECT_EQ(record(folder / "sight/1-cloud")["numbers"]["normals"]["source"], "estimated");
    const Result given = run("run egg.ply -o egg --tets 4000 --json");
    EXPECT_NEAR(Json::parse(r.out)["certificate"]["volume"].get<double>(),
                Json::parse(given.out)["certificate"]["volume"].get<double>(), 3e-3);
  }
  EXPECT_NE(run("inspect sight.ply").out.find("may be lines of sight"), std::string::npos);
}

TEST_F(Program, EstimatedNormalsLookToTheScannerThatThePcdNames) {
  constexpr int kAlong = 20;
  for (const int height : {-5, 5}) {
    std::ofstream out(folder / "dish.pcd");
    out << "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 400\nHEIGHT 1\nVIEWPOINT 0 0 "
        << height << " 1 0 0 0\nPOINTS 400\nDATA ascii\n";
    for (int i = 0; i < kAlong * kAlong; ++i) {
      const double x = (i % kAlong - 9.5) / 10, y = (i / kAlong - 9.5) / 10;  // NOLINT(bugprone-integer-division)
      out << x << ' ' << y << ' ' << .2 * (x * x + y * y) << '\n';
    }
    out.close();
    const Result r = run("reconstruct dish.pcd -o dish" + std::to_string(height + 5));  // an open sheet bounds no body
    EXPECT_NE(r.err.find("the VIEWPOINT of the file"), std::string::npos) << r.err;
    const OrientedPointCloud cloud =
        read_point_cloud(folder / ("dish" + std::to_string(height + 5)) / "1-cloud/cloud.ply").cloud;
    for (const Vec3& n : cloud.normals) EXPECT_GT(n.z() * height, 0);
  }
}

TEST_F(Program, EstimatedNormalsLookToTheOriginOfEachPoint) {
  constexpr int kAlong = 24;  // a plate one spacing thick, each side seen by a scanner of its own
  for (const char* names : {"sx sy sz", "origin_x origin_y origin_z"}) {
    std::istringstream words(names);
    std::array<std::string, 3> name;
    words >> name[0] >> name[1] >> name[2];
    std::ofstream out(folder / "plate.ply");
    out << "ply\nformat ascii 1.0\nelement vertex " << 2 * kAlong * kAlong << '\n';
    for (const char* p : {"x", "y", "z"}) out << "property float " << p << '\n';
    for (const std::string& p : name) out << "property float " << p << '\n';
    out << "end_header\n";
    for (int i = 0; i < kAlong; ++i)
      for (int j = 0; j < kAlong; ++j)
        for (const int k : {0, 1})
          out << i + .1 * (j % 2) << ' ' << j + .1 * (i % 2) << ' ' << k << " 9 9 " << (k == 0 ? -40 : 40) << '\n';
    out.close();
    const Result r = run("reconstruct plate.ply -o plate --force");
    EXPECT_EQ(r.code, 0) << r.err;
    EXPECT_NE(r.err.find("the scanner that saw each point"), std::string::npos) << r.err;
    const OrientedPointCloud cloud = read_point_cloud(folder / "plate/1-cloud/cloud.ply").cloud;
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
      const bool is_top = cloud.points[i].z() > .5;
      EXPECT_GT(cloud.normals[i].dot(Vec3(9, 9, is_top ? 40 : -40) - cloud.points[i]), 0);
    }
  }
}

TEST_F(Program, ATurnedMinorityIsTurnedBackAndSaidSo) {
  int i = 0;
  write_cloud("turned.ply", [&](const double(&x)[6]) {
    const double sign = i++ % 7 == 0 ? -1 : 1;
    std::ostringstream s;
    s.precision(17);
    for (int k = 0; k < 6; ++k) s << (k < 3 ? x[k] : sign * x[k]) << ' ';
    return s.str();
  });
  const int turned = (i + 6) / 7;
  const Result r = run("run turned.ply -o turned --tets 4000");
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_NE(r.err.find("turned " + std::to_string(turned) + " of the given normals"), std::string::npos) << r.err;
  const Json normals = record(folder / "turned/1-cloud")["numbers"]["normals"];
  EXPECT_EQ(normals["turned"], turned);
  EXPECT_LT(normals["consistency"], .9);
  EXPECT_EQ(run("run egg.ply -o egg --until cloud").code, 0);
  EXPECT_EQ(content(folder / "turned/1-cloud/cloud.ply"), content(folder / "egg/1-cloud/cloud.ply"));
  EXPECT_EQ(record(folder / "egg/1-cloud")["numbers"]["normals"]["turned"], 0);
}

TEST_F(Program, TheOrderOfPointsInTheFileDoesNotMatter) {
  std::vector<std::string> lines;
  write_cloud("egg2.ply", [&](const double(&x)[6]) {
    std::ostringstream s;
    s.precision(17);
    for (const double v : x) s << v << ' ';
    lines.push_back(s.str());
    return lines.back();
  });
  std::shuffle(lines.begin(), lines.end(), std::mt19937_64(1));
  write_cloud("shuffled.ply", [&](const double(&)[6]) {
    std::string line = std::move(lines.back());
    lines.pop_back();
    return line;
  });
  ASSERT_NE(content(folder / "shuffled.ply"), content(folder / "egg2.ply"));
  EXPECT_EQ(run("run egg2.ply -o egg2 --until cloud").code, 0);
  EXPECT_EQ(run("run shuffled.ply -o shuffled --until cloud").code, 0);
  EXPECT_EQ(content(folder / "shuffled/1-cloud/cloud.ply"), content(folder / "egg2/1-cloud/cloud.ply"));
}

TEST_F(Program, JunkIsDroppedAndCounted) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-3, 3);
  int i = 0;
  write_cloud("junk.ply", [&](const double(&x)[6]) {
    std::ostringstream s;
    s.precision(17);
    if (++i == 5) return std::string("nan 0 0 0 0 1");
    if (i == 6) return std::string("1e5 0 0 1 0 0");  // far away: must not decide the size of anything
    if (i == 7 || i == 8) return std::string(".01 .02 .59 0 0 1");
    for (const double v : x) s << v << ' ';
    return s.str();
  });
  const Result r = run("run junk.ply -o junk --tets 4000 --json");
  ASSERT_EQ(r.code, 0) << r.err;
  const Json dropped = record(folder / "junk/1-cloud")["numbers"]["dropped"];
  EXPECT_EQ(dropped["not_finite"], 1);
  EXPECT_EQ(dropped["duplicates"], 1);
  EXPECT_EQ(dropped["outliers"].get<int>() + dropped["small_components"].get<int>(), 1);
  EXPECT_EQ(Json::parse(r.out)["certificate"]["n_points"], i - 3);
  EXPECT_TRUE(Json::parse(r.out)["certificate"]["domain"]["components_proved"]);
  EXPECT_EQ(run("run junk.ply -o kept --until cloud --keep-all").code, 0);
  EXPECT_EQ(record(folder / "kept/1-cloud")["numbers"]["n_points"], i - 2);
}

TEST_F(Program, ViewpointsDecideAndAreInput) {
  std::ofstream(folder / "outside.xyz") << "# six scanners\n4 0 0\n-4 0 0\n0 4 0\n0 -4 0\n0 0 4\n0 0 -4\n";
  int i = 0;
  write_cloud("mixed.ply", [&](const double(&x)[6]) {
    const double sign = i++ % 2 ? -1 : 1;
    std::ostringstream s;
    s.precision(17);
    for (int k = 0; k < 6; ++k) s << (k < 3 ? x[k] : sign * x[k]) << ' ';
    return s.str();
  });
  const std::string call = "run mixed.ply -o mixed --until cloud --normals given --orient-from outside.xyz";
  ASSERT_EQ(run(call).code, 0);
  EXPECT_EQ(run("run egg.ply -o egg --until cloud").code, 0);
  EXPECT_EQ(content(folder / "mixed/1-cloud/cloud.ply"), content(folder / "egg/1-cloud/cloud.ply"));
  EXPECT_NE(run(call).err.find("nothing to do"), std::string::npos);
  std::ofstream(folder / "outside.xyz") << "0 0 0\n";
  EXPECT_NE(run(call).err.find("cloud: done"), std::string::npos);
  EXPECT_NE(content(folder / "mixed/1-cloud/cloud.ply"), content(folder / "egg/1-cloud/cloud.ply"));
  std::ofstream(folder / "outside.xyz") << "0 0\n";
  const Result bad = run(call);
  EXPECT_EQ(bad.code, 3);
  EXPECT_NE(bad.err.find("outside.xyz:1"), std::string::npos) << bad.err;
}

TEST_F(Program, SupportSaysHowFarTheNextSampleIs) {
  // A hole of a quarter of the egg around +x.
  write_cloud("hole.ply", [](const double(&x)[6]) {
    std::ostringstream s;
    s.precision(17);
    if (x[0] > .8) return std::string("0 .8 0 0 1 0");  // duplicates of one sample: dropped
    for (const double v : x) s << v << ' ';
    return s.str();
  });
  const Result r = run("run hole.ply -o hole --tets 4000 --json");
  ASSERT_TRUE(r.code == 0 || r.code == 6) << r.err;
  const Json domain = Json::parse(r.out)["certificate"]["domain"];
  EXPECT_GT(domain["unsupported_area_fraction"], .005);
  EXPECT_LT(domain["unsupported_area_fraction"], .2);
  const MeshFile mesh = read_tet_mesh(folder / "hole/3-mesh/mesh.vtu");
  const auto& support = std::get<std::vector<double>>(mesh.point_data.at("support"));
  const auto& boundary = std::get<std::vector<std::uint8_t>>(mesh.point_data.at("boundary"));
  double in_hole = 0, elsewhere = 0;
  for (std::size_t i = 0; i < support.size(); ++i) {
    EXPECT_EQ(support[i] < 0, boundary[i] == 0);
    double& most = mesh.mesh.V[i].x() > .85 ? in_hole : elsewhere;
    most = std::max(most, support[i]);
  }
  EXPECT_GT(in_hole, 2 * elsewhere);
}

TEST_F(Program, MemoryIsAskedForBeforeItIsTaken) {
  const Result r = run("run egg.ply -o egg --detail 4 --max-memory .001");
  EXPECT_EQ(r.code, 9) << r.err;
  EXPECT_NE(r.err.find("GB"), std::string::npos) << r.err;
  EXPECT_FALSE(fs::exists(folder / "egg/2-level-set/level_set.vti"));
}

TEST_F(Program, InspectTellsWhatIsInACloudAndWritesNothing) {
  const auto before = files_of(".");
  const Result text = run("inspect egg.ply");
  ASSERT_EQ(text.code, 0) << text.err;
  EXPECT_NE(text.out.find("600 points"), std::string::npos) << text.out;
  const Json j = Json::parse(run("inspect egg.ply --json").out)["inspection"];
  EXPECT_EQ(j["n_points"], 600);
  EXPECT_TRUE(j["normals"]["present"]);
  EXPECT_TRUE(j["normals"]["outward"]);
  EXPECT_GT(j["normals"]["consistency"], .99);
  EXPECT_LT(j["noise"]["over_spacing"], .05);
  EXPECT_NEAR(j["box"]["diagonal"].get<double>(), 2 * std::hypot(1, .8, .6), .05);
  EXPECT_TRUE(j["trouble"].empty()) << j["trouble"];
  std::ofstream out(folder / "bare.xyz");
  out.precision(17);
  write_cloud("bare.ply", [&](const double(&x)[6]) {
    out << x[0] + 1e7 << ' ' << x[1] << ' ' << x[2] << '\n';
    return std::string();
  });
  out.close();
  const Json bare = Json::parse(run("inspect bare.xyz --json").out)["inspection"];
  EXPECT_FALSE(bare["normals"]["present"]);
  EXPECT_NE(bare["trouble"].dump().find("no normals"), std::string::npos);
  EXPECT_EQ(run("inspect nothing.ply").code, 7);
  EXPECT_EQ(files_of(".").size(), before.size() + 4);  // the two clouds written here, and what run() captures
}

TEST_F(Program, ScaledAndMovedCloudsGiveTheSameMesh) {
  const auto changed = [&](double scale, double shift) {
    return [=](const double(&x)[6]) {
      std::ostringstream s;
      s.precision(17);
      for (int k = 0; k < 6; ++k) s << (k < 3 ? scale * x[k] + (k == 0 ? shift : 0) : x[k]) << ' ';
      return s.str();
    };
  };
  // No tet is near .82 at this h. With 5000 repair has to choose, and rounding decides between choices as good.
  const Result r = run("run egg.ply -o egg --tets 6000 --json");
  ASSERT_EQ(r.code, 0) << r.err;
  const Json c = Json::parse(r.out)["certificate"];
  const Json psi = record(folder / "egg/2-level-set")["numbers"];
  for (const auto& [scale, shift] : {std::pair{1e-6, 0.}, {1e6, 0.}, {1., 1e7}}) {
    write_cloud("other.ply", changed(scale, shift));
    const Result other = run("run other.ply -o other --force --tets 6000 --json");
    ASSERT_EQ(other.code, 0) << scale << ' ' << shift << other.err;
    const Json o = Json::parse(other.out)["certificate"], p = record(folder / "other/2-level-set")["numbers"];
    EXPECT_NEAR(p["rms_value"].get<double>() / scale, psi["rms_value"], 1e-6);
    EXPECT_NEAR(p["spacing"].get<double>() / scale, psi["spacing"], 1e-6);
    EXPECT_EQ(o["n_tets"], c["n_tets"]) << scale << ' ' << shift;
    EXPECT_NEAR(o["volume"].get<double>() / std::pow(scale, 3), c["volume"].get<double>(), 1e-6);
    EXPECT_NEAR(o["quality"]["min"].get<double>(), c["quality"]["min"].get<double>(), 1e-6);
  }
}

}  // namespace
}  // namespace umtet
