// The built program, from outside: what a case keeps of former calls, and what is told of it.

#include "reconstruct/io/triangle_mesh_io.h"
#include "tests/pipeline/cli/program_fixture.h"
#include "tests/reconstruct/triangles/solids.h"

namespace umtet {
namespace {

class ProgramParameters : public Program {
 protected:
  static bool says(const Result& r, const std::string& line) {
    return ("\n" + r.err).find("\n" + line + "\n") != std::string::npos;
  }
  static bool mentions(const Result& r, const std::string& text) { return r.err.find(text) != std::string::npos; }
  Json certificate(const std::string& name) const { return Json::parse(content(folder / name / "certificate.json")); }
};

TEST_F(ProgramParameters, WhatACaseKeepsAndWhatACallChangesIsSaidLineByLine) {
  const Result first = run("run egg.ply -o egg --tets 3000 --units mm --set mesh.samples=7");
  ASSERT_EQ(first.code, 0) << first.err;
  EXPECT_FALSE(mentions(first, "case: ")) << first.err;  // there was no case

  const Result again = run("run egg --json");
  EXPECT_EQ(again.code, 0);
  EXPECT_TRUE(says(again, "case: keeps --tets 3000 (--fresh drops it)")) << again.err;
  EXPECT_TRUE(says(again, "case: keeps --units mm (--fresh drops it)")) << again.err;
  EXPECT_TRUE(says(again, "case: keeps --set mesh.samples=7 (--fresh drops it)")) << again.err;
  EXPECT_EQ(Json::parse(again.out)["kept"], Json::array({"--tets 3000", "--set mesh.samples=7", "--units mm"}));
  EXPECT_EQ(Json::parse(again.out)["changed"].size(), 0u);
  EXPECT_TRUE(mentions(again, "nothing to do"));

  const Result typed = run("run egg.ply -o egg --tets 3000 --units mm --set mesh.samples=7");
  EXPECT_FALSE(mentions(typed, "case: ")) << typed.err;  // all of it is said by the call

  const Result other = run("run egg --tets 2500 --units m --json");
  EXPECT_EQ(other.code, 0) << other.err;
  EXPECT_TRUE(says(other, "case: mesh.tets was 3000, is 2500")) << other.err;
  EXPECT_TRUE(says(other, "case: output.units was \"mm\", is \"m\"")) << other.err;
  EXPECT_TRUE(says(other, "mesh: made again with other parameters")) << other.err;
  EXPECT_FALSE(mentions(other, "keeps --tets"));
  EXPECT_EQ(Json::parse(other.out)["changed"].size(), 2u);

  // A call with the cloud keeps nothing: all that was there is told of as changed.
  const Result cloud_again = run("run egg.ply -o egg --h .25");
  EXPECT_EQ(cloud_again.code, 0) << cloud_again.err;
  EXPECT_TRUE(says(cloud_again, "case: mesh.tets was 2500, is 0")) << cloud_again.err;
  EXPECT_TRUE(says(cloud_again, "case: mesh.samples was 7, is 20")) << cloud_again.err;
  EXPECT_TRUE(says(cloud_again, "case: output.units was \"m\", is \"\"")) << cloud_again.err;
  EXPECT_FALSE(mentions(cloud_again, "keeps")) << cloud_again.err;
}

TEST_F(ProgramParameters, WhereAValueCameFromStaysInCaseToml) {
  ASSERT_EQ(run("run egg.ply -o egg --tets 3000").code, 0);
  const std::string toml = content(folder / "egg/case.toml");
  EXPECT_NE(toml.find("tets = 3000  # --tets"), std::string::npos);
  EXPECT_EQ(run("run egg").code, 0);
  EXPECT_EQ(content(folder / "egg/case.toml"), toml);
}

TEST_F(ProgramParameters, StagesThatAreNotRunKeepTheirsAndSayWhy) {
  ASSERT_EQ(run("run egg.ply -o egg --tets 3000 --smooth 2").code, 0);
  const Result mesh = run("mesh egg --tets 2500");
  EXPECT_TRUE(says(mesh, "case: keeps --smooth 2 (the stage level-set is not run)")) << mesh.err;
}

TEST_F(ProgramParameters, FreshDropsParametersAndKeepsResults) {
  const Result gate = run("run egg.ply -o egg --tets 3000 --min-quality .99");
  ASSERT_EQ(gate.code, 6);
  EXPECT_EQ(run("run egg").code, 6);  // judged as before
  const Result fresh = run("run egg --fresh --tets 3000 --json");
  EXPECT_EQ(fresh.code, 0) << fresh.err;
  EXPECT_EQ(Json::parse(fresh.out)["stages_run"], Json::array());  // the mesh matches
  EXPECT_TRUE(says(fresh, "case: output.min_quality was 0.99, is 0.0")) << fresh.err;
  EXPECT_EQ(run("run egg").code, 0);  // and stays so
  // A formula and its box are what the case is of.
  ASSERT_EQ(run(ball + "--set mesh.seed=5").code, 0);
  const std::string box = "case: keeps --box -1.3,-1.3,-1.3,1.3,1.3,1.3";
  EXPECT_TRUE(says(run("mesh ball"), box));  // which --fresh does not drop
  const Result other = run("mesh ball --fresh --tets 2000");
  EXPECT_EQ(other.code, 0) << other.err;
  EXPECT_TRUE(says(other, box)) << other.err;
  EXPECT_TRUE(mentions(other, "case: mesh.seed was 5, is ")) << other.err;
}

TEST_F(ProgramParameters, WhatIsAcceptedIsSaidWithTheVerdict) {
  const std::string in_force = "in force: --accept folded,off:0.2\n";
  const Result first = run("run egg.ply -o egg --tets 3000 --accept folded,off:0.2");
  EXPECT_EQ(first.code, 0) << first.err;
  EXPECT_NE(first.out.find(in_force), std::string::npos) << first.out;
  const Result again = run("run egg");
  EXPECT_NE(again.out.find(in_force), std::string::npos) << again.out;
  EXPECT_TRUE(says(again, "case: keeps --accept folded,off:0.2 (--fresh drops it)")) << again.err;
  EXPECT_EQ(certificate("egg")["gates"]["accept"], "folded,off:0.2");
  const Result fresh = run("run egg --fresh --tets 3000");
  EXPECT_EQ(fresh.out.find("in force"), std::string::npos) << fresh.out;
  EXPECT_EQ(certificate("egg")["gates"]["accept"], "");
}

TEST_F(ProgramParameters, AMeshOfAFormerLevelSetIsNotHandedOut) {
  ASSERT_EQ(run("run egg.ply -o egg --tets 3000").code, 0);
  ASSERT_EQ(run("reconstruct egg --smooth 10").code, 0);
  const auto before = files_of("egg");
  for (const char* call : {"export egg --format inp", "report egg", "view egg"}) {
    const Result r = run(call);
    EXPECT_EQ(r.code, 2) << call << r.err;
    EXPECT_TRUE(mentions(r, "the stage level-set has been made again since")) << call << r.err;
    EXPECT_TRUE(mentions(r, "`umtet run egg`")) << call << r.err;
  }
  EXPECT_EQ(files_of("egg"), before);
  ASSERT_EQ(run("run egg").code, 0);
  for (const char* call : {"export egg --format inp", "report egg", "view egg"}) EXPECT_EQ(run(call).code, 0) << call;
  // The same level set again is no change.
  ASSERT_EQ(run("reconstruct egg --force").code, 0);
  EXPECT_EQ(run("export egg --format inp").code, 0);
}

TEST_F(ProgramParameters, AMeshOfAFormerSizeFileIsNotHandedOut) {
  std::ofstream(folder / "sizes.csv") << "x,y,z,size\n1,0,0,.2\n-1,0,0,.5\n0,1,0,.5\n0,0,1,.5\n";
  const std::string graded =
      "mesh --implicit 'x^2+y^2+z^2-1' --box -1.3,-1.3,-1.3,1.3,1.3,1.3 --size sizes.csv --h .5 ";
  const Result made = run(graded + "-o graded");
  ASSERT_EQ(made.code, 0) << made.err;
  EXPECT_EQ(run("export graded --format inp").code, 0);
  std::ofstream(folder / "sizes.csv") << "x,y,z,size\n1,0,0,.25\n-1,0,0,.5\n0,1,0,.5\n0,0,1,.5\n";
  const Result r = run("export graded --format inp");
  EXPECT_EQ(r.code, 2) << r.err;
  EXPECT_TRUE(mentions(r, "sizes.csv has changed since")) << r.err;
}

TEST_F(ProgramParameters, APatchFlagThatIsTypedWinsOverAnotherThatIsKept) {
  ASSERT_EQ(run(ball + "--patch-planar 5 --export inp").code, 0);
  const Result kept = run("export ball --format inp");
  EXPECT_TRUE(says(kept, "export: keeps --patch-planar 5 (--fresh drops it)")) << kept.err;
  EXPECT_TRUE(mentions(kept, "no part of the boundary is flat")) << kept.err;
  const Result angle = run("export ball --format inp --patch-angle 60");
  EXPECT_EQ(angle.code, 0);
  EXPECT_TRUE(says(angle, "export: output.patch_planar was 5.0, is 0.0")) << angle.err;
  EXPECT_FALSE(mentions(angle, "flat")) << angle.err;
  const Result fresh = run("export ball --format inp --fresh");
  EXPECT_FALSE(mentions(fresh, "flat") || mentions(fresh, "keeps")) << fresh.err;
  const Result run_again = run("mesh ball --patch-angle 60");
  EXPECT_TRUE(says(run_again, "case: output.patch_planar was 5.0, is 0.0")) << run_again.err;
}

TEST_F(ProgramParameters, SamplesForAnHGoWithIt) {
  std::ofstream out(folder / "cube.stl");
  const TriangleMesh cube = test::cube();
  out << "solid cube\n";
  for (std::size_t f = 0; f < cube.F.size(); ++f) {
    out << "facet normal 0 0 0\nouter loop\n";
    for (int k = 0; k < 3; ++k) out << "vertex " << cube.corner(f, k).transpose() << '\n';
    out << "endloop\nendfacet\n";
  }
  out << "endsolid\n";
  out.close();
  const auto spacing = [&] {
    return Json::parse(content(folder / "cube/1-cloud/record.json"))["parameters"]["sample_spacing"].get<double>();
  };
  run("run cube.stl -o cube --h .2 --no-report");
  EXPECT_NEAR(spacing(), .08, 1e-12);
  const Result kept = run("run cube --no-report");
  EXPECT_FALSE(mentions(kept, "sample-spacing")) << kept.err;  // nobody has given it
  EXPECT_NEAR(spacing(), .08, 1e-12);
  run("run cube --h 0 --tets 3000 --no-report");
  EXPECT_EQ(spacing(), 0);
}

}  // namespace
}  // namespace umtet
