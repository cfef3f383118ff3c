#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "body/body.h"
#include "body/fidelity/mesh_measures.h"
#include "mesh/background/background_mesh.h"
#include "mesh/certify/certificate.h"
#include "mesh/fast/fast_params.h"
#include "mesh/implicit/closest_point.h"
#include "mesh/submesh/um_result.h"

// A mesh that several processes make, and that none of them has as a whole. Who they are and how they speak with each
// other is not known here.
namespace umtet {

/// What there is of a mesh of second order besides.
struct CurvedInParts {
  SecondOrderReport report;
  std::vector<Vec3> mid_sides;  ///< those of boundary edges
};

/// Such a mesh. All processes free it when the last handle is destroyed.
class MeshInParts {
 public:
  virtual ~MeshInParts() = default;
  /// What one process makes by curved_mesh() and measures of it: the final mesh is of second order from now on.
  /// @param domain  that it was made in
  virtual CurvedInParts curve(const Domain& domain, const ClosestPointParams& params) const = 0;
};

struct MadeInParts {
  UmResult result;  ///< without tets: positive faces, their vertices in `final`, and what is said of the whole
  MeshCertificate certificate;
  std::size_t n_tets = 0, n_chosen_tets = 0;
  std::shared_ptr<const MeshInParts> mesh;
};

/// How a file will hold vertices, and what of psi = 0 they are held against.
struct RoundedPlaces {
  double h;         ///< CertificateInput::h
  Vec3 shift;       ///< Domain::shift
  double rounding;  ///< CertificateInput::coordinate_rounding
};

/// Several processes that make a mesh together.
class PartMaker {
 public:
  virtual ~PartMaker() = default;
  /// What one process makes in this lattice by universal_mesh(), rounds to a file and certifies: the same to the bit.
  /// None where there is no mesh; why, one process finds out.
  /// @param box     that the background was asked to cover
  /// @param domain  cut for places.h; the same one whenever this is called, unless PartMesher::forget_domain() is
  /// called before
  /// @param seeds   of SubmeshSearch::Crawl, where some pieces of psi = 0 are left out; else empty
  virtual std::optional<MadeInParts> make(const BackgroundMesh& background, const Box& box, const Domain& domain,
                                          const FastParams& params, const std::vector<Vec3>& seeds,
                                          const RoundedPlaces& places) = 0;
  /// How many processes.
  virtual int n() const = 0;
};

}  // namespace umtet
