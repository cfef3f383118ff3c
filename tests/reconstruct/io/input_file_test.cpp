#include "reconstruct/io/input_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <string>
#include <system_error>

#include "reconstruct/io/grid_io.h"
#include "reconstruct/io/point_cloud_io.h"
#include "reconstruct/io/triangle_mesh_io.h"
#include "tests/reconstruct/triangles/solids.h"
#include "tests/support/clouds.h"

namespace umtet {
namespace {
namespace fs = std::filesystem;

struct OpenFile : testing::Test {
  OpenFile() { fs::create_directories(folder); }
  ~OpenFile() override { fs::remove_all(folder); }
  template <class Content>
  fs::path written(const char* name, const Content& content) const {
    std::ofstream out(folder / name, std::ios::binary);
    write_ply(out, content);
    return folder / name;
  }
  const fs::path folder = fs::temp_directory_path() / ("umtet_input_" + std::to_string(::getpid()));
};

// The names are gone, so no reader can open the file again. The first file is larger than its head.
TEST_F(OpenFile, IsReadAsManyTimesAsNeeded) {
  const OrientedPointCloud cloud = test::torus_cloud(30000);
  const fs::path file = written("cloud.ply", cloud);
  const InputFile input(file);
  ASSERT_GT(fs::file_size(file), input.head().size());
  fs::remove(file);
  EXPECT_FALSE(is_grid_file(input));
  EXPECT_FALSE(holds_triangles(input));
  EXPECT_NO_THROW(check_scan_head(input));
  for (int k = 0; k < 2; ++k) EXPECT_EQ(read_scan(input).cloud.points, cloud.points);
  EXPECT_THROW(check_scan_head(input, "x,y,z"), CloudRefused);

  const TriangleMesh torus = test::torus();
  const fs::path surface = written("torus.ply", torus);
  const InputFile triangles(surface);
  fs::remove(surface);
  EXPECT_FALSE(is_grid_file(triangles));
  EXPECT_TRUE(holds_triangles(triangles));
  EXPECT_NO_THROW(check_triangles_head(triangles));
  for (int k = 0; k < 2; ++k) EXPECT_EQ(read_triangles(triangles).mesh.F, torus.F);
  EXPECT_EQ(read_scan(triangles).cloud.points.size(), torus.V.size());
}

TEST_F(OpenFile, IsAGridByItsFirstBytes) {
  const fs::path file = folder / "grid.any";
  std::ofstream(file) << "NRRD0004\n";
  const InputFile input(file);
  fs::remove(file);
  for (int k = 0; k < 2; ++k) EXPECT_TRUE(is_grid_file(input));
}

TEST_F(OpenFile, KeepsTheStateAtOpening) {
  const fs::path file = folder / "text";
  std::ofstream(file) << "12345";
  const InputFile input(file);
  EXPECT_EQ(input.head(), "12345");
  EXPECT_EQ(input.path(), file);
  std::ofstream(file, std::ios::app) << "678";
  EXPECT_EQ(input.status().st_size, 5);
  std::string rest(10, ' ');
  rest.resize(input.read(3, rest.data(), rest.size()));
  EXPECT_EQ(rest, "45678");
}

TEST_F(OpenFile, NamesTheFileThatCannotBeOpened) {
  for (const fs::path& file : {folder, folder / "none"}) {
    try {
      const InputFile input(file);
      ADD_FAILURE() << file;
    } catch (const std::system_error& e) {
      EXPECT_NE(std::string(e.what()).find(file.string()), std::string::npos) << e.what();
    }
  }
}

}  // namespace
}  // namespace umtet
