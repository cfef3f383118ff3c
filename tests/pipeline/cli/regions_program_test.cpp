// `umtet regions`: several bodies in one mesh.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include "mesh/io/tet_mesh_io.h"
#include "tests/pipeline/cli/program_fixture.h"
#include "tests/support/tet_shapes.h"

namespace umtet {
namespace {

using RegionsProgram = Program;

const std::string kBox = " --box=-2,-2,-2,2,2,2";

/// An image of 24^3 voxels with f(i, j, k) around its middle.
template <class F>
void write_labels(const fs::path& file, const F& f) {
  std::ofstream out(file, std::ios::binary);
  out << "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 24 24 24\nspacings: 1 1 1\nencoding: raw\n\n";
  for (int k = 0; k < 24; ++k)
    for (int j = 0; j < 24; ++j)
      for (int i = 0; i < 24; ++i) out.put(static_cast<char>(f(Vec3(i - 11.5, j - 11.5, k - 11.5))));
}

/// A ball in two halves.
int two_halves(const Vec3& x) { return x.norm() > 8 ? 0 : x.dot(Vec3(.3, .1, 1)) < 0 ? 1 : 4; }

TEST_F(RegionsProgram, NestedBodiesAndTheBoxAreOneMesh) {
  const fs::path out = folder / "nested";
  const Result r = run("regions shell='x^2+y^2+z^2-1' core='x^2+y^2+z^2-.3'" + kBox + " -o " + out.string());
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_NE(r.out.find("verdict: pass"), std::string::npos);
  const MeshFile mesh = read_tet_mesh(out / "regions.vtu");
  const auto& region = std::get<std::vector<std::int64_t>>(mesh.cell_data.at("region"));
  for (const std::int64_t k : {0, 1, 2}) EXPECT_NE(std::find(region.begin(), region.end(), k), region.end());
  const Json json = Json::parse(content(out / "regions.json"));
  EXPECT_EQ(json["verdict"], "pass");
  EXPECT_EQ(json["regions"][2]["name"], "core");
  EXPECT_NEAR(json["regions"][2]["volume"], 4.18879 * .164317, .05 * .688);
  EXPECT_NEAR(json["volume"], 64, 1e-9);
  EXPECT_EQ(json["interfaces"].size(), 2U);
}

TEST_F(RegionsProgram, TheOutsideCanBeLeftOut) {
  const fs::path out = folder / "alone";
  const Result r = run("regions a='(x-.4)^2+y^2+z^2-.7' b='(x+.4)^2+y^2+z^2-.7' --no-outside --tets 30000" + kBox +
                       " -o " + out.string());
  ASSERT_EQ(r.code, 0) << r.err;
  const Json json = Json::parse(content(out / "regions.json"));
  EXPECT_EQ(json["regions"].size(), 2U);
  EXPECT_NEAR(json["n_tets"], 30000, 6000);
}

TEST_F(RegionsProgram, AScanIsFittedOnceAndJudgedByItsSamples) {
  const fs::path out = folder / "egg_and_core";
  const std::string words = "regions egg='" + cloud.string() + "' core='x^2+y^2+z^2-.09' -o " + out.string();
  const Result r = run(words + " --tets 150000");
  ASSERT_EQ(r.code, 0) << r.err << r.out;
  EXPECT_NE(r.out.find("fits the samples"), std::string::npos);
  const Json json = Json::parse(content(out / "regions.json"));
  EXPECT_EQ(json["samples"][0]["region"], "egg");
  EXPECT_EQ(json["samples"][0]["missed"], 0);
  const double egg = json["regions"][1]["volume"], core = json["regions"][2]["volume"];
  EXPECT_NEAR(egg + core, 4.18879 * .48, .04 * 4.18879 * .48);
  const fs::path level_set = out / "bodies/egg/2-level-set/level_set.vti";
  const auto before = fs::last_write_time(level_set);
  ASSERT_EQ(run(words + " --tets 100000").code, 0);
  EXPECT_EQ(fs::last_write_time(level_set), before);
}

TEST_F(RegionsProgram, LabelsOfAnImageAreRegions) {
  write_labels(folder / "ball.nrrd", two_halves);
  const fs::path out = folder / "ball";
  const Result r =
      run("regions " + (folder / "ball.nrrd").string() + " --label-names 4=upper --tets 150000 -o " + out.string());
  ASSERT_EQ(r.code, 0) << r.err << r.out;
  EXPECT_NE(r.out.find("fits the voxels"), std::string::npos);
  const Json json = Json::parse(content(out / "regions.json"));
  EXPECT_EQ(json["regions"][1]["name"], "label1");
  EXPECT_EQ(json["regions"][2]["name"], "upper");
  EXPECT_EQ(json["voxels"][1]["label"], 4);
  for (const Json& v : json["voxels"])
    EXPECT_NEAR(v["volume"].get<double>(), v["volume_of_voxels"].get<double>(), .02 * v["volume"].get<double>());
  EXPECT_EQ(json["interfaces"].size(), 3U);
  EXPECT_TRUE(json["defects"].empty());
  EXPECT_GE(json["quality"]["min"], .65);
}

TEST_F(RegionsProgram, AVoxelThatIsTooSmallForHIsNamed) {
  write_labels(folder / "speck.nrrd", [](const Vec3& x) {
    return (x - Vec3(9.5, 9.5, 9.5)).norm() < .6 ? 2 : two_halves(x) == 0 ? 0 : 1;
  });
  const fs::path out = folder / "speck";
  const Result r = run("regions " + (folder / "speck.nrrd").string() + " --h 2 -o " + out.string());
  EXPECT_EQ(r.code, 6) << r.err << r.out;
  const Json json = Json::parse(content(out / "regions.json"));
  EXPECT_EQ(json["verdict"], "fail");
  EXPECT_NEAR(json["voxels"][0]["volume"], json["voxels"][0]["volume_of_voxels"], 60);
  EXPECT_FALSE(json["reasons"].empty());
}

TEST_F(RegionsProgram, SidesOfAPeriodMatch) {
  const fs::path out = folder / "cell";
  const std::string ball = "-1.2-cos(6.283185307179586*x)-cos(6.283185307179586*y)-cos(6.283185307179586*z)";
  const Result r = run("regions --periodic holes='" + ball + "' --box=0,0,0,1,1,1 --tets 40000 -o " + out.string());
  ASSERT_EQ(r.code, 0) << r.err << r.out;
  EXPECT_NE(r.out.find("opposite sides"), std::string::npos);
  const Json json = Json::parse(content(out / "regions.json"));
  EXPECT_EQ(json["periodic"]["farthest"], 0);
  EXPECT_EQ(json["periodic"]["faces_unmatched"], 0);
  EXPECT_NEAR(json["volume"], 1, 1e-9);
  const std::string pairs = content(out / "periodic.csv");
  EXPECT_EQ(pairs.find("vertex,copy,x,y,z"), 0U);
  EXPECT_EQ(std::count(pairs.begin(), pairs.end(), '\n'), json["periodic"]["pairs"].get<int>() + 1);
  ASSERT_EQ(run("regions a='x^2+y^2+z^2-1'" + kBox + " --tets 30000 -o " + out.string()).code, 0);
  EXPECT_FALSE(fs::exists(out / "periodic.csv"));
}

TEST_F(RegionsProgram, AFoamBelongsToTheLeastFunction) {
  const fs::path out = folder / "bubbles";
  const Result r =
      run("regions --least a='(x-.5)^2+y^2+z^2-1' b='(x+.5)^2+y^2+z^2-1'" + kBox + " --tets 150000 -o " + out.string());
  ASSERT_EQ(r.code, 0) << r.err << r.out;
  const Json json = Json::parse(content(out / "regions.json"));
  const double a = json["regions"][1]["volume"], b = json["regions"][2]["volume"];
  EXPECT_NEAR(a, b, .01 * a);
}

TEST_F(RegionsProgram, ExportsHaveARegionEachAndAreCheckedByRegion) {
  const fs::path out = folder / "nested";
  const Result r = run("regions shell='x^2+y^2+z^2-1' core='x^2+y^2+z^2-.3'" + kBox + " --tets 60000 -o nested");
  ASSERT_EQ(r.code, 0) << r.err;
  const Json made = Json::parse(content(out / "regions.json"));
  ASSERT_EQ(run("export nested --format vtu,msh,msh22,mesh,inp,bdf,feb,cdb,xdmf,stl,pvtu").code, 0);
  EXPECT_TRUE(fs::exists(out / "4-export/mesh.shell+core.stl"));
  for (const char* file : {"regions.vtu", "4-export/mesh.vtu", "4-export/mesh.msh", "4-export/mesh_22.msh",
                           "4-export/mesh.mesh", "4-export/mesh.inp"}) {
    const Result checked = run("check --json " + (out / file).string());
    ASSERT_EQ(checked.code, 0) << checked.err;
    const Json check = Json::parse(checked.out)["check"];
    ASSERT_EQ(check["regions"].size(), 3U) << file;
    EXPECT_EQ(check["unshared_faces"], 0) << file;
    const bool has_names = std::string(file) != "4-export/mesh.mesh";
    for (const char* name : {"outside", "shell", "core"}) {
      const auto same = [&](const char* wanted, const Json& list) {
        return *std::find_if(list.begin(), list.end(), [&](const Json& region) { return region["name"] == wanted; });
      };
      const std::string number = std::string(name) == "outside" ? "3" : std::string(name) == "shell" ? "1" : "2";
      const Json found = same(has_names ? name : number.c_str(), check["regions"]),
                 wanted = same(name, made["regions"]);
      EXPECT_EQ(found["n_tets"], wanted["n_tets"]) << file;
      EXPECT_EQ(found["pieces"], wanted["pieces"]) << file;
      EXPECT_EQ(found["boundary"]["euler_characteristic"], wanted["boundary"]["euler_characteristic"]) << file;
      const double volume = wanted["volume"];
      EXPECT_NEAR(found["volume"], volume, 1e-9 * volume) << file;
      EXPECT_NEAR(found["quality"]["min"], wanted["quality"]["min"], 1e-6) << file;
    }
    EXPECT_EQ(check["interfaces"].size(), 2U) << file;
    if (has_names) {
      EXPECT_EQ(check["interfaces"][1]["name"], "shell|core") << file;
    }
  }
  const Result text = run("check nested/4-export/mesh.msh");
  EXPECT_NE(text.out.find("interface shell|core"), std::string::npos) << text.out;
  // Another mesh removes the exports of this one.
  ASSERT_EQ(run("regions ball='x^2+y^2+z^2-1'" + kBox + " --tets 30000 -o nested --export msh").code, 0);
  EXPECT_FALSE(fs::exists(out / "4-export/mesh.inp"));
  EXPECT_TRUE(fs::exists(out / "4-export/mesh.msh"));
  EXPECT_EQ(run("export nested --format pmsh").code, 2);
  EXPECT_EQ(run("export nested --format msh --patch-angle 40").code, 2);
}

TEST_F(RegionsProgram, RegionsThatDoNotShareTheirVerticesFail) {
  // Two cubes of tets that touch in a square, as two parts whose nodes were not merged.
  TetMesh two = testing::cubes(1, [](int, int, int) { return true; });
  const TetMesh one = two;
  const auto n = static_cast<int>(one.V.size());
  for (const Vec3& x : one.V) two.V.emplace_back(2 - x[0], x[1], x[2]);
  for (const Tet& t : one.C) two.C.push_back({t[0] + n, t[1] + n, t[3] + n, t[2] + n});
  std::vector<std::int64_t> region(two.C.size(), 1);
  std::fill(region.begin() + static_cast<std::ptrdiff_t>(one.C.size()), region.end(), 2);
  write_vtu(folder / "two.vtu", MeshFile{two, {}, {{"region", region}}});
  const Result r = run("check two.vtu");
  EXPECT_EQ(r.code, 6) << r.out;
  EXPECT_NE(r.out.find("4 boundary faces lie on another one"), std::string::npos) << r.out;
}

TEST_F(RegionsProgram, BadCallsNameTheRemedy) {
  const std::string out = " -o " + (folder / "bad").string();
  const auto refused = [&](const std::string& words, int code, const std::string& text) {
    const Result r = run("regions " + words);
    EXPECT_EQ(r.code, code) << words;
    EXPECT_NE(r.err.find(text), std::string::npos) << r.err;
    EXPECT_FALSE(fs::exists(folder / "bad"));
  };
  refused("a" + kBox + out, 2, "NAME=FORMULA");
  refused("a.nrrd" + out, 2, "image of labels");
  refused(cloud.string() + out, 3, "egg");
  write_labels(folder / "empty.nrrd", [](const Vec3&) { return 0; });
  refused((folder / "empty.nrrd").string() + out, 2, "all voxels are 0");
  write_labels(folder / "ball.nrrd", two_halves);
  refused((folder / "ball.nrrd").string() + " --label-names 2=bone" + out, 2, "no voxel has the label 2");
  write_labels(folder / "many.nrrd", [](const Vec3& x) {  // 216 blocks
    const Vec3 block = ((x + Vec3::Constant(11.5)) / 4).array().floor();
    return static_cast<int>(1 + block[0] + 6 * block[1] + 36 * block[2]);
  });
  refused((folder / "many.nrrd").string() + out, 2, "at most 63 regions");
  refused("2=x^2-1" + kBox + out, 2, "2");
  refused("a='x^2+y^2+z^2-1' a='x^2+y^2+z^2-1'" + kBox + out, 2, "another region");
  refused("outside='x^2+y^2+z^2-1'" + kBox + out, 2, "another region");
  refused("a='x^2+y^2+z^2-1' A='x^2+y^2+z^2-1'" + kBox + out, 2, "another region");
  refused("walls='x^2+y^2+z^2-1'" + kBox + out, 2, "boundary");
  refused("a='x^2+y^2+z^2-1' --export msg" + kBox + out, 2, "msh");
  refused("a='x^2+y^2+z^2-1' --export pmsh" + kBox + out, 2, "one body");
  refused("a='x^2+y^2+z^2-1'" + out, 2, "--box");
  refused("a='x^2+y^2+z^2-1'" + kBox, 2, "-o");
  refused("a='max(x,y)'" + kBox + out, 2, "C2");
  refused("a='x^2+y^2+z^2-9'" + kBox + out, 5, "box");
  refused("--periodic a='x^2+y^2+z^2-1'" + kBox + out, 2, "does not repeat");
  refused("--periodic a='sin(x)'" + out, 2, "--box");
  refused("a='x^2+y^2+z^2+9'" + kBox + out, 5, "region");
}

}  // namespace
}  // namespace umtet
