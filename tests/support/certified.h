#pragma once

#include "mesh/certify/certificate.h"
#include "mesh/core/implicit_function.h"
#include "mesh/universal_mesh.h"

namespace umtet::testing {

/// The certificate of a result of universal_mesh(), against its positive faces and psi.
inline MeshCertificate certificate_of(const UmResult& result, ImplicitFunctionRef psi, double h) {
  const TetMesh mesh{result.final, result.submesh.mesh.C};
  CertificateInput input;
  input.mesh = &mesh;
  input.h = h;
  input.positive_faces = &result.submesh.positive_faces;
  input.psi = psi;
  return certify(input);
}

}  // namespace umtet::testing
