#include "body/search/rounded_mesh.h"

namespace umtet {

void round_to_file(UmResult& result, const Vec3& shift) {
  for (auto* V : {&result.submesh.mesh.V, &result.projected, &result.final}) {
    for (Vec3& x : *V) x = (x + shift) - shift;
  }
}

}  // namespace umtet
