#pragma once

#include <pcl/PolygonMesh.h>
#include <pcl/conversions.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <umtet/cloud_mesh.h>

#include <algorithm>
#include <cmath>

// Conversion between clouds of PCL and umtet. These are templates, so they are compiled with the flags of the user's
// code and the Eigen version of the user's PCL.
//
// Coordinates of PCL are float: they are rounded by up to 6e-8 of their distance from the origin. This is harmless
// below some thousandths of h, the edge length of the mesh. A cloud farther out, as in UTM coordinates, has to be moved
// to the origin before it becomes a PCL cloud: from_pcl() cannot restore lost digits, and to_pcl() loses them again.
namespace umtet {

/// Converts points of any type with x, y, z, and normals if the type has them. Points that are not finite are dropped
/// and counted.
/// @param viewpoint  position of the sensor, in the coordinates of the points. pcl::transformPointCloud() does not
///                   change sensor_origin_: after a registration, pass the transformed position
template <class PointT>
ScannedCloud from_pcl(const pcl::PointCloud<PointT>& cloud, const Eigen::Vector3f& viewpoint) {
  ScannedCloud made;
  made.points.reserve(cloud.size());
  for (const PointT& p : cloud) {
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z)) {
      ++made.n_not_finite;
      continue;
    }
    made.points.push_back({p.x, p.y, p.z});
    if constexpr (pcl::traits::has_normal<PointT>::value) made.normals.push_back({p.normal_x, p.normal_y, p.normal_z});
  }
  if (viewpoint.allFinite()) made.viewpoints.assign(made.points.size(), {viewpoint.x(), viewpoint.y(), viewpoint.z()});
  return made;
}

/// Converts a cloud with its sensor_origin_, which is the VIEWPOINT of its PCD file, as viewpoint. An unset
/// sensor_origin_, which is (0, 0, 0) without rotation, counts as unknown.
template <class PointT>
ScannedCloud from_pcl(const pcl::PointCloud<PointT>& cloud) {
  const bool is_set = !cloud.sensor_origin_.template head<3>().isZero(0) ||
                      !cloud.sensor_orientation_.coeffs().isApprox(Eigen::Quaternionf::Identity().coeffs());
  if (is_set) return from_pcl(cloud, cloud.sensor_origin_.template head<3>());
  return from_pcl(cloud, Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN()));
}

/// Converts points, with normals if they are given and PointT has them.
template <class PointT>
pcl::PointCloud<PointT> to_pcl(const Coordinates& points, const Coordinates& normals) {
  pcl::PointCloud<PointT> made;
  made.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    PointT& p = made[i];
    const auto set = [](const std::array<double, 3>& a, float& x, float& y, float& z) {
      x = static_cast<float>(a[0]);
      y = static_cast<float>(a[1]);
      z = static_cast<float>(a[2]);
    };
    set(points[i], p.x, p.y, p.z);
    if constexpr (pcl::traits::has_normal<PointT>::value) {
      if (!normals.empty()) set(normals[i], p.normal_x, p.normal_y, p.normal_z);
    }
  }
  return made;
}

/// Converts a cloud without its viewpoints, for example the samples of a mesh.
template <class PointT>
pcl::PointCloud<PointT> to_pcl(const ScannedCloud& cloud) {
  return to_pcl<PointT>(cloud.points, cloud.normals);
}

/// Converts the boundary vertices of a mesh, in the order of boundary_vertices, with the normals of psi = 0.
template <class PointT>
pcl::PointCloud<PointT> to_pcl(const CloudMesh& mesh) {
  Coordinates points;
  points.reserve(mesh.boundary_vertices.size());
  for (const int i : mesh.boundary_vertices) points.push_back(mesh.points[static_cast<std::size_t>(i)]);
  return to_pcl<PointT>(points, mesh.boundary_normals);
}

/// Converts the boundary of a mesh: its vertices as pcl::PointNormal, and its triangles.
inline pcl::PolygonMesh to_polygon_mesh(const CloudMesh& mesh) {
  pcl::PolygonMesh made;
  pcl::toPCLPointCloud2(to_pcl<pcl::PointNormal>(mesh), made.cloud);
  const std::vector<int>& ids = mesh.boundary_vertices;
  for (const std::array<int, 3>& triangle : mesh.boundary) {
    pcl::Vertices& polygon = made.polygons.emplace_back();
    for (const int i : triangle) {
      const auto at = std::lower_bound(ids.begin(), ids.end(), i) - ids.begin();
      polygon.vertices.push_back(static_cast<pcl::index_t>(at));
    }
  }
  return made;
}

}  // namespace umtet
