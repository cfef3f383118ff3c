// `umtet regions`: several bodies in one mesh.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "mesh/io/tet_mesh_io.h"
#include "tests/pipeline/cli/program_fixture.h"

namespace umtet {
namespace {

using RegionsProgram = Program;

const std::string kBox = " --box=-2,-2,-2,2,2,2";

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

TEST_F(RegionsProgram, BadCallsNameTheRemedy) {
  const std::string out = " -o " + (folder / "bad").string();
  const auto refused = [&](const std::string& words, int code, const std::string& text) {
    const Result r = run("regions " + words);
    EXPECT_EQ(r.code, code) << words;
    EXPECT_NE(r.err.find(text), std::string::npos) << r.err;
    EXPECT_FALSE(fs::exists(folder / "bad"));
  };
  refused("a" + kBox + out, 2, "NAME=FORMULA");
  refused("2=x^2-1" + kBox + out, 2, "2");
  refused("a='x^2+y^2+z^2-1' a='x^2+y^2+z^2-1'" + kBox + out, 2, "another region");
  refused("outside='x^2+y^2+z^2-1'" + kBox + out, 2, "another region");
  refused("a='x^2+y^2+z^2-1'" + out, 2, "--box");
  refused("a='x^2+y^2+z^2-1'" + kBox, 2, "-o");
  refused("a='max(x,y)'" + kBox + out, 2, "C2");
  refused("a='x^2+y^2+z^2-9'" + kBox + out, 5, "box");
  refused("a='x^2+y^2+z^2+9'" + kBox + out, 5, "region");
}

}  // namespace
}  // namespace umtet
