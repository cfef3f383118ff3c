// The parts of a segmentation.

#include "reconstruct/level_set/label_parts.h"

#include <gtest/gtest.h>

#include "tests/support/label_volumes.h"

using namespace umtet;

TEST(LabelParts, AreListedWithTheirVoxels) {
  const Grid grid = label_volume_of({30, 20, 20}, Vec3(1, 1, 2), [](const Vec3& x) {
    return 70000 * is_in_ball(x - Vec3(-8, 0, 0), 5) + 3 * is_in_ball(x - Vec3(8, 0, 0), 4) + (x.z() > 18 ? 12 : 0);
  });
  const std::vector<LabelPart> parts = label_parts(grid);
  ASSERT_EQ(parts.size(), 3U);
  EXPECT_EQ(parts[0].number, 3);
  EXPECT_EQ(parts[1].number, 12);
  EXPECT_EQ(parts[2].number, 70000);
  std::size_t n = 0;
  for (const double v : grid.values) n += v == 3 ? 1 : 0;
  EXPECT_EQ(parts[0].n_voxels, n);
  EXPECT_FALSE(parts[0].at_wall);
  EXPECT_TRUE(parts[1].at_wall);
  EXPECT_EQ(parts[1].n_voxels, 600U);
}

TEST(LabelParts, ThicknessIsThatOfTheThinnestWay) {
  const Grid plate = label_volume_of({30, 30, 20}, Vec3(.5, .5, 1), [](const Vec3& x) {
    return std::abs(x.z()) < 3.1 && x.head<2>().norm() < 6 ? 1. : 0.;
  });
  const std::vector<LabelPart> parts = label_parts(plate);
  const PartShape shape = part_shape(plate, parts[0]);
  EXPECT_NEAR(shape.thickness_median, 6, 1);
  EXPECT_EQ(shape.pieces_by_points, 1U);
  EXPECT_EQ(shape.pieces_by_faces, 1U);
}
