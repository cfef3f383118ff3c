#include "mesh/submesh/um_result.h"

namespace umtet {

const char* to_string(UmStatus status) {
  switch (status) {
    case UmStatus::Success:
      return "success";
    case UmStatus::EmptyDomain:
      return "empty domain";
    case UmStatus::PsiNotFinite:
      return "psi not finite";
    case UmStatus::DomainLeavesBackground:
      return "domain leaves background";
    case UmStatus::BoundaryNearWall:
      return "boundary near wall";
    case UmStatus::DoublePositiveFace:
      return "double positive face";
    case UmStatus::ObtuseConditioningAngle:
      return "obtuse conditioning angle";
    case UmStatus::ProjectionDiverged:
      return "projection diverged";
    case UmStatus::InvertedTet:
      return "inverted tet";
  }
  return "unknown";
}

}  // namespace umtet
