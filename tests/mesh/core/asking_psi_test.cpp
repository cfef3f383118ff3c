// A psi that is asked in blocks: every loop asks it for the same points, and makes the same of the answers.

#include "mesh/core/asking_psi.h"

#include <gtest/gtest.h>

#include "mesh/certify/certificate.h"
#include "mesh/implicit/thickness.h"
#include "mesh/implicit/zero_set.h"
#include "mesh/second_order/quadratic_tets.h"
#include "mesh/sizes/body_size.h"
#include "mesh/universal_mesh.h"
#include "tests/support/domains.h"

using namespace umtet;
using namespace umtet::testing;

namespace {

/// A domain of the tests whose calls are counted, and which is asked in blocks.
class InBlocks : private SideBySide {
 public:
  explicit InBlocks(AnalyticDomain domain) : domain_(std::move(domain)) {}
  double evaluate(const Vec3& x, Vec3* g, Mat3* H) const { return domain_.evaluate(x, g, H); }
  void values(std::span<const Vec3> x, double* out) const {
    n_in_blocks += x.size();
    for (const Vec3& at : x) *out++ = domain_.value(at);
  }
  const SideBySide* side_by_side() const { return this; }
  mutable std::size_t n_in_blocks = 0, n_side_by_side = 0;

 private:
  /// From the last to the first: no call depends on one before it.
  void for_each(std::size_t n, const std::function<void(std::size_t)>& f) const override {
    n_side_by_side += n;
    while (n > 0) f(--n);
  }
  AnalyticDomain domain_;
};

std::vector<AnalyticDomain> some_domains() { return {sphere(), torus(), equation_9()}; }

void expect_same(const UmResult& a, const UmResult& b) {
  EXPECT_EQ(a.status, b.status);
  EXPECT_EQ(a.final, b.final);
  EXPECT_EQ(a.projected, b.projected);
  EXPECT_EQ(a.submesh.mesh.C, b.submesh.mesh.C);
  EXPECT_EQ(a.n_psi_evaluations, b.n_psi_evaluations);
}

}  // namespace

TEST(AskingPsi, MeshesOfAPsiThatIsAskedInBlocksAreTheSame) {
  for (const AnalyticDomain& d : some_domains()) {
    const InBlocks psi(d);
    const BackgroundMesh background(a15(), d.box, d.box.sizes().maxCoeff() / 16);
    for (const UmMode mode : {UmMode::Fast, UmMode::Paper}) {
      UmParams params;
      params.mode = mode;
      expect_same(universal_mesh(background, psi, params), universal_mesh(background, d, params));
    }
    EXPECT_GT(psi.n_in_blocks, static_cast<std::size_t>(background.n_vertices()));
    EXPECT_GT(psi.n_side_by_side, 0U);
  }
}

TEST(AskingPsi, TheComplementOfOneIsAskedInBlocksToo) {
  const AnalyticDomain d = torus();
  const InBlocks psi(d);
  const Complement<InBlocks> outside(psi);
  const ImplicitFunctionRef asked = outside;
  EXPECT_NE(asked.side_by_side(), nullptr);
  EXPECT_EQ(ImplicitFunctionRef(d).side_by_side(), nullptr);
  const std::vector<Vec3> x = {{1, 0, 0}, {0, 0, 0}, {.3, 1, .1}};
  std::vector<double> values(x.size());
  asked.values(x, values.data());
  for (std::size_t i = 0; i < x.size(); ++i) EXPECT_EQ(values[i], -d.value(x[i]));
}

TEST(AskingPsi, CountsAndMeasuresAreTheSame) {
  for (const AnalyticDomain& d : some_domains()) {
    const InBlocks psi(d);
    const double h = d.box.sizes().maxCoeff() / 20;
    const ZeroSetTopology asked = zero_set_topology(psi, d.box, h), plain = zero_set_topology(d, d.box, h);
    EXPECT_EQ(asked.cut_points, plain.cut_points);
    EXPECT_EQ(asked.euler_characteristic, plain.euler_characteristic);
    EXPECT_EQ(body_size(psi, d.box).volume, body_size(d, d.box).volume);
    EXPECT_EQ(body_size(psi, d.box).area, body_size(d, d.box).area);
    EXPECT_EQ(thickness(psi, plain.cut_points, .2 * h, 4 * h), thickness(d, plain.cut_points, .2 * h, 4 * h));

    const UmResult made = universal_mesh(BackgroundMesh(a15(), d.box, h), d);
    ASSERT_EQ(made.status, UmStatus::Success);
    const TetMesh mesh{made.final, made.submesh.mesh.C};
    CertificateInput input;
    input.mesh = &mesh;
    input.h = h;
    input.psi = psi;
    const MeshCertificate of_blocks = certify(input);
    input.psi = d;
    const MeshCertificate of_plain = certify(input);
    EXPECT_EQ(of_blocks.boundary.max_vertex_distance_over_h, of_plain.boundary.max_vertex_distance_over_h);
    EXPECT_EQ(of_blocks.boundary.max_centroid_distance_over_h, of_plain.boundary.max_centroid_distance_over_h);
    EXPECT_EQ(quadratic_tets(mesh, made.submesh.positive_faces, psi, h, {}).mesh.V,
              quadratic_tets(mesh, made.submesh.positive_faces, d, h, {}).mesh.V);
  }
}
