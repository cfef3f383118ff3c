// The built program, from outside: where two cases part.

#include "tests/pipeline/cli/program_fixture.h"

namespace umtet {
namespace {

class Diff : public Program {
 protected:
  Json diff(const std::string& a, const std::string& b) const {
    const Result answer = run("diff " + a + " " + b + " --json");
    EXPECT_EQ(answer.code, 0) << answer.err;
    return Json::parse(answer.out)["diff"];
  }
};

TEST_F(Diff, NamesTheFirstStageThatDiffersAndByHowMuch) {
  ASSERT_EQ(run("run egg.ply -o a --tets 3000 --no-report").code, 0);
  fs::copy(folder / "a", folder / "b", fs::copy_options::recursive);
  const Json same = diff("a", "b");
  EXPECT_TRUE(same["first_difference"].is_null());

  ASSERT_EQ(run("mesh b --tets 2000 --no-report").code, 0);
  const Json mesh = diff("a", "b");
  EXPECT_EQ(mesh["first_difference"], "mesh");
  const Json& difference = mesh["stages"][2]["difference"];
  EXPECT_FALSE(difference["same_tets"]);
  // Both surfaces are psi = 0: they differ by the flatness of faces, not by an edge.
  const double h = Json::parse(content(folder / "a/certificate.json"))["h"];
  EXPECT_GT(difference["boundary_a_to_b"]["max"].get<double>(), 1e-6);
  EXPECT_LT(difference["boundary_a_to_b"]["max"].get<double>(), .2 * h);
  bool tets = false;
  for (const Json& p : mesh["stages"][2]["parameters"]) tets = tets || (p["at"] == "/tets" && p["b"] == 2000);
  EXPECT_TRUE(tets);

  // The text leaves out what looks alike in three digits, and ends in a picture.
  const Result text = run("diff a b");
  EXPECT_NE(text.out.find("parameter tets: 3000 | 2000"), std::string::npos) << text.out;
  EXPECT_NE(text.out.find("more (-v)"), std::string::npos) << text.out;
  EXPECT_TRUE(text.out.ends_with("picture: b/diff.html\n")) << text.out;
  EXPECT_GT(run("diff a b -v").out.size(), text.out.size());
  EXPECT_GT(fs::file_size(folder / "b/diff.html"), 100'000U);
  EXPECT_EQ(run("diff a b -o other.html").code, 0);
  EXPECT_EQ(content(folder / "other.html"), content(folder / "b/diff.html"));
  EXPECT_TRUE(Json::parse(run("diff a a --json").out)["picture"].is_null());

  ASSERT_EQ(run("reconstruct b --smooth 50").code, 0);
  const Json psi = diff("a", "b");
  EXPECT_EQ(psi["first_difference"], "level-set");
  EXPECT_GT(psi["stages"][1]["difference"]["psi_at_samples_of_a"]["max"].get<double>(), 1e-8);
}

TEST_F(Diff, SaysHowFarASampleHasMoved) {
  // Along x by a hundredth: all of them, so every sample has its next one at most so far.
  write_cloud("moved.ply", [](const double(&x)[6]) {
    std::ostringstream line;
    line.precision(17);
    line << x[0] + .01;
    for (int k = 1; k < 6; ++k) line << ' ' << x[k];
    return line.str();
  });
  ASSERT_EQ(run("run egg.ply -o a --until cloud").code, 0);
  ASSERT_EQ(run("run moved.ply -o b --until cloud").code, 0);
  const Json moved = diff("a", "b");
  EXPECT_EQ(moved["first_difference"], "cloud");
  EXPECT_NEAR(moved["stages"][0]["difference"]["a_to_b"]["max"].get<double>(), .01, 1e-12);
  EXPECT_EQ(run("diff a nowhere").code, 2);
}

}  // namespace
}  // namespace umtet
