// Files of sizes: what is read, and what is refused with its place.

#include "mesh/io/size_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

#include "mesh/io/tet_mesh_io.h"

namespace umtet {
namespace {

namespace fs = std::filesystem;

class SizeFile : public testing::Test {
 protected:
  SizeFile() : folder_(fs::temp_directory_path() / ("umtet_sizes_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
  }
  ~SizeFile() override { fs::remove_all(folder_); }

  fs::path text(const std::string& name, const std::string& content) const {
    std::ofstream(folder_ / name) << content;
    return folder_ / name;
  }
  /// A tet of edges of 1 with these sizes at its corners.
  fs::path tet(const std::string& array, const std::vector<double>& sizes) const {
    MeshFile file;
    file.mesh.V = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    file.mesh.C = {{0, 1, 2, 3}};
    file.point_data[array] = sizes;
    write_vtu(folder_ / "sizes.vtu", file);
    return folder_ / "sizes.vtu";
  }
  static std::string refusal(const fs::path& file) {
    try {
      read_sizes(file);
    } catch (const MeshFileRefused& e) {
      return e.what();
    }
    return "";
  }

  fs::path folder_;
};

TEST_F(SizeFile, IsKnownByItsEnding) {
  for (const char* name : {"a.vtu", "b/c.csv", "d.xyz", "e.txt"}) EXPECT_TRUE(is_size_file(name)) << name;
  for (const char* formula : {"", "x+y", ".1+.2*x", "sqrt(x^2+.01)"}) EXPECT_FALSE(is_size_file(formula)) << formula;
}

TEST_F(SizeFile, HoldsAPointALine) {
  const auto sources = read_sizes(text("a.xyz", "# x y z size\n1 2 3 .5\n\n4,5,6,.25  # here\n7;8;9;1e-2\r\n"));
  ASSERT_EQ(sources.size(), 3u);
  EXPECT_EQ(sources[0].x, Vec3(1, 2, 3));
  EXPECT_EQ(sources[1].h, .25);
  EXPECT_EQ(sources[2].h, .01);
  EXPECT_EQ(sources[2].radius, 0);
}

TEST_F(SizeFile, MayNameItsColumns) {
  const auto sources = read_sizes(text("a.csv", "id,size,z,y,x\n7,.5,3,2,1\n"));
  ASSERT_EQ(sources.size(), 1u);
  EXPECT_EQ(sources[0].x, Vec3(1, 2, 3));
  EXPECT_EQ(sources[0].h, .5);
}

TEST_F(SizeFile, IsRefusedWithTheLine) {
  EXPECT_NE(refusal(text("a.xyz", "1 2 3 .5\n1 2 3\n")).find("line 2"), std::string::npos);
  EXPECT_NE(refusal(text("b.xyz", "1 2 3 0\n")).find("line 1: size 0"), std::string::npos);
  EXPECT_NE(refusal(text("c.csv", "x,y,z\n1,2,3\n")).find("x, y, z and size"), std::string::npos);
  EXPECT_NE(refusal(text("d.csv", "# nothing\n")).find("no point"), std::string::npos);
  EXPECT_THROW(read_sizes(folder_ / "missing.xyz"), std::system_error);
}

TEST_F(SizeFile, OfAMeshHasItsPoints) {
  for (const char* name : {"h", "size"}) {
    const auto sources = read_sizes(tet(name, {2, 3, 4, 5}));
    ASSERT_EQ(sources.size(), 4u);
    EXPECT_EQ(sources[3].x, Vec3(0, 0, 1));
    EXPECT_EQ(sources[3].h, 5);
  }
  EXPECT_NE(refusal(tet("other", {1, 1, 1, 1})).find("size"), std::string::npos);
  EXPECT_NE(refusal(tet("size", {1, -1, 1, 1})).find("point 1"), std::string::npos);
}

TEST_F(SizeFile, OfAMeshIsInterpolatedWhereSizesAreSmallerThanEdges) {
  const auto sources = read_sizes(tet("size", {.5, .5, .5, 1}));
  EXPECT_GT(sources.size(), 4u);
  for (const SizeSource& s : sources) EXPECT_NEAR(s.h, .5 + .5 * s.x.z(), 1e-15);
}

}  // namespace
}  // namespace umtet
