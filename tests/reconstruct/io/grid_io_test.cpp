// Grids in files: the same numbers of every format. What must be refused is in tests/corpus/cases.py.

#include "reconstruct/io/grid_io.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

using namespace umtet;

namespace {

// As VTK and others write them: a ball of radius 2 steps in 7 x 6 x 8 nodes, or the voxels in it.
const std::filesystem::path kFiles = std::filesystem::path(UMTET_SOURCE_DIR) / "tests/corpus/files";

double ball(int i, int j, int k) { return (Vec3(i, j, k) - Vec3(3, 2.5, 3.5)).norm() - 2; }

void expect_ball(const Grid& grid, double tolerance) {
  ASSERT_EQ(grid.n, Eigen::Vector3i(7, 6, 8));
  EXPECT_LT((grid.steps() - Vec3(.1, .1, .2)).norm(), 1e-7);
  for (int k = 0, at = 0; k < 8; ++k) {
    for (int j = 0; j < 6; ++j) {
      for (int i = 0; i < 7; ++i) EXPECT_NEAR(grid.values[at++], ball(i, j, k), tolerance);
    }
  }
}

}  // namespace

TEST(GridIo, EveryFormatHoldsTheSameBall) {
  for (const char* name : {"grid_vti/appended_packed.grid", "grid_vti/inline_packed.grid", "grid_vti/appended_raw.grid",
                           "grid_vti/text.grid", "grid_vtk/binary.vtk", "grid_vtk/text.vtk", "grid_nifti/field.nii",
                           "grid_nrrd/raw.nrrd"}) {
    SCOPED_TRACE(name);
    const Grid grid = read_grid(kFiles / name);
    expect_ball(grid, 1e-5);
    EXPECT_FALSE(grid.is_whole);
  }
}

TEST(GridIo, EveryFormatHoldsTheSameMask) {
  for (const char* name : {"grid_nifti/mask.nii", "grid_nrrd/mask.nrrd"}) {
    const Grid grid = read_grid(kFiles / name);
    EXPECT_TRUE(grid.is_whole) << name;
    for (int at = 0; at < 7 * 6 * 8; ++at) {
      EXPECT_EQ(grid.values[static_cast<std::size_t>(at)] != 0, ball(at % 7, at / 7 % 6, at / 42) < 0) << name;
    }
  }
}

TEST(GridIo, VtkFilesKeepTheirOrigin) {
  for (const char* name : {"grid_vti/appended_raw.grid", "grid_vtk/binary.vtk"}) {
    EXPECT_EQ(read_grid(kFiles / name).origin, Vec3(-1, -1, -1)) << name;
  }
}

TEST(GridIo, MoreNodesThanAllowedAreRefusedBeforeMemoryIsTaken) {
  EXPECT_THROW(read_grid(kFiles / "grid_nrrd/raw.nrrd", 335), GridRefused);
  EXPECT_NO_THROW(read_grid(kFiles / "grid_nrrd/raw.nrrd", 336));
}

TEST(GridIo, AFileThatIsNotThereIsFileTrouble) {
  EXPECT_THROW(read_grid(kFiles / "none.nrrd"), std::system_error);
  EXPECT_THROW(read_grid(kFiles), GridRefused);  // a folder
}

TEST(GridIo, AHeadIsEnoughToTellWhatCannotBeRead) {
  for (const auto& folder : {"grid_vti", "grid_vtk", "grid_nifti", "grid_nrrd"}) {
    for (const auto& file : std::filesystem::directory_iterator(kFiles / folder)) {
      EXPECT_NO_THROW(check_grid_head(file.path()));
      EXPECT_THROW(check_grid_head(file.path(), 300), GridRefused);
    }
  }
  EXPECT_THROW(check_grid_head(kFiles / "cloud_xyz/six.xyz"), GridRefused);
}
