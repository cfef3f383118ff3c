// Second order: how fast the volume of a domain without a closed form converges, beside that of the linear mesh.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <vector>

#include "mesh/certify/certificate.h"
#include "mesh/second_order/quadratic_tets.h"
#include "mesh/second_order/second_order_certificate.h"
#include "mesh/universal_mesh.h"
#include "reconstruct/io/point_cloud_io.h"
#include "reconstruct/solve/fit_ssd.h"
#include "tests/support/data_files.h"
#include "tests/support/domains.h"

using namespace umtet;

namespace {

struct Volumes {
  double linear = 0, curved = 0;
};

Volumes volumes(ImplicitFunctionRef psi, const Box& box, double h) {
  const UmResult result = universal_mesh(BackgroundMesh(a15(), box, h), psi);
  EXPECT_EQ(result.status, UmStatus::Success) << result.evidence.what;
  const TetMesh mesh{result.final, result.submesh.mesh.C};
  const SecondOrder second = quadratic_tets(mesh, result.submesh.positive_faces, psi, h);
  EXPECT_TRUE(second.off_surface.empty());
  SecondOrderInput input;
  input.mesh = &second.mesh;
  input.h = h;
  input.psi = psi;
  const SecondOrderCertificate c = certify_second_order(input);
  EXPECT_TRUE(failures(c).empty()) << failures(c).front();
  const double linear = certify({&mesh, h, nullptr, std::nullopt}).volume;
  std::printf("  h %.4f  %7zu tets  volume %.9f, linear %.9f  least Jacobian %.3f  rms distance %.2e h\n", h,
              mesh.C.size(), c.volume, linear, c.min_scaled_jacobian_lower, *c.rms_face_distance_over_h);
  return {linear, c.volume};
}

/// Exponents of h in the errors of three meshes, the last of a finer one.
void expect_rates(const char* name, ImplicitFunctionRef psi, const Box& box, const std::vector<double>& h,
                  double fine) {
  std::printf("%s\n", name);
  const double exact = volumes(psi, box, fine).curved;
  const Volumes first = volumes(psi, box, h.front());
  for (std::size_t i = 1; i + 1 < h.size(); ++i) volumes(psi, box, h[i]);
  const Volumes last = volumes(psi, box, h.back());
  const double steps = std::log(h.front() / h.back());
  const double curved = std::log(std::abs((first.curved - exact) / (last.curved - exact))) / steps;
  const double linear = std::log(std::abs((first.linear - exact) / (last.linear - exact))) / steps;
  std::printf("  rates %.2f, linear %.2f\n", curved, linear);
  EXPECT_GE(curved, 3.5);
  EXPECT_NEAR(linear, 2, .4);
}

}  // namespace

TEST(SecondOrder, VolumeOfEquation9ConvergesAsHToTheFourth) {
  const umtet::testing::AnalyticDomain domain = umtet::testing::equation_9();
  expect_rates("eq. (9)", domain, domain.box, {.17, .12, .085}, .05);
}

TEST(SecondOrder, VolumeOfTheDuckConvergesAsHToTheFourth) {
  const LevelSet fitted = fit_ssd(read_point_cloud(test::committed_cloud("duck.ply")).cloud).psi;
  // One domain for all meshes: the detail that the coarsest of them can show.
  const LevelSet psi = fitted.band_limited(.05);
  expect_rates("duck", psi, psi.domain(), {.06, .04, .03}, .018);
}
