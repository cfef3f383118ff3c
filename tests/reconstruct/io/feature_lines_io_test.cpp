#include "reconstruct/io/feature_lines_io.h"

#include <gtest/gtest.h>

#include <fstream>

#include "reconstruct/io/triangle_mesh_io.h"
#include "tests/reconstruct/triangles/solids.h"

namespace umtet {
namespace {

namespace fs = std::filesystem;

const char* const kFeat = R"(feat 2
# the square
3
.3 .3 1
.7 .3 1
.7 .7 1

3
.7 .7 1
.3 .7 1
.3 .3 1
)";

const char* const kEMesh = R"(/*--------*- C++ -*--------*\
| a banner |
\*--------------------------*/
FoamFile
{
    version 2.0;
    format  ascii;
    class   featureEdgeMesh;
    location "constant/triSurface";
    object  part.eMesh; // the edges
}
4
(
(.3 .3 1) (.7 .3 1)
(.7 .7 1)
(.3 .7 1)
)
4((0 1)(1 2)(2 3)(3 0))
)";

const char* const kObj = R"(# vertices of its own
v .3 .3 1
v 9 9 9
v .7 .3 1
v .7 .7 1
v .3 .7 1
l 1 3 4/2 5
l -1 -5
)";

class FeatureLinesIo : public ::testing::Test {
 protected:
  void SetUp() override { fs::create_directories(folder_); }
  void TearDown() override { fs::remove_all(folder_); }
  fs::path file(const std::string& name, const std::string& content) const {
    std::ofstream(folder_ / name) << content;
    return folder_ / name;
  }
  /// The message of a refusal; empty if the lines are accepted for the cube with a square.
  std::string refusal(const std::string& name, const std::string& content) const {
    const fs::path path = file(name, content);
    TriangleMesh mesh = test::cube_with_imprint();
    try {
      add_lines(mesh, read_feature_lines(path), path);
    } catch (const CloudRefused& e) {
      const std::string what = e.what();
      EXPECT_EQ(what.rfind(path.string() + ": ", 0), 0u) << what;
      return what;
    }
    return {};
  }
  const fs::path folder_ = fs::temp_directory_path() / ("feature_lines_" + std::to_string(::getpid()));
};

TEST_F(FeatureLinesIo, AllFormatsGiveTheSameEdges) {
  const std::vector<std::array<int, 2>> wanted = {{8, 9}, {8, 11}, {9, 10}, {10, 11}};
  const std::string extended =
      std::string(kEMesh).replace(std::string(kEMesh).find("featureEdgeMesh"), 15, "extendedFeatureEdgeMesh") +
      "0 0 0 0 0 (1 2 3)";
  for (const auto& [name, text] : std::vector<std::pair<std::string, std::string>>{
           {"a.feat", kFeat}, {"a.eMesh", kEMesh}, {"a.obj", kObj}, {"b.eMesh", extended}, {"any.txt", kFeat}}) {
    SCOPED_TRACE(name);
    TriangleMesh mesh = test::cube_with_imprint();
    const fs::path path = file(name, text);
    EXPECT_EQ(add_lines(mesh, read_feature_lines(path), path), 4u);
    EXPECT_EQ(mesh.lines, wanted);
  }
}

TEST_F(FeatureLinesIo, FilesCutShortAnywhereAreRefusedOrHaveFewerLines) {
  for (const auto& [name, text] :
       std::vector<std::pair<std::string, std::string>>{{"a.feat", kFeat}, {"a.eMesh", kEMesh}, {"a.obj", kObj}}) {
    std::size_t n_refused = 0;
    for (std::size_t n = 0; n < text.size(); n += 3) {
      const std::string what = refusal(name, text.substr(0, n));
      n_refused += what.empty() ? 0 : 1;
      EXPECT_EQ(what.find('\n'), std::string::npos) << what;
    }
    // Statements of OBJ have no count, so its end may be missing.
    EXPECT_GE(n_refused, (name == "a.obj" ? text.find("l 1") : text.size() - 3) / 3);
  }
}

TEST_F(FeatureLinesIo, RefusalsNameTheLineAndWhatIsWrong) {
  const auto with = [](const char* text, const std::string& from, const std::string& to) {
    std::string changed = text;
    return changed.replace(changed.find(from), from.size(), to);
  };
  const struct {
    std::string name, text, words;
  } wrong[] = {
      {"a.feat", with(kFeat, "feat 2", "feat 3"), "line 11: the file ends before polyline 3 of 3"},
      {"a.feat", with(kFeat, "feat 2", "feat 1"), "line 8: the file goes on after its 1 polylines"},
      {"a.feat", with(kFeat, "feat 2", "feat 99999999999999999999"), "line 1: '99999999999999999999' is no number"},
      {"a.feat", with(kFeat, "\n3\n", "\n4\n"), "line 8: 1 values instead of x y z"},
      {"a.feat", with(kFeat, "\n3\n", "\n-3\n"), "line 3: '-3' is no number of points"},
      {"a.feat", with(kFeat, ".7 .3 1", ".7 nan 1"), "line 5: a coordinate is NaN"},
      {"a.feat", with(kFeat, ".7 .3 1", ".7 x 1"), "line 5: 'x' is not a number"},
      {"a.feat", with(kFeat, ".7 .3 1", ".7 .3 2"), "line 5: the point 0.7 0.3 2 is 1 from the triangles"},
      {"a.feat", with(kFeat, ".7 .3 1\n", "1 0 0\n"), "line 4: no edge of the triangles runs along"},
      {"a.feat", "feat 1\n1\n.3 .3 1\n", "no line of two points or more"},
      {"a.eMesh", with(kEMesh, "4\n(", "5\n("), "line 17: ')' instead of '(' at item 5 of 5 of the points"},
      {"a.eMesh", with(kEMesh, "4((0", "3((0"), "line 18: '(' instead of ')' at the end of the list of edges"},
      {"a.eMesh", with(kEMesh, "(3 0)", "(3 4)"), "line 18: '4' is no point, of 4"},
      {"a.eMesh", with(kEMesh, "ascii", "binary"), "line 7: format 'binary': only ascii is read"},
      {"a.eMesh", with(kEMesh, "featureEdgeMesh", "vectorField"), "line 8: class 'vectorField' has no edges"},
      {"a.eMesh", std::string(kEMesh) + "7", "line 19: '7' after the list of edges"},
      {"a.obj", with(kObj, "l -1 -5", "l -1 -6"), "line 8: '-6' counts back beyond the first"},
      {"a.obj", with(kObj, "l 1 3", "l 1 7"), "line 7: there is no vertex 7, of 5"},
      {"a.obj", with(kObj, "l 1 3", "l 1 2"), "line 7: the point 9 9 9 is"},
      {"a.obj", with(kObj, "l -1 -5", "l 3"), "line 8: 1 points behind 'l'"},
      {"a.txt", "edges\n", "it begins like none of .feat"},
      {"a.txt", "", "the file is empty"}};
  for (const auto& [name, text, words] : wrong) {
    const std::string what = refusal(name, text);
    EXPECT_NE(what.find(words), std::string::npos) << words << ": " << what;
  }
}

TEST_F(FeatureLinesIo, LinesOfAnObjAreKeptAndThoseElsewhereCounted) {
  std::ofstream out(folder_ / "cube.obj");
  const TriangleMesh mesh = test::cube_with_imprint();
  for (const Vec3& x : mesh.V) out << "v " << x.transpose() << '\n';
  for (const Triangle& f : mesh.F) out << "f " << f[0] + 1 << ' ' << f[1] + 1 << ' ' << f[2] + 1 << '\n';
  out << "l 9 10 11 12 9\nl 1 8\nl x\nl 1 99\n";
  out.close();
  const TriangleFile read = read_triangles(folder_ / "cube.obj");
  EXPECT_EQ(read.report.n_lines, 4u);
  EXPECT_EQ(read.report.n_lines_ignored, 1u);
  // They go through a PLY.
  std::ofstream ply(folder_ / "cube.ply", std::ios::binary);
  write_ply(ply, read.mesh);
  ply.close();
  const TriangleFile again = read_triangles(folder_ / "cube.ply");
  EXPECT_EQ(again.mesh.lines, read.mesh.lines);
  EXPECT_EQ(again.mesh.F, read.mesh.F);
  EXPECT_EQ(again.report.n_lines_ignored, 0u);
}

}  // namespace
}  // namespace umtet
