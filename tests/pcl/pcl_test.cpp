// umtet::pcl: clouds of PCL in, meshes out. The only file of the tests that includes PCL.

#include <gtest/gtest.h>
#include <umtet/pcl.h>

#include <map>

namespace umtet {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// A point of the unit sphere, on a spiral of n.
Eigen::Vector3f on_sphere(int i, int n) {
  const double z = 1 - (2 * i + 1.) / n, r = std::sqrt(1 - z * z), a = 2.399963229728653 * i;
  return Eigen::Vector3d(r * std::cos(a), r * std::sin(a), z).cast<float>();
}

template <class PointT>
pcl::PointCloud<PointT> sphere(int n) {
  pcl::PointCloud<PointT> cloud;
  for (int i = 0; i < n; ++i) {
    PointT p;
    p.getVector3fMap() = on_sphere(i, n);
    if constexpr (pcl::traits::has_normal<PointT>::value) p.getNormalVector3fMap() = on_sphere(i, n);
    cloud.push_back(p);
  }
  return cloud;
}

/// The points of a sphere in six views, each with those that are nearest to its sensor; without normals.
ScannedCloud six_views(float distance) {
  ScannedCloud scan;
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-1.f, 1.f}) {
      pcl::PointCloud<pcl::PointXYZ> view;
      for (const pcl::PointXYZ& p : sphere<pcl::PointXYZ>(3000)) {
        int nearest = 0;
        p.getVector3fMap().cwiseAbs().maxCoeff(&nearest);
        if (nearest == axis && p.data[axis] * side > 0) view.push_back(p);
      }
      view.sensor_origin_[axis] = side * distance;
      scan += from_pcl(view);
    }
  }
  return scan;
}

template <class Error, class F>
std::string message_of(const F& f) {
  try {
    f();
  } catch (const Error& e) {
    return e.what();
  }
  ADD_FAILURE() << "nothing of that type was thrown";
  return {};
}

TEST(Pcl, PointsAndNormalsComeBackBitByBit) {
  const pcl::PointCloud<pcl::PointNormal> cloud = sphere<pcl::PointNormal>(100);
  const ScannedCloud ours = from_pcl(cloud);
  ASSERT_EQ(ours.points.size(), 100u);
  ASSERT_EQ(ours.normals.size(), 100u);
  EXPECT_TRUE(ours.viewpoints.empty());
  const auto back = to_pcl<pcl::PointXYZRGBNormal>(ours);
  ASSERT_EQ(back.size(), cloud.size());
  EXPECT_EQ(back.width * back.height, cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    EXPECT_EQ(back[i].getVector3fMap(), cloud[i].getVector3fMap());
    EXPECT_EQ(back[i].getNormalVector3fMap(), cloud[i].getNormalVector3fMap());
  }
  EXPECT_TRUE(from_pcl(to_pcl<pcl::PointXYZ>(ours)).normals.empty());
}

TEST(Pcl, PointsThatAreNotFiniteAreCounted) {
  auto cloud = sphere<pcl::PointNormal>(100);
  cloud[3].y = kNaN;
  cloud[50].x = std::numeric_limits<float>::infinity();
  cloud[70].normal_x = kNaN;  // a normal is missing, which is no reason to lose the point
  const ScannedCloud ours = from_pcl(cloud);
  EXPECT_EQ(ours.points.size(), 98u);
  EXPECT_EQ(ours.normals.size(), 98u);
  EXPECT_EQ(ours.n_not_finite, 2u);
}

TEST(Pcl, ASensorThatNobodyHasSetIsUnknown) {
  auto cloud = sphere<pcl::PointXYZ>(10);
  EXPECT_TRUE(from_pcl(cloud).viewpoints.empty());
  cloud.sensor_orientation_ = Eigen::Quaternionf(0, 1, 0, 0);  // turned, so somebody has
  EXPECT_EQ(from_pcl(cloud).viewpoints.size(), 10u);
  cloud.sensor_origin_ = {1, 2, 3, 0};
  EXPECT_EQ(from_pcl(cloud).viewpoints.back(), (std::array<double, 3>{1, 2, 3}));
  EXPECT_EQ(from_pcl(cloud, Eigen::Vector3f(4, 5, 6)).viewpoints.front(), (std::array<double, 3>{4, 5, 6}));
}

TEST(Pcl, JoinedViewsKeepWhatEachHas) {
  ScannedCloud joined = from_pcl(sphere<pcl::PointXYZ>(10), Eigen::Vector3f(1, 2, 3));
  joined += from_pcl(sphere<pcl::PointNormal>(20));
  EXPECT_EQ(joined.points.size(), 30u);
  ASSERT_EQ(joined.normals.size(), 30u);
  EXPECT_TRUE(std::isnan(joined.normals[9][0]));
  EXPECT_EQ(joined.normals[10], joined.points[10]);
  ASSERT_EQ(joined.viewpoints.size(), 30u);
  EXPECT_EQ(joined.viewpoints[9][2], 3);
  EXPECT_TRUE(std::isnan(joined.viewpoints[10][0]));
}

TEST(Pcl, ViewpointsSayWhichSideIsOutside) {
  const CloudMesh mesh = mesh_cloud(six_views(3));
  EXPECT_TRUE(mesh.passes) << mesh.certificate;
  ASSERT_EQ(mesh.samples.points.size(), mesh.samples.normals.size());
  for (std::size_t i = 0; i < mesh.samples.points.size(); ++i) {
    const Eigen::Vector3d x(mesh.samples.points[i].data()), n(mesh.samples.normals[i].data());
    EXPECT_GT(n.dot(x), .9);
  }
  // Sensors in the hollow of a block: what is around the samples has no bounds.
  EXPECT_NE(message_of<CloudMeshError>([] { mesh_cloud(six_views(.1f)); }), "");
}

TEST(Pcl, ABallIsMeshedWithItsCertificate) {
  CloudMeshOptions options;
  options.h = .15;
  int n_calls = 0;
  options.progress = [&](const char*, double) { return ++n_calls > 0; };
  const CloudMesh mesh = mesh_cloud(from_pcl(sphere<pcl::PointNormal>(3000)), options);
  EXPECT_TRUE(mesh.is_valid && mesh.fits_psi && mesh.fits_input && mesh.passes);
  EXPECT_EQ(mesh.h, .15);
  EXPECT_GT(mesh.min_quality, .5);
  EXPECT_GT(n_calls, 2);
  EXPECT_NE(mesh.certificate.find("\"verdict\": \"pass\""), std::string::npos);
  double volume = 0;
  for (const std::array<int, 4>& t : mesh.tets) {
    std::array<Eigen::Vector3d, 4> x;
    for (int k = 0; k < 4; ++k) x[k] = Eigen::Vector3d(mesh.points[t[k]].data());
    volume += (x[1] - x[0]).cross(x[2] - x[0]).dot(x[3] - x[0]) / 6;
  }
  EXPECT_NEAR(volume, 4.18879, .05);
  options.threads = 1;
  EXPECT_EQ(mesh_cloud(from_pcl(sphere<pcl::PointNormal>(3000)), options).points, mesh.points);
}

TEST(Pcl, TheBoundaryIsAClosedPolygonMeshWithNormals) {
  const CloudMesh mesh = mesh_cloud(from_pcl(sphere<pcl::PointNormal>(3000)), {.15});
  const pcl::PolygonMesh boundary = to_polygon_mesh(mesh);
  pcl::PointCloud<pcl::PointNormal> vertices;
  pcl::fromPCLPointCloud2(boundary.cloud, vertices);
  ASSERT_EQ(vertices.size(), mesh.boundary_vertices.size());
  for (const pcl::PointNormal& p : vertices) {
    EXPECT_NEAR(p.getVector3fMap().norm(), 1, .01);
    EXPECT_GT(p.getNormalVector3fMap().dot(p.getVector3fMap().normalized()), .99);
  }
  std::map<std::pair<int, int>, int> edges;
  for (const pcl::Vertices& polygon : boundary.polygons) {
    ASSERT_EQ(polygon.vertices.size(), 3u);
    for (int k = 0; k < 3; ++k) ++edges[{polygon.vertices[k], polygon.vertices[(k + 1) % 3]}];
  }
  for (const auto& [edge, n] : edges) {
    EXPECT_EQ(n, 1);
    EXPECT_EQ(edges.count({edge.second, edge.first}), 1u);
  }
}

TEST(Pcl, WhatCannotBeDoneIsSaidWithoutFlagsOfTheProgram) {
  const ScannedCloud ball = from_pcl(sphere<pcl::PointNormal>(1000));
  CloudMeshOptions options;
  options.set = {{"mesh.hh", ".1"}};
  EXPECT_NE(message_of<std::invalid_argument>([&] { mesh_cloud(ball, options); }).find("mesh.hh"), std::string::npos);
  ScannedCloud broken = ball;
  broken.points[7][1] = kNaN;
  EXPECT_NE(message_of<std::invalid_argument>([&] { mesh_cloud(broken); }).find("points[7]"), std::string::npos);
  broken = ball;
  broken.normals.pop_back();
  EXPECT_NE(message_of<std::invalid_argument>([&] { mesh_cloud(broken); }).find("normals"), std::string::npos);
  const std::string few = message_of<CloudMeshError>([] { mesh_cloud(from_pcl(sphere<pcl::PointXYZ>(5))); });
  EXPECT_EQ(few.find("--"), std::string::npos) << few;
  EXPECT_NE(few.find("cloud.keep_all"), std::string::npos) << few;
  options.set.clear();
  options.progress = [](const char*, double) { return false; };
  try {
    mesh_cloud(ball, options);
    FAIL() << "not ended";
  } catch (const CloudMeshError& e) {
    EXPECT_NE(e.evidence.find("Cancelled"), std::string::npos);
  }
  EXPECT_THROW(mesh_cloud(ball).save("ball.xyz"), std::invalid_argument);
}

}  // namespace
}  // namespace umtet
