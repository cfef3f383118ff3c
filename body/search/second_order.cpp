#include "body/search/second_order.h"

#include "body/sizing/edge_length.h"

namespace umtet {

SecondOrder curved_mesh(const Domain& domain, const UmResult& result, double h, const ClosestPointParams& params,
                        const Context& context) {
  SecondOrderParams second;
  second.closest_point = params;
  SecondOrder curved = quadratic_tets({result.final, result.submesh.mesh.C}, result.submesh.positive_faces,
                                      domain.psi(), h, second, context);
  for (std::size_t i = result.final.size(); i < curved.mesh.V.size(); ++i) {
    Vec3& x = curved.mesh.V[i];
    x = (x + domain.shift) - domain.shift;
  }
  return curved;
}

SecondOrderReport measure_second_order(const Domain& domain, const UmResult& result, const SecondOrder& second,
                                       double h, const Context& context) {
  SecondOrderInput input;
  input.mesh = &second.mesh;
  input.h = h;
  input.psi = domain.psi();
  input.wall_faces = &result.walls;
  input.coordinate_rounding = coordinate_rounding(domain);
  input.context = context;
  return {certify_second_order(input), SecondOrderReport::Repairs{.n_mid_sides_put_back = second.off_surface.size(),
                                                                  .n_mid_sides_unprojected = second.n_unprojected,
                                                                  .n_mid_sides_slid = second.n_slid,
                                                                  .n_mid_sides_relaxed = second.n_relaxed}};
}

}  // namespace umtet
