// What is too thin, --max-deviation and --max-tets, from outside.

#include "tests/pipeline/cli/program_fixture.h"

namespace umtet {
namespace {

// Half axes 1, 1 and .12: too thin for h = .3.
const std::string kLens = "mesh --implicit 'x^2+y^2+(z/0.12)^2-1' --box=-1.6,-1.6,-.9,1.6,1.6,.9 -o lens ";

TEST_F(Program, WhatIsTooThinForAGivenHIsAMeshThatFailsAndNamesThePlace) {
  const Result r = run(kLens + "--h .3 --json");
  EXPECT_EQ(r.code, 6) << r.err;
  const Json c = Json::parse(r.out)["certificate"];
  EXPECT_EQ(c["verdict"], "fail");
  EXPECT_EQ(c["boundary"]["embedded"], true);
  EXPECT_EQ(c["valid"], true);
  EXPECT_EQ(c["fits_psi"], false);
  EXPECT_EQ(c["fits_input"], false);
  EXPECT_NE(c["reasons"].dump().find("lacks what is thin"), std::string::npos) << c["reasons"];
  EXPECT_EQ(c["blame"]["stage"], "h") << c["blame"];
  EXPECT_EQ(c["blame"]["remedy"].get<std::string>().find("--h "), 0u) << c["blame"];
  ASSERT_EQ(c["resolution"]["too_thin"].size(), 1u);
  const Json& place = c["resolution"]["too_thin"][0];
  EXPECT_EQ(place["kind"], "body");
  EXPECT_NEAR(place["centre"][0].get<double>(), 0, .1);
  EXPECT_LT(place["h_needed"], .2);
  EXPECT_GT(fs::file_size(folder / "lens/3-mesh/too_thin.vtp"), 0u);
  EXPECT_GT(fs::file_size(folder / "lens/3-mesh/mesh.vtu"), 0u);
  EXPECT_FALSE(fs::exists(folder / "lens/3-mesh/failed"));
  // A lens has a rim thinner than any h, which comes out right.
  EXPECT_TRUE(fs::exists(folder / "lens/3-mesh/defects.vtp"));
  const Result fine = run(kLens + "--json --h .05");
  EXPECT_EQ(fine.code, 0) << fine.err;
  EXPECT_FALSE(fs::exists(folder / "lens/3-mesh/defects.vtp"));
}

TEST_F(Program, ThinPlacesThatComeOutRightAreNamedInTheCertificate) {
  // The rim is thinner than 1.25 h.
  const Result r = run("mesh --implicit 'x^2+y^2+(z/0.25)^2-1' --box=-1.6,-1.6,-.9,1.6,1.6,.9 -o lens --h .3 --json");
  EXPECT_EQ(r.code, 0) << r.err;
  const Json places = Json::parse(r.out)["certificate"]["resolution"]["too_thin"];
  ASSERT_FALSE(places.empty());
  EXPECT_LT(places[0]["h_needed"], .3);
  EXPECT_GT(fs::file_size(folder / "lens/3-mesh/too_thin.vtp"), 0u);
  EXPECT_NE(content(folder / "lens/3-mesh/record.json").find("too_thin.vtp"), std::string::npos);
  EXPECT_NE(run("mesh lens -v").out.find("thinner than h can show"), std::string::npos);
}

TEST_F(Program, AMeshThatLacksWhatIsThinIsNotRight) {
  // A ball with a fin .05 thick, an eighth of h, that ends 2.5 h outside: no vertex falls into it.
  const std::string fin =
      "mesh --implicit '-log(exp(-20*(x^2+y^2+z^2-1))+exp(-20*((x-1)^4+(y/.5)^4+((z-.2)/.025)^4-1)))' ";
  const Result r = run(fin + "--box=-2.6,-2.6,-2.6,2.6,2.6,2.6 --h .4 -o fin --json");
  EXPECT_EQ(r.code, 6) << r.err;
  EXPECT_NE(r.out.find("the mesh lacks what is thin at"), std::string::npos) << r.out;
}

TEST_F(Program, AMeshFarFromTheSamplesIsNotRight) {
  // The bird is 4 wide, its wings 2 long.
  const Result r = run("run " + std::string(UMTET_SOURCE_DIR) + "/data/clouds/bird.ply --h 1.2 -o bird --json");
  EXPECT_EQ(r.code, 6) << r.err;
  const std::string reasons = Json::parse(r.out)["certificate"]["reasons"].dump();
  EXPECT_NE(reasons.find("samples that are farther than h from the mesh"), std::string::npos) << reasons;
}

TEST_F(Program, AnAutomaticHGoesAsLowAsMaxTetsAllows) {
  const std::string disc = "mesh --implicit 'x^2+y^2+(z/0.08)^2-1' --box=-1.2,-1.2,-.3,1.2,1.2,.3 -o disc --json ";
  const Result r = run(disc + "--max-tets 300");
  EXPECT_EQ(r.code, 6) << r.err;
  const Json c = Json::parse(r.out)["certificate"];
  EXPECT_EQ(c["boundary"]["embedded"], true);
  EXPECT_FALSE(c["resolution"]["too_thin"].empty());
}

TEST_F(Program, MaxDeviationIsKeptAndNotMuchFinerThanNeeded) {
  const struct {
    const char *formula, *box, *deviation;
  } cases[] = {{"x^2+y^2+z^2-1", "-1.3,-1.3,-1.3,1.3,1.3,1.3", ".004"},
               {"x^2+y^2/.64+z^2/.36-1", "-1.3,-1.3,-1.3,1.3,1.3,1.3", ".006"},
               {"(x^2+y^2+z^2+.84)^2-4*(x^2+y^2)", "-1.6,-1.6,-.6,1.6,1.6,.6", ".008"}};
  for (const auto& [formula, box, deviation] : cases) {
    const Result r = run("mesh --implicit '" + std::string(formula) + "' --box=" + box + " --max-deviation " +
                         deviation + " -o a --json");
    ASSERT_EQ(r.code, 0) << formula << r.err;
    const Json c = Json::parse(r.out)["certificate"];
    const double made = c["boundary"]["max_centroid_distance_over_h"].get<double>() * c["h"].get<double>();
    EXPECT_LE(made, std::stod(deviation)) << formula;
    // Lengths scale with the root of this: h is less than twice as fine as it could be.
    EXPECT_GE(made, std::stod(deviation) / 3.5) << formula;
  }
}

TEST_F(Program, ADeviationThatCannotBeKeptIsNoPass) {
  // h is as small as 3000 tets allow, and that is too coarse.
  const std::string ball_box = "mesh --implicit 'x^2+y^2+z^2-1' --box=-1.3,-1.3,-1.3,1.3,1.3,1.3 -o a ";
  const Result r = run(ball_box + "--max-deviation 1e-4 --max-tets 3000");
  EXPECT_EQ(r.code, 9) << r.err;
  EXPECT_NE(r.err.find("raise --max-tets"), std::string::npos) << r.err;
  EXPECT_FALSE(fs::exists(folder / "a"));
}

TEST_F(Program, TheWaysToChooseHExcludeEachOther) {
  const std::pair<const char*, const char*> cases[] = {{"--max-deviation .1 --h .1", "mutually exclusive"},
                                                       {"--max-deviation .1 --tets 100", "mutually exclusive"},
                                                       {"--max-deviation -1", "must be in"},
                                                       {"--max-deviation nan", "must be in"},
                                                       {"--max-deviation 1mm", "not a number"},
                                                       {"--max-deviations 1", "did you mean --max-deviation?"},
                                                       {"--max-tets 0", "must be in"},
                                                       {"--max-tets 1.5", "not a whole number"}};
  for (const auto& [flags, message] : cases) {
    const Result r = run("run egg.ply -o a --json " + std::string(flags));
    EXPECT_EQ(r.code, 2) << flags;
    EXPECT_NE(r.err.find(message), std::string::npos) << flags << "\n" << r.err;
    EXPECT_EQ(Json::parse(r.out)["exit_code"], 2);
  }
  EXPECT_FALSE(fs::exists(folder / "a"));
  // A case that was made with one of them takes another: the flag is the stronger voice.
  ASSERT_EQ(run("run egg.ply -o egg --tets 3000").code, 0);
  const Result r = run("mesh egg --max-deviation .01 --json");
  ASSERT_EQ(r.code, 0) << r.err;
  EXPECT_TRUE(Json::parse(r.out)["certificate"]["n_tets_asked"].is_null());
  EXPECT_NE(content(folder / "egg/case.toml").find("max_deviation = 0.01  # --max-deviation"), std::string::npos);
  EXPECT_NE(content(folder / "egg/case.toml").find("tets = 0  # default"), std::string::npos);
}

}  // namespace
}  // namespace umtet
