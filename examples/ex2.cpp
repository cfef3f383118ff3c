//                                umtet example 2
//
// Sample runs:  ex2
//               ex2 scan.ply
//               ex2 scan.ply 0.5
//
// Description:  From the points of a file, or of an ellipsoid, to a mesh in a file, by the facade. The library cleans
// the
//               points, estimates their normals if there are none, fits a C2 level set psi, meshes {psi < 0} and judges
//               the mesh. The second argument is the edge length; by default the library chooses it. An error names the
//               options that help.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "mesh/io/tet_mesh_io.h"
#include "reconstruct/io/point_cloud_io.h"
#include "umtet/umtet.h"

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

int main(int argc, char* argv[]) try {
  // 1. The samples.
  const umtet::OrientedPointCloud cloud = argc > 1 ? umtet::read_scan(argv[1]).cloud : ellipsoid();
  umtet::Options options;
  if (argc > 2) options.body.mesh.h = std::atof(argv[2]);

  // 2. psi. Spacing and smoothing follow from the samples.
  const umtet::FittedBody body = umtet::fit_body(cloud, options);
  const umtet::SsdReport& fit = body.report.fit;
  std::printf("psi: %s; rms of psi at the samples %.2g\n", fit.reason.c_str(), fit.rms_value);

  // 3. Mesh and certificate.
  const umtet::Mesh mesh = umtet::mesh_body(body, options);
  for (const umtet::Message& notice : mesh.notices) std::printf("notice: %s\n", umtet::text_of(notice).c_str());
  for (const std::string& reason : mesh.verdict.reasons) std::printf("it fails: %s\n", reason.c_str());
  const umtet::MeshCertificate& certificate = mesh.measures.mesh;
  std::printf("mesh: %zu tets, min Q %.3f, volume %.5g: %s\n", certificate.n_tets, certificate.quality.min,
              certificate.volume, mesh.verdict.word().c_str());

  // 4. A file.
  umtet::write_vtu("cloud.vtu", umtet::with_standard_data({mesh.points, mesh.tets}, {}, {}));
  return mesh.verdict.passes() ? 0 : 6;
} catch (const umtet::ExplainedError& e) {
  std::fprintf(stderr, "no mesh: %s\n", e.what());
  return 1;
}
