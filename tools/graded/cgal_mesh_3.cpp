// CGAL's Mesh_3 of an implicit domain with a size field, perturbed and exuded, to compare with. It is compiled by hand,
// with Debian's libcgal-dev and libeigen3-dev:
//   g++ -O3 -DNDEBUG -I/usr/include/eigen3 cgal_mesh_3.cpp -o cgal_mesh_3 -lgmp -lmpfr
// usage: cgal_mesh_3 sphere|torus|ellipsoid FINEST GROWTH OUT.mesh
// Sizes are those of graded_bodies.py: FINEST + GROWTH times the distance from the fine point.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Labeled_mesh_domain_3.h>
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/make_mesh_3.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <string>

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Domain = CGAL::Labeled_mesh_domain_3<Kernel>;
using Triangulation = CGAL::Mesh_triangulation_3<Domain>::type;
using Criteria = CGAL::Mesh_criteria_3<Triangulation>;

double sphere(const Point& p) { return p.x() * p.x() + p.y() * p.y() + p.z() * p.z() - 1; }
double torus(const Point& p) {
  const double s = p.x() * p.x() + p.y() * p.y() + p.z() * p.z() + .84;
  return s * s - 4 * (p.x() * p.x() + p.y() * p.y());
}
double ellipsoid(const Point& p) { return p.x() * p.x() + p.y() * p.y() + 25 * p.z() * p.z() - 1; }

/// What Mesh_criteria_3 asks of a size field.
struct Size {
  using FT = double;
  using Point_3 = Point;
  using Index = Domain::Index;
  Point fine;
  double finest, growth;
  FT operator()(const Point& p, int, const Index&) const {
    return finest + growth * std::sqrt(CGAL::squared_distance(p, fine));
  }
};

int main(int argc, char** argv) {
  const std::string body = argc == 5 ? argv[1] : "";
  double (*psi)(const Point&) = body == "sphere" ? sphere : body == "torus" ? torus : body == "ellipsoid" ? ellipsoid : nullptr;
  if (!psi) {
    std::cerr << "usage: cgal_mesh_3 sphere|torus|ellipsoid FINEST GROWTH OUT.mesh\n";
    return 2;
  }
  const Point fine = body == "sphere" ? Point(0, 0, 1) : body == "torus" ? Point(-1.4, 0, 0) : Point(1, 0, 0);
  // A mesh is as fine as ours where its mean edge is: sizes are circumradii here, .6124 of the edge of a regular tet.
  const double of_edge = std::sqrt(6.) / 4;
  const Size size{fine, of_edge * std::atof(argv[2]), of_edge * std::atof(argv[3])};
  // The centre of the bounding sphere has to be inside.
  const Point centre = body == "torus" ? Point(1, 0, 0) : Point(0, 0, 0);
  const Domain domain = Domain::create_implicit_mesh_domain(psi, Kernel::Sphere_3(centre, 9.));
  using namespace CGAL::parameters;
  const Criteria criteria(facet_angle = 25, facet_size = size, facet_distance = .4 * size.finest,
                          cell_radius_edge_ratio = 2, cell_size = size);
  const auto mesh = CGAL::make_mesh_3<CGAL::Mesh_complex_3_in_triangulation_3<Triangulation>>(domain, criteria);
  std::ofstream out(argv[4]);
  mesh.output_to_medit(out);
  return out.flush() ? 0 : 7;
}
