//                                umtet with PCL
//
// Sample runs:  views
//               views 1.pcd 2.pcd 3.pcd
//
// Description:  From views of a body to a tet mesh, in memory. Each view is thinned, registered to those before it and
//               gets normals that look to its sensor; then umtet makes one body of all. Views are PCD files, each with
//               the VIEWPOINT of its sensor, nearly in place. Without files the program renders six depth images of a
//               body and moves them a little. It writes views.vtu, the tets, and views.ply, their boundary.
#include <pcl/common/transforms.h>
#include <pcl/features/normal_3d_omp.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/io/pcd_io.h>
#include <pcl/io/ply_io.h>
#include <pcl/registration/icp.h>
#include <umtet/pcl.h>

#include <cstdio>
#include <random>

using Cloud = pcl::PointCloud<pcl::PointXYZ>;

// Distance to two balls that touch smoothly, and a third on top: no symmetry lets a registration slide.
double body(const Eigen::Vector3d& x) {
  const auto blend = [](double a, double b) {
    const double t = std::max(.2 - std::abs(a - b), 0.) / .2;
    return std::min(a, b) - .05 * t * t;
  };
  const double belly = x.norm() - .6, head = (x - Eigen::Vector3d(.6, 0, .5)).norm() - .35;
  return blend(blend(belly, head), (x - Eigen::Vector3d(-.2, .5, .3)).norm() - .25);
}

// What a depth camera at `eye` sees of it: an image with NaN where there is nothing, and noise of 1 mm in 2 m.
Cloud depth_image(const Eigen::Vector3d& eye, unsigned seed) {
  constexpr int kPixels = 200;
  const Eigen::Vector3d ahead = -eye.normalized(), right = ahead.unitOrthogonal(), up = right.cross(ahead);
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, .001);
  Cloud image(kPixels, kPixels);
  image.is_dense = false;
  image.sensor_origin_.head<3>() = eye.cast<float>();
  for (int row = 0; row < kPixels; ++row) {
    for (int column = 0; column < kPixels; ++column) {
      const auto angle = [](int pixel) { return .8 * (pixel - kPixels / 2) / kPixels; };
      const Eigen::Vector3d ray = (ahead + angle(column) * right + angle(row) * up).normalized();
      double depth = 0, step = 1;
      while (step > 1e-5 && depth < 4) depth += step = body(eye + depth * ray);
      if (depth >= 4) depth = std::numeric_limits<double>::quiet_NaN();
      image(column, row).getVector3fMap() = (eye + (depth + noise(random)) * ray).cast<float>();
    }
  }
  return image;
}

// Six of them. All but the first are off by two degrees and some centimetres, sensor and all.
std::vector<Cloud> rendered() {
  std::vector<Cloud> views;
  for (int i = 0; i < 6; ++i) {
    Eigen::Vector3d eye(0, 0, i == 4 ? 2.2 : -2.2);
    if (i < 4) eye = 2.2 * Eigen::Vector3d(std::cos(1.5708 * i), std::sin(1.5708 * i), .2);
    const Cloud image = depth_image(eye, i);
    Eigen::Affine3f off = Eigen::Affine3f::Identity();
    if (i > 0)
      off = Eigen::Translation3f(.02, -.02, .01) * Eigen::AngleAxisf(.035, Eigen::Vector3f(i, 1, 2).normalized());
    Cloud& view = views.emplace_back();
    pcl::transformPointCloud(image, view, off);
    view.sensor_origin_.head<3>() = off * image.sensor_origin_.head<3>();
  }
  return views;
}

// 2. Fewer points; what is no number goes.
Cloud::Ptr thinned(const Cloud& view) {
  Cloud::Ptr thin(new Cloud);
  pcl::VoxelGrid<pcl::PointXYZ> grid;
  grid.setInputCloud(view.makeShared());
  grid.setLeafSize(.03f, .03f, .03f);
  grid.filter(*thin);
  return thin;
}

// 3. Where a view has to go to lie on those before it. \throw std::runtime_error
Eigen::Affine3f registration(const Cloud::Ptr& view, const Cloud::Ptr& before) {
  if (before->empty()) return Eigen::Affine3f::Identity();
  pcl::IterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ> icp;
  icp.setInputSource(view);
  icp.setInputTarget(before);
  icp.setMaxCorrespondenceDistance(.06);
  icp.setUseReciprocalCorrespondences(true);  // else what only one view has pulls at the edge of the other
  icp.setTransformationEpsilon(1e-9);
  Cloud placed;
  icp.align(placed);
  if (!icp.hasConverged()) throw std::runtime_error("a view cannot be registered");
  return Eigen::Affine3f(icp.getFinalTransformation());
}

// 4. Normals that look to the sensor.
pcl::PointCloud<pcl::PointNormal> with_normals(const Cloud::Ptr& view, const Eigen::Vector3f& sensor) {
  pcl::NormalEstimationOMP<pcl::PointXYZ, pcl::Normal> estimation;
  estimation.setInputCloud(view);
  estimation.setRadiusSearch(.06);
  estimation.setViewPoint(sensor.x(), sensor.y(), sensor.z());
  pcl::PointCloud<pcl::Normal> normals;
  estimation.compute(normals);
  pcl::PointCloud<pcl::PointNormal> oriented;
  pcl::concatenateFields(*view, normals, oriented);
  return oriented;
}

int main(int argc, char* argv[]) try {
  // 1. The views.
  std::vector<Cloud> views;
  for (int i = 1; i < argc; ++i) {
    if (pcl::io::loadPCDFile(argv[i], views.emplace_back()) != 0) return 3;
  }
  if (views.empty()) views = rendered();

  // 5. To umtet, one by one. The sensor moves with its view; PCL leaves that to the caller.
  Cloud::Ptr registered(new Cloud);
  umtet::ScannedCloud scan;
  for (const Cloud& view : views) {
    const Cloud::Ptr thin = thinned(view), placed(new Cloud);
    const Eigen::Affine3f move = registration(thin, registered);
    pcl::transformPointCloud(*thin, *placed, move);
    *registered += *placed;
    const Eigen::Vector3f sensor = move * view.sensor_origin_.head<3>();
    scan += umtet::from_pcl(with_normals(placed, sensor), sensor);
  }

  // 6. One body of all views, in tets.
  const umtet::CloudMesh mesh = umtet::mesh_cloud(scan);
  for (const std::string& notice : mesh.notices) std::printf("%s\n", notice.c_str());
  std::printf("%zu tets, h = %.3g, min Q %.3f, valid: %s, faithful: %s, verdict: %s\n", mesh.tets.size(), mesh.h,
              mesh.min_quality, mesh.is_valid ? "yes" : "no", mesh.fits_psi && mesh.fits_input ? "yes" : "no",
              mesh.passes ? "pass" : "fail");

  // 7. Files: the tets for a solver, the boundary for whatever PCL does with it.
  mesh.save("views.vtu");
  pcl::io::savePLYFileBinary("views.ply", umtet::to_polygon_mesh(mesh));
  return mesh.passes ? 0 : 6;
} catch (const std::exception& e) {
  std::fprintf(stderr, "no mesh: %s\n", e.what());
  return 5;
}
