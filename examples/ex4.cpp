//                                umtet example 4
//
// Sample run:   ex4 0.1
//
// Description:  The mesher inside another program: it links umtet::mesh alone, which needs Eigen, oneTBB and nanoflann
//               (and GSL, unless it was built without), reads and writes no files, and hands out arrays.
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "mesh/certify/certificate.h"
#include "mesh/universal_mesh.h"

struct Torus {
  static constexpr double R = 1, r = .4;
  double value(const umtet::Vec3& x) const {
    const double d = std::hypot(x.x(), x.y()) - R;
    return d * d + x.z() * x.z() - r * r;
  }
  umtet::Vec3 gradient(const umtet::Vec3& x) const {
    const double s = 1 - R / std::hypot(x.x(), x.y());
    return 2 * umtet::Vec3(s * x.x(), s * x.y(), x.z());
  }
};

int main(int argc, char* argv[]) {
  const double h = argc > 1 ? std::atof(argv[1]) : .1;
  const umtet::Vec3 corner(1.4 + 2 * h, 1.4 + 2 * h, .4 + 2 * h);
  const umtet::BackgroundMesh background(umtet::a15(), umtet::Box(-corner, corner), h);
  const Torus psi;
  umtet::UmParams params;
  params.mode = umtet::UmMode::Fast;
  const umtet::UmResult result = umtet::universal_mesh(background, psi, params);
  if (result.status != umtet::UmStatus::Success) {
    std::fprintf(stderr, "no mesh: %s\n", result.evidence.what.c_str());
    return 1;
  }
  const umtet::TetMesh mesh{result.final, result.submesh.mesh.C};  // coordinates, and four vertices a tet
  umtet::CertificateInput input;
  input.mesh = &mesh;
  input.h = h;
  input.psi = psi;
  const umtet::MeshCertificate certificate = umtet::certify(input);
  std::printf("%zu tets, min Q %.3f, genus %ld, volume %.5f (.32 pi^2 = 3.15827)\n", certificate.n_tets,
              certificate.quality.min, certificate.boundary.genus, certificate.volume);
  return umtet::failures(certificate).empty() ? 0 : 6;
}
