//                                umtet example 2
//
// Sample runs:  ex2
//               ex2 scan.ply
//               ex2 scan.ply 0.5
//
// Description:  From points with outward normals to a mesh. Fits psi, a C2 level set, to the points of a file or of an
//               ellipsoid, and meshes {psi < 0}: the level set satisfies what the mesher asks of a function. The second
//               argument is the edge length; the default is 2 % of the diagonal of the cloud's box.
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "mesh/certify/certificate.h"
#include "mesh/io/tet_mesh_io.h"
#include "mesh/universal_mesh.h"
#include "reconstruct/io/point_cloud_io.h"
#include "reconstruct/solve/fit_ssd.h"

// 5000 points of an ellipsoid with half axes 1, .8, .6 on a spiral, and their normals.
umtet::OrientedPointCloud ellipsoid() {
  const umtet::Vec3 axes(1, .8, .6);
  umtet::OrientedPointCloud cloud;
  for (int i = 0; i < 5000; ++i) {
    const double z = 1 - (2 * i + 1) / 5000., r = std::sqrt(1 - z * z), a = 2.399963229728653 * i;
    const umtet::Vec3 u(r * std::cos(a), r * std::sin(a), z);
    cloud.points.push_back(u.cwiseProduct(axes));
    cloud.normals.push_back(u.cwiseQuotient(axes).normalized());
  }
  return cloud;
}

int main(int argc, char* argv[]) {
  // 1. The samples. Scans that need cleaning, or have no normals, are for the program: umtet run.
  const umtet::OrientedPointCloud cloud = argc > 1 ? umtet::read_point_cloud(argv[1]).cloud : ellipsoid();
  umtet::Box box;
  for (const umtet::Vec3& x : cloud.points) box.extend(x);
  const double h = argc > 2 ? std::atof(argv[2]) : .02 * box.diagonal().norm();

  // 2. psi. Spacing and smoothing follow from the samples.
  const umtet::SsdFit fit = umtet::fit_ssd(cloud);
  std::printf("psi: %s; rms of psi at the samples %.2g\n", fit.report.reason.c_str(), fit.report.rms_value);

  // 3. The part of psi that a mesh of this h can show, and a background that covers where it is defined.
  const umtet::LevelSet psi = fit.psi.band_limited(.7 * h);
  const umtet::BackgroundMesh background(umtet::a15(), psi.domain(), h);

  // 4. Mesh and certificate, as in example 1.
  const umtet::UmResult result = umtet::universal_mesh(background, psi);
  if (result.status != umtet::UmStatus::Success) {
    std::fprintf(stderr, "no mesh: %s: %s\n", umtet::to_string(result.status), result.evidence.what.c_str());
    return 1;
  }
  const umtet::TetMesh mesh{result.final, result.submesh.mesh.C};
  umtet::CertificateInput input;
  input.mesh = &mesh;
  input.h = h;
  input.psi = psi;
  const umtet::MeshCertificate certificate = umtet::certify(input);
  for (const std::string& reason : umtet::failures(certificate)) std::printf("it fails: %s\n", reason.c_str());
  std::printf("mesh: %zu tets, min Q %.3f, volume %.5g\n", certificate.n_tets, certificate.quality.min,
              certificate.volume);

  // 5. A file.
  umtet::write_vtu("cloud.vtu",
                   umtet::with_standard_data(mesh, result.submesh.background_vertex, result.submesh.background_tet));
  return umtet::failures(certificate).empty() ? 0 : 6;
}
