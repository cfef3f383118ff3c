// CGAL's Poisson reconstruction with the defaults of its manual, to compare with. It is compiled by hand, with Debian's
// libcgal-dev and libeigen3-dev:
//   g++ -O3 -DNDEBUG -DCGAL_EIGEN3_ENABLED -I/usr/include/eigen3 cgal_poisson.cpp -o cgal_poisson -lgmp -lmpfr
// usage: cgal_poisson CLOUD.ply MESH.ply      exit code 3: not read, 4: no surface, 7: not written
// A cloud without normals gets those of jets, oriented along a minimum spanning tree; points that get none are dropped.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/IO/PLY.h>
#include <CGAL/Point_set_3.h>
#include <CGAL/Point_set_3/IO.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/compute_average_spacing.h>
#include <CGAL/jet_estimate_normals.h>
#include <CGAL/mst_orient_normals.h>
#include <CGAL/poisson_surface_reconstruction.h>

#include <fstream>
#include <iostream>

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Points = CGAL::Point_set_3<Kernel::Point_3>;

constexpr unsigned kNeighboursOfSpacing = 6, kNeighboursOfNormals = 18;
constexpr double kAngle = 20, kRadius = 30, kDistance = .375;

void find_normals(Points& points) {
  points.add_normal_map();
  CGAL::jet_estimate_normals<CGAL::Sequential_tag>(points, kNeighboursOfNormals);
  points.remove(CGAL::mst_orient_normals(points, kNeighboursOfNormals), points.end());
  points.collect_garbage();
}

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: cgal_poisson CLOUD.ply MESH.ply\n";
    return 2;
  }
  Points points;
  std::ifstream in(argv[1], std::ios::binary);
  if (!CGAL::IO::read_PLY(in, points) || points.empty()) return 3;
  if (!points.has_normal_map()) find_normals(points);

  const double spacing =
      CGAL::compute_average_spacing<CGAL::Sequential_tag>(points, kNeighboursOfSpacing, points.parameters());
  CGAL::Surface_mesh<Kernel::Point_3> mesh;
  if (!CGAL::poisson_surface_reconstruction_delaunay(points.begin(), points.end(), points.point_map(),
                                                     points.normal_map(), mesh, spacing, kAngle, kRadius, kDistance))
    return 4;
  std::ofstream out(argv[2], std::ios::binary);
  CGAL::IO::set_binary_mode(out);
  return CGAL::IO::write_PLY(out, mesh) ? 0 : 7;
}
