//                                umtet example 1
//
// Sample runs:  ex1
//               ex1 0.05
//               ex1 0.02 ball.msh
//
// Description:  Meshes a domain that is given by a function psi, negative inside: here the ball of radius 1. psi is any
//               class with value() and gradient(); a Hessian makes projections converge quadratically. The mesh is
//               certified, and written as .vtu (ParaView) or .msh (Gmsh).
#include <cstdio>
#include <cstdlib>
#include <string>

#include "mesh/certify/certificate.h"
#include "mesh/io/solver_files.h"
#include "mesh/io/tet_mesh_io.h"
#include "mesh/universal_mesh.h"

struct Ball {
  double value(const umtet::Vec3& x) const { return x.squaredNorm() - 1; }
  umtet::Vec3 gradient(const umtet::Vec3& x) const { return 2 * x; }
  umtet::Mat3 hessian(const umtet::Vec3&) const { return 2 * umtet::Mat3::Identity(); }
};

int main(int argc, char* argv[]) {
  // 1. What is asked for: the edge length of the background mesh, and a file.
  const double h = argc > 1 ? std::atof(argv[1]) : 0.1;
  const std::string file = argc > 2 ? argv[2] : "ball.vtu";

  // 2. The background: acute tets (A15) in a box with room of two edges around the domain. Nothing is stored for it.
  const umtet::Vec3 corner = umtet::Vec3::Constant(1 + 2 * h);
  const umtet::BackgroundMesh background(umtet::a15(), umtet::Box(-corner, corner), h);

  // 3. The mesh: tets of the background with a vertex inside, their outer vertices moved to psi = 0. What can go wrong
  //    is a status with evidence, and no exception.
  const Ball psi;
  const umtet::UmResult result = umtet::universal_mesh(background, psi);
  if (result.status != umtet::UmStatus::Success) {
    std::fprintf(stderr, "no mesh: %s: %s\n", umtet::to_string(result.status), result.evidence.what.c_str());
    return 1;
  }

  // 4. Its certificate: exact signs of all volumes, a boundary that is a closed manifold, distances to psi = 0.
  const umtet::TetMesh mesh{result.final, result.submesh.mesh.C};
  umtet::CertificateInput input;
  input.mesh = &mesh;
  input.h = h;
  input.positive_faces = &result.submesh.positive_faces;
  input.psi = psi;
  const umtet::MeshCertificate certificate = umtet::certify(input);
  for (const std::string& reason : umtet::failures(certificate)) std::printf("it fails: %s\n", reason.c_str());
  std::printf("%zu tets, min Q %.3f, volume %.5f (4 pi / 3 = 4.18879)\n", certificate.n_tets, certificate.quality.min,
              certificate.volume);

  // 5. A file, with the ids that vertices and tets have in the background.
  if (file.ends_with(".msh")) {
    umtet::write_msh41(file, umtet::solver_mesh(mesh), umtet::MshEncoding::Binary);
  } else {
    umtet::write_vtu(file,
                     umtet::with_standard_data(mesh, result.submesh.background_vertex, result.submesh.background_tet));
  }
  return umtet::failures(certificate).empty() ? 0 : 6;
}
