// CGAL's Mesh_3 of a closed triangle mesh with its sharp edges protected by balls, optimised, perturbed and exuded, to
// compare with. It is compiled by hand, with Debian's libcgal-dev and libeigen3-dev:
//   g++ -O3 -DNDEBUG -I/usr/include/eigen3 cgal_edges.cpp -o cgal_edges -lgmp -lmpfr
// usage: cgal_edges IN.off EDGE ANGLE OUT.mesh
// EDGE is the edge length that is asked for, and edges that turn by more than ANGLE degrees are sharp.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_polyhedron_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/Polyhedral_mesh_domain_with_features_3.h>
#include <CGAL/make_mesh_3.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iostream>

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Polyhedron = CGAL::Mesh_polyhedron_3<Kernel>::type;
using Domain = CGAL::Polyhedral_mesh_domain_with_features_3<Kernel>;
using Triangulation = CGAL::Mesh_triangulation_3<Domain>::type;
using Complex =
    CGAL::Mesh_complex_3_in_triangulation_3<Triangulation, Domain::Corner_index, Domain::Curve_index>;
using Criteria = CGAL::Mesh_criteria_3<Triangulation>;

int main(int argc, char** argv) {
  if (argc != 5) {
    std::cerr << "usage: cgal_edges IN.off EDGE ANGLE OUT.mesh\n";
    return 2;
  }
  Polyhedron polyhedron;
  std::ifstream in(argv[1]);
  if (!(in >> polyhedron) || !CGAL::is_closed(polyhedron)) {
    std::cerr << "no closed mesh in " << argv[1] << '\n';
    return 3;
  }
  Domain domain(polyhedron);
  domain.detect_features(std::atof(argv[3]));
  // Sizes of facets and cells are circumradii: those of a regular triangle and tet.
  const double edge = std::atof(argv[2]), of_facet = edge / std::sqrt(3.), of_cell = edge * std::sqrt(6.) / 4;
  using namespace CGAL::parameters;
  const Criteria criteria(edge_size = edge, facet_angle = 25, facet_size = of_facet, facet_distance = .1 * edge,
                          cell_radius_edge_ratio = 2, cell_size = of_cell);
  const auto mesh = CGAL::make_mesh_3<Complex>(domain, criteria, odt(), perturb(time_limit = 20), exude(time_limit = 20));
  std::ofstream out(argv[4]);
  mesh.output_to_medit(out);
  return out.flush() ? 0 : 7;
}
