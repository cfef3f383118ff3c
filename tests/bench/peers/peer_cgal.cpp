// One mesh of a known shape by CGAL's Mesh_3 from the implicit function, with the criteria of its manual's example.
// peer_cgal SHAPE EDGE_LENGTH plain|optimised MESH.mesh

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Labeled_mesh_domain_3.h>
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/make_mesh_3.h>

#include <cstring>
#include <fstream>
#include <iostream>

#include "tests/support/bench_domains.h"

using K = CGAL::Exact_predicates_inexact_constructions_kernel;
using Domain = CGAL::Labeled_mesh_domain_3<K>;
using Tr = CGAL::Mesh_triangulation_3<Domain, CGAL::Default, CGAL::Sequential_tag>::type;
using C3t3 = CGAL::Mesh_complex_3_in_triangulation_3<Tr>;
using Criteria = CGAL::Mesh_criteria_3<Tr>;
namespace params = CGAL::parameters;

int main(int argc, char** argv) {
  if (argc != 5) {
    std::cerr << "peer_cgal SHAPE EDGE_LENGTH plain|optimised MESH.mesh\n";
    return 2;
  }
  const auto shape = umtet::testing::domain_by_name(argv[1]);
  const double h = std::stod(argv[2]);
  const auto psi = [&](const K::Point_3& p) {  // outside the box eq. (9) has sheets that are not meant
    const umtet::Vec3 x(p.x(), p.y(), p.z());
    return shape.box.contains(x) ? shape.value(x) : 1;
  };
  const double reach = .5 * shape.box.diagonal().norm();
  const Domain domain = Domain::create_implicit_mesh_domain(psi, K::Sphere_3(CGAL::ORIGIN, reach * reach),
                                                            params::relative_error_bound = 1e-7);
  // Radii of circumscribed spheres and circles that give about as many tets as edges of mean length h.
  const Criteria criteria(params::facet_angle = 30, params::facet_size = .7 * h, params::facet_distance = .05 * h,
                          params::cell_radius_edge_ratio = 2, params::cell_size = .75 * h);
  const C3t3 mesh = std::strcmp(argv[3], "optimised") == 0
                        ? CGAL::make_mesh_3<C3t3>(domain, criteria, params::odt(), params::perturb(), params::exude())
                        : CGAL::make_mesh_3<C3t3>(domain, criteria, params::no_odt(), params::no_lloyd(),
                                                  params::no_perturb(), params::no_exude());
  std::ofstream file(argv[4]);
  file.precision(17);
  mesh.output_to_medit(file);
  return file.flush() ? 0 : 1;
}
