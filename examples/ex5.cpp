//                                umtet example 5
//
// Sample runs:  ex5
//
// Description:  From a scan to a mesh with its verdict, by the facade. The scan has no normals: the library estimates
//               them, cleans the samples, fits psi, chooses the edge length and judges the mesh.
#include <cmath>
#include <cstdio>

#include "umtet/umtet.h"

int main() {
  umtet::OrientedPointCloud scan;
  for (int i = 0; i < 5000; ++i) {  // an ellipsoid
    const double z = 1 - (2 * i + 1) / 5000., r = std::sqrt(1 - z * z), a = 2.399963229728653 * i;
    scan.points.emplace_back(r * std::cos(a), .8 * r * std::sin(a), .6 * z);
  }
  const umtet::Mesh mesh = umtet::mesh_body(scan);
  std::printf("%zu tets, min Q %.3f: %s\n", mesh.tets.size(), mesh.measures.mesh.quality.min,
              mesh.verdict.word().c_str());
  for (const std::string& reason : mesh.verdict.reasons) std::printf("  %s\n", reason.c_str());
  return mesh.verdict.passes() ? 0 : 6;
}
