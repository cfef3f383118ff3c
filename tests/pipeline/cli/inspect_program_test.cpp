// What `umtet inspect` foretells of a run, beside the run.

#include "tests/pipeline/cli/program_fixture.h"

namespace umtet {
namespace {

class InspectProgram : public Program {
 protected:
  /// n points of an ellipsoid with half axes 1, 1 and `thin`, evenly by the angle.
  void write_lens(const std::string& name, int n, double thin, bool normals) const {
    std::ofstream out(folder / name);
    out.precision(17);
    for (int i = 0; i < n; ++i) {
      const double z = 1 - (2 * i + 1) / static_cast<double>(n), r = std::sqrt(1 - z * z), a = 2.399963229728653 * i;
      const double u[3] = {r * std::cos(a), r * std::sin(a), z}, m[3] = {u[0], u[1], u[2] / thin};
      const double l = std::hypot(m[0], m[1], m[2]);
      out << u[0] << ' ' << u[1] << ' ' << thin * u[2];
      if (normals) out << ' ' << m[0] / l << ' ' << m[1] / l << ' ' << m[2] / l;
      out << '\n';
    }
  }
  Json foretold(const std::string& call) const {
    const Result r = run("inspect " + call + " --json");
    EXPECT_EQ(r.code, 0) << r.err;
    return Json::parse(r.out)["inspection"]["prediction"];
  }
};

TEST_F(InspectProgram, TetsAreThoseOfTheRunToAFactorOfTwo) {
  write_lens("thick.xyz", 3000, .7, true);
  write_lens("thin.xyz", 6000, .06, true);
  write_lens("bare.xyz", 3000, .3, false);  // without normals
  for (const std::string name : {"thick", "thin", "bare"}) {
    SCOPED_TRACE(name);
    const Json before = foretold(name + ".xyz");
    const Result r = run("run " + name + ".xyz -o " + name + " --no-report --json");
    ASSERT_TRUE(r.code == 0 || r.code == 6) << r.err;
    const Json c = Json::parse(r.out)["certificate"];
    const double ratio = before["expected"]["n_tets"].get<double>() / c["n_tets"].get<double>();
    EXPECT_GT(ratio, .5);
    EXPECT_LT(ratio, 2);
    EXPECT_EQ(before["graded"], c.contains("sizes"));
    EXPECT_FALSE(before.contains("obstacle"));
  }
}

TEST_F(InspectProgram, WhatTheRunIsAskedForDecides) {
  write_lens("thick.xyz", 3000, .7, true);
  EXPECT_NEAR(foretold("thick.xyz --tets 10000")["expected"]["n_tets"], 10000, 10);
  EXPECT_EQ(foretold("thick.xyz --h .1")["h"], .1);
  EXPECT_LE(foretold("thick.xyz --max-tets 20000")["most"]["n_tets"], 21000);
}

TEST_F(InspectProgram, ARunThatWillEndWithoutAMeshIsForetoldWithItsReason) {
  std::ofstream out(folder / "ball.xyz");  // points that fill a volume
  unsigned state = 1;
  const auto random = [&] {
    state = state * 1664525u + 1013904223u;
    return state / 4294967296.;
  };
  for (int i = 0; i < 4000; ++i) out << random() << ' ' << random() << ' ' << random() << '\n';
  out.close();
  const Json before = foretold("ball.xyz");
  ASSERT_TRUE(before.contains("obstacle")) << before;
  EXPECT_GT(before["expected"]["n_tets"], 0);
  EXPECT_NE(run("inspect ball.xyz").out.find("likely to end without a mesh: "), std::string::npos);
  const Result r = run("run ball.xyz -o ball --no-report", "timeout 60");
  EXPECT_TRUE(r.code == 3 || r.code == 4 || r.code == 5) << r.code << r.err;
}

}  // namespace
}  // namespace umtet
