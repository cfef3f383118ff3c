// The program on triangles: soups, patches, samples as fine as h, distances to what was given.

#include "reconstruct/io/triangle_mesh_io.h"
#include "tests/pipeline/cli/program_fixture.h"
#include "tests/reconstruct/triangles/solids.h"

namespace umtet {
namespace {

class TrianglesProgram : public Program {
 protected:
  void write_stl(const std::string& name, const TriangleMesh& mesh, const std::string& solid = "part",
                 std::ios::openmode mode = std::ios::out) const {
    std::ofstream out(folder / name, mode);
    out.precision(17);
    out << "solid " << solid << '\n';
    for (std::size_t f = 0; f < mesh.F.size(); ++f) {
      out << "facet normal 0 0 0\nouter loop\n";
      for (int k = 0; k < 3; ++k) out << "vertex " << mesh.corner(f, k).transpose() << '\n';
      out << "endloop\nendfacet\n";
    }
    out << "endsolid\n";
  }
  Json json_in(const std::string& file) const { return Json::parse(content(folder / file)); }
  Json triangles_of(const std::string& name) const {
    return json_in(name + "/1-cloud/record.json")["numbers"]["triangles"];
  }
};

TEST_F(TrianglesProgram, SoupsEndCertifiedWithTheGenusOfTheBody) {
  const TriangleMesh torus = test::torus(64, 32);
  const double jitter = 1e-4 * diagonal_of(torus);
  const TriangleMesh split = test::split(torus, jitter);
  const TriangleMesh box = test::moved(test::cube(), {.8, -.3, -.25}, .5);  // cuts the tube
  const std::map<std::string, TriangleMesh> soups = {{"clean", torus},
                                                     {"turned", test::some_turned(torus, .1)},
                                                     {"removed", test::some_removed(torus, .05)},
                                                     {"split", split},
                                                     {"all", test::some_removed(test::some_turned(split, .1), .05)},
                                                     {"overlap", test::together(torus, box)}};
  for (const auto& [name, soup] : soups) {
    SCOPED_TRACE(name);
    write_stl(name + ".stl", soup);
    const Result r = run("run " + name + ".stl -o " + name + " --h .12 --no-report");
    EXPECT_EQ(r.code, 0) << r.err;
    const Json c = json_in(name + "/certificate.json");
    EXPECT_EQ(c["verdict"], "pass") << c["reasons"];
    EXPECT_EQ(c["boundary"]["genus"], 1);
    EXPECT_EQ(c["boundary"]["components"], 1);
    // The facets of the torus are .005 off it, the middles of flat faces of the mesh h^2 kappa / 8.
    EXPECT_LT(c["triangles"]["rms_distance"], .12 * .05);
    if (name != "overlap") EXPECT_LT(c["triangles"]["max_distance"], .12 * .6);  // over a gap
    EXPECT_LT(c["triangles"]["rms_distance_back"], .12 * (name == "overlap" ? .2 : .05));
    if (name == "turned" || name == "all") EXPECT_NE(r.err.find("face outward"), std::string::npos) << r.err;
    if (name == "overlap") EXPECT_NE(r.err.find("inside the body"), std::string::npos) << r.err;
    if (name == "clean") EXPECT_EQ(triangles_of(name)["n_turned"], 0);
  }
}

TEST_F(TrianglesProgram, SolidsArePatchesOfTheirNames) {
  TriangleMesh torus = test::torus(64, 32), upper = torus, lower = torus;
  upper.F.clear(), lower.F.clear();
  for (std::size_t f = 0; f < torus.F.size(); ++f) (torus.centroid(f).z() > 0 ? upper : lower).F.push_back(torus.F[f]);
  write_stl("two.stl", upper, "top half");
  write_stl("two.stl", lower, "walls", std::ios::app);
  const Result r = run("run two.stl -o two --h .12 --export inp");
  ASSERT_EQ(r.code, 0) << r.err;
  const std::string inp = content(folder / "two/4-export/mesh.inp");
  EXPECT_NE(inp.find("NSET=top_half"), std::string::npos);
  EXPECT_NE(inp.find("NSET=walls_2"), std::string::npos);  // "walls" is a name of ours
  EXPECT_NE(content(folder / "two/report.html").find("top_half"), std::string::npos);
  ASSERT_EQ(run("export two --format inp --label-names 1=lid").code, 0);
  const std::string named = content(folder / "two/4-export/mesh.inp");
  EXPECT_NE(named.find("NSET=lid"), std::string::npos);
  EXPECT_NE(named.find("NSET=walls_2"), std::string::npos);
}

TEST_F(TrianglesProgram, APlyWithFacesIsASurfaceAndAsPointsACloud) {
  std::ofstream ply(folder / "torus.ply", std::ios::binary);
  write_ply(ply, test::torus(64, 32));
  ply.close();
  ASSERT_EQ(run("reconstruct torus.ply -o surface").code, 0);
  ASSERT_EQ(run("reconstruct torus.ply -o cloud --as-points").code, 0);
  EXPECT_TRUE(json_in("surface/1-cloud/record.json")["numbers"].contains("triangles"));
  EXPECT_TRUE(fs::exists(folder / "surface/1-cloud/triangles.ply"));
  const Json numbers = json_in("cloud/1-cloud/record.json")["numbers"];
  EXPECT_FALSE(numbers.contains("triangles"));
  EXPECT_EQ(numbers["n_points"], 64 * 32);
  EXPECT_FALSE(fs::exists(folder / "cloud/1-cloud/triangles.ply"));
  // The other way makes the stage again, and leaves nothing of the former.
  ASSERT_EQ(run("reconstruct torus.ply -o surface --as-points").code, 0);
  EXPECT_FALSE(fs::exists(folder / "surface/1-cloud/triangles.ply"));
}

TEST_F(TrianglesProgram, AFinerMeshHasFinerSamples) {
  write_stl("torus.stl", test::torus(32, 16));
  ASSERT_EQ(run("run torus.stl -o coarse --h .15 --no-report").code, 0);
  ASSERT_EQ(run("run torus.stl -o own --sample-spacing .01 --until cloud").code, 0);
  EXPECT_LE(triangles_of("coarse")["sample_spacing"], .15 / 2.5);
  EXPECT_NEAR(triangles_of("own")["sample_spacing"], .01, 1e-12);
  ASSERT_EQ(run("run torus.stl -o coarse --h .055 --no-report").code, 0);
  EXPECT_NEAR(triangles_of("coarse")["sample_spacing"], .055 / 2.5, 1e-12);
}

TEST_F(TrianglesProgram, InspectSaysWhatWouldBeMended) {
  write_stl("soup.stl", test::some_turned(test::torus(), .1));
  const Result r = run("inspect soup.stl");
  EXPECT_EQ(r.code, 0) << r.err;
  EXPECT_NE(r.out.find("turned"), std::string::npos) << r.out;
  const Json json = Json::parse(run("inspect soup.stl --json").out)["inspection"];
  EXPECT_GT(json["triangles"]["n_turned"], 0);
  EXPECT_EQ(json["triangles"]["n_triangles"], 2 * 48 * 24);
}

TEST_F(TrianglesProgram, WhatBoundsNoBodyIsRefusedWithTheReason) {
  TriangleMesh sheet;
  sheet.V = {{0, 0, 0}, {1, 0, 0}, {1, 1, .1}, {0, 1, 0}};
  sheet.F = {{0, 1, 2}, {0, 2, 3}};
  write_stl("sheet.stl", sheet);
  const Result r = run("run sheet.stl -o sheet --no-report");
  EXPECT_TRUE(r.code == 3 || r.code == 4) << r.code << r.err;
  EXPECT_NE(r.err.find("body"), std::string::npos) << r.err;
}

}  // namespace
}  // namespace umtet
