#include "reconstruct/patches/segment_cloud.h"

#include <gtest/gtest.h>
#include <oneapi/tbb/global_control.h>

#include <map>
#include <set>

#include "reconstruct/cloud/neighbours/cloud_neighbours.h"
#include "reconstruct/cloud/normals/normal_estimation.h"
#include "reconstruct/cloud/normals/normal_orientation.h"
#include "tests/reconstruct/patches/part_clouds.h"

namespace umtet {
namespace {

using test::add_noise, test::Part, test::part_named, test::PartCloud, test::sample_part;

constexpr int kSamples = 4000;

struct Noise {
  double position, degrees;
};
const std::vector<Noise> kLittle = {{.001, 5}, {.0025, 10}};

/// The patches of a cloud as its users find them.
SamplePatches segmented(const PartCloud& cloud, bool measured = true) {
  OrientedPointCloud input{cloud.points, cloud.normals};
  SegmentationParams params;
  params.measured_normals = measured;
  if (!measured) {
    input.normals = estimate_normals(input.points).normals;
    orient_normals(input);
  }
  const double spacing = sample_spacing(neighbour_distances(input.points, kAreaNeighbours));
  return segment_cloud(input.points, input.normals, spacing, params);
}

int n_sharp(const SamplePatches& found) {
  return static_cast<int>(
      std::count_if(found.borders.begin(), found.borders.end(), [](const auto& b) { return b.sharp; }));
}

/// The patch that found most samples of each true face, each patch for one face.
std::map<int, int> matched(const PartCloud& cloud, const SamplePatches& found) {
  std::map<std::pair<int, int>, int> together;
  for (std::size_t i = 0; i < cloud.patch.size(); ++i) ++together[{cloud.patch[i], found.patch[i]}];
  std::vector<std::pair<int, std::pair<int, int>>> by_number;
  for (const auto& [pair, n] : together) by_number.emplace_back(-n, pair);
  std::sort(by_number.begin(), by_number.end());
  std::map<int, int> patch_of;
  std::set<int> taken;
  for (const auto& [n, pair] : by_number)
    if (!patch_of.count(pair.first) && taken.insert(pair.second).second) patch_of[pair.first] = pair.second;
  return patch_of;
}

/// Share of the samples farther than a spacing from edges that are not on the patch of their face.
double wrong_away_from_edges(const PartCloud& cloud, const SamplePatches& found) {
  std::map<int, int> patch_of = matched(cloud, found);
  std::vector<Vec3> edges;
  for (const auto& place : cloud.edges) edges.push_back(place.x);
  const NeighbourTree tree(edges);
  double n = 0, wrong = 0;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    if (tree.count_within(cloud.points[i], cloud.spacing * cloud.spacing, 1) > 0) continue;
    ++n;
    if (!patch_of.count(cloud.patch[i]) || patch_of[cloud.patch[i]] != found.patch[i]) ++wrong;
  }
  return wrong / n;
}

/// Share of the edges' places where two patches with a sharp border meet, and they are those of the two faces.
double found_edges(const PartCloud& cloud, const SamplePatches& found) {
  std::map<int, int> patch_of = matched(cloud, found);
  std::set<std::pair<int, int>> sharp;
  for (const auto& border : found.borders)
    if (border.sharp) sharp.insert({border.a, border.b});
  double n = 0;
  for (const auto& place : cloud.edges)
    if (patch_of.count(place.a) && patch_of.count(place.b) &&
        sharp.count(std::minmax(patch_of[place.a], patch_of[place.b])))
      ++n;
  return n / static_cast<double>(cloud.edges.size());
}

std::size_t n_faces(const PartCloud& cloud) { return std::set<int>(cloud.patch.begin(), cloud.patch.end()).size(); }

void expect_the_patches_of(const std::string& name, const Noise& noise, bool measured = true,
                           double most_wrong = .001) {
  PartCloud cloud = sample_part(part_named(name), kSamples, 1, true);
  add_noise(cloud, noise.position, noise.degrees, 2);
  const SamplePatches found = segmented(cloud, measured);
  const std::string what = name + " with noise " + std::to_string(noise.position);
  EXPECT_EQ(static_cast<std::size_t>(found.count), n_faces(cloud)) << what;
  EXPECT_LE(wrong_away_from_edges(cloud, found), most_wrong) << what;
  EXPECT_EQ(found_edges(cloud, found), 1) << what;
  for (const auto& border : found.borders) EXPECT_TRUE(border.sharp || border.length < 3 * found.spacing) << what;
}

/// One test per part, so that each takes less than a second.
class SegmentPart : public ::testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Parts, SegmentPart,
                         ::testing::Values("cube", "L", "cube-ball", "balls", "cylinder", "lens", "bracket", "fan"),
                         [](const auto& info) { return info.param == "cube-ball" ? "cube_ball" : info.param; });

TEST_P(SegmentPart, HasOnePatchPerFace) { expect_the_patches_of(GetParam(), {0, 0}); }

TEST_P(SegmentPart, HasThemWithLittleNoise) {
  for (const Noise& noise : kLittle) expect_the_patches_of(GetParam(), noise);
}

TEST_P(SegmentPart, HasThemWithMuchNoise) { expect_the_patches_of(GetParam(), {.005, 20}, true, .002); }

TEST_P(SegmentPart, HasThemByPositionsAlone) {
  for (const double noise : {0., .001}) expect_the_patches_of(GetParam(), {noise, 0}, false);
}

TEST(SegmentCloud, NormalsThatAreAveragedAtEdgesHideNone) {
  PartCloud cloud = sample_part(part_named("cube-ball"), kSamples, 1);
  add_noise(cloud, .0005, 0, 1);
  const std::vector<Vec3> exact = cloud.normals;
  NeighbourTree(cloud.points).for_each_neighbourhood(12, [&](std::uint32_t i, std::span<const Neighbour> near) {
    Vec3 sum = Vec3::Zero();
    for (const Neighbour& other : near) sum += exact[other.point];
    cloud.normals[i] = sum.normalized();
  });
  const SamplePatches found = segmented(cloud);
  EXPECT_EQ(found.count, 7);
  EXPECT_EQ(n_sharp(found), 15);
}

TEST(SegmentCloud, BordersHaveAngleAndLengthOfTheEdges) {
  const SamplePatches found = segmented(sample_part(part_named("cube"), kSamples, 3));
  ASSERT_EQ(n_sharp(found), 12);
  for (const auto& border : found.borders) {
    EXPECT_NEAR(border.angle, std::numbers::pi / 2, .01);
    EXPECT_NEAR(border.length, 2, .3);
  }
}

TEST(SegmentCloud, NormalsAreThoseOfTheFaces) {
  PartCloud cloud = sample_part(part_named("cube-ball"), kSamples, 1);
  const std::vector<Vec3> exact = cloud.normals;
  add_noise(cloud, .001, 10, 1);
  const SamplePatches found = segmented(cloud);
  double sum = 0;
  for (std::size_t i = 0; i < exact.size(); ++i) sum += (found.normals[i] - exact[i]).squaredNorm();
  EXPECT_LT(std::sqrt(sum / static_cast<double>(exact.size())), 3 * std::numbers::pi / 180);
  EXPECT_NEAR(found.noise, .001 * cloud.diagonal, .0002 * cloud.diagonal);
}

void expect_no_edge(const Part& part, const std::string& what) {
  for (const bool measured : {true, false}) {
    for (const Noise& noise : {Noise{0, 0}, kLittle[0], kLittle[1]}) {
      if (!measured && noise.position > .001) continue;
      PartCloud cloud = sample_part(part, kSamples, 1);
      add_noise(cloud, noise.position, noise.degrees, 2);
      const SamplePatches found = segmented(cloud, measured);
      EXPECT_EQ(found.count, 1) << what << ", noise " << noise.position << (measured ? "" : ", no normals");
      EXPECT_EQ(n_sharp(found), 0) << what;
    }
  }
}

TEST(SegmentCloud, ASphereHasNoEdge) {
  expect_no_edge({"sphere", {test::sphere_face(Vec3::Zero(), 1)}, [](const Vec3& x) { return x.norm() < 1; }},
                 "sphere");
}

TEST(SegmentCloud, ATorusHasNoEdge) {
  for (const double tube : {.1, .3}) expect_no_edge(test::torus(tube), "torus with a tube of " + std::to_string(tube));
}

TEST(SegmentCloud, AFilletOfOneSpacingIsNoEdge) {
  expect_no_edge(test::rounded_cube(std::sqrt(24. / kSamples)), "fillet of one spacing");
}

TEST(SegmentCloud, AFilletOfThreeSpacingsIsNoEdge) {
  expect_no_edge(test::rounded_cube(3 * std::sqrt(24. / kSamples)), "fillet of three spacings");
}

TEST(SegmentCloud, ABlobHasNoEdge) { expect_no_edge(test::blob(), "blob"); }

TEST(SegmentCloud, NeitherUnitNorPositionNorThreadsMatter) {
  PartCloud cloud = sample_part(part_named("bracket"), kSamples, 1);
  add_noise(cloud, .0025, 10, 1);
  const SamplePatches found = segmented(cloud);
  PartCloud moved = cloud;
  for (Vec3& x : moved.points) x = 1e-6 * (x + Vec3(7, 8, 9));
  EXPECT_EQ(segmented(moved).patch, found.patch);
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  const SamplePatches alone = segmented(cloud);
  EXPECT_EQ(alone.patch, found.patch);
  EXPECT_EQ(alone.normals, found.normals);
}

TEST(SegmentCloud, OddInputIsOnePatch) {
  EXPECT_EQ(segment_cloud({}, {}, 1).count, 0);
  EXPECT_EQ(segment_cloud({Vec3::Zero()}, {Vec3::UnitZ()}, 1).count, 1);
  const std::vector<Vec3> same(200, Vec3::Ones());
  EXPECT_EQ(segment_cloud(same, std::vector<Vec3>(200, Vec3::UnitX()), 1).count, 1);
  EXPECT_EQ(segment_cloud(same, std::vector<Vec3>(200, Vec3::Zero()), 1).count, 1);
}

TEST(SegmentCloud, RefusesWhatItCannotUse) {
  const std::vector<Vec3> one = {Vec3::Zero()};
  EXPECT_THROW(segment_cloud(one, {}, 1), std::invalid_argument);
  EXPECT_THROW(segment_cloud(one, one, 0), std::invalid_argument);
  EXPECT_THROW(segment_cloud(one, one, std::nan("")), std::invalid_argument);
  EXPECT_THROW(segment_cloud(one, one, 1, {10, true}), std::invalid_argument);
}

}  // namespace
}  // namespace umtet
