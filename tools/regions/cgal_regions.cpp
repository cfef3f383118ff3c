// CGAL's Mesh_3 of a domain of several regions, optimised, perturbed and exuded, to compare with. It is compiled by hand,
// with Debian's libcgal-dev and libeigen3-dev:
//   g++ -O3 -DNDEBUG -I/usr/include/eigen3 cgal_regions.cpp -o cgal_regions -lgmp -lmpfr -lz
// usage: cgal_regions sphere|torus|nested|bubble|cut HALF EDGE OUT.mesh   a domain in a cube of half side HALF
//        cgal_regions IMAGE.inr 0 EDGE OUT.mesh                           all labels of an image
// EDGE is the edge length that is asked for.
#define CGAL_USE_ZLIB 1
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Image_3.h>
#include <CGAL/Labeled_mesh_domain_3.h>
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/make_mesh_3.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <iostream>
#include <map>
#include <string>

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Domain = CGAL::Labeled_mesh_domain_3<Kernel>;
using Triangulation = CGAL::Mesh_triangulation_3<Domain>::type;
using Complex = CGAL::Mesh_complex_3_in_triangulation_3<Triangulation>;
using Criteria = CGAL::Mesh_criteria_3<Triangulation>;
using Point = Kernel::Point_3;

namespace {

double ball(const Point& p, double x, double r) { return std::pow(p.x() - x, 2) + p.y() * p.y() + p.z() * p.z() - r * r; }

// Labels of points: 1 is what surrounds the bodies, 0 is outside of the cube.
const std::map<std::string, std::function<int(const Point&)>> kDomains = {
    {"sphere", [](const Point& p) { return ball(p, 0, 1) < 0 ? 2 : 1; }},
    {"torus",
     [](const Point& p) { return std::pow(std::hypot(p.x(), p.y()) - 1, 2) + p.z() * p.z() < .16 ? 2 : 1; }},
    {"nested", [](const Point& p) { return ball(p, 0, .6) < 0 ? 3 : ball(p, 0, 1) < 0 ? 2 : 1; }},
    {"bubble",
     [](const Point& p) {
       const double a = ball(p, .5, 1), b = ball(p, -.5, 1);
       return a >= 0 && b >= 0 ? 1 : a < b ? 2 : 3;
     }},
    {"cut", [](const Point& p) { return ball(p, 0, 1) >= 0 ? 1 : p.x() < 0 ? 2 : 3; }},
};

Domain domain_of(const std::string& name, double half, CGAL::Image_3& image) {
  const auto known = kDomains.find(name);
  if (known == kDomains.end()) {
    if (!image.read(name.c_str())) {
      std::cerr << "no image in " << name << '\n';
      std::exit(3);
    }
    return Domain::create_labeled_image_mesh_domain(image);
  }
  const auto label = [f = known->second, half](const Point& p) {
    return std::max({std::abs(p.x()), std::abs(p.y()), std::abs(p.z())}) > half ? 0 : f(p);
  };
  return Domain(label, Kernel::Sphere_3(CGAL::ORIGIN, 3.1 * half * half));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 5) {
    std::cerr << "usage: cgal_regions DOMAIN|IMAGE HALF EDGE OUT.mesh\n";
    return 2;
  }
  CGAL::Image_3 image;
  Domain domain = domain_of(argv[1], std::atof(argv[2]), image);
  // Sizes of facets and cells are circumradii: those of a regular triangle and tet.
  const double edge = std::atof(argv[3]), of_facet = edge / std::sqrt(3.), of_cell = edge * std::sqrt(6.) / 4;
  using namespace CGAL::parameters;
  const Criteria criteria(facet_angle = 25, facet_size = of_facet, facet_distance = .1 * edge,
                          cell_radius_edge_ratio = 2, cell_size = of_cell);
  const auto mesh = CGAL::make_mesh_3<Complex>(domain, criteria, odt(), perturb(time_limit = 60), exude(time_limit = 60));
  std::ofstream out(argv[4]);
  mesh.output_to_medit(out);
  return out.flush() ? 0 : 7;
}
