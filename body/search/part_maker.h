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

// A mesh that several processes make and store in parts. These interfaces do not depend on MPI.
namespace umtet {

/// The results for a mesh of second order.
struct CurvedInParts {
  SecondOrderReport report;
  std::vector<Vec3> mid_sides;  ///< mid-sides of the boundary edges
};

/// A mesh stored in parts. All processes free their local meshes when the last handle is destroyed.
class MeshInParts {
 public:
  virtual ~MeshInParts() = default;
  /// Makes the mesh of second order, as curved_mesh() does in one process, and measures it. The mesh is of second order
  /// after the call.
  /// @param domain  the domain of the mesh
  virtual CurvedInParts curve(const Domain& domain, const ClosestPointParams& params) const = 0;
};

struct MadeInParts {
  /// Result without tets: positive faces, their vertices in `final`, and the facts about the whole mesh.
  UmResult result;
  MeshCertificate certificate;
  std::size_t n_tets = 0, n_chosen_tets = 0;
  std::shared_ptr<const MeshInParts> mesh;
};

/// The data for rounding vertices as in a file, and for certifying them.
struct RoundedPlaces {
  double h;         ///< CertificateInput::h
  Vec3 shift;       ///< Domain::shift
  double rounding;  ///< CertificateInput::coordinate_rounding
};

/// Several processes that make a mesh together.
class PartMaker {
 public:
  virtual ~PartMaker() = default;
  /// Makes the mesh in this lattice, rounds it as in a file and certifies it. The result is bit-identical to
  /// universal_mesh() in one process. It is empty if there is no mesh; the caller then finds the reason in one process.
  /// @param box     box that the background was requested to cover
  /// @param domain  domain with the detail for places.h. It must be the same in all calls, unless
  ///                PartMesher::forget_domain() is called in between.
  /// @param seeds   seeds of SubmeshSearch::Crawl if some pieces of psi = 0 are dropped; otherwise empty
  virtual std::optional<MadeInParts> make(const BackgroundMesh& background, const Box& box, const Domain& domain,
                                          const FastParams& params, const std::vector<Vec3>& seeds,
                                          const RoundedPlaces& places) = 0;
  /// The number of processes.
  virtual int n() const = 0;
};

}  // namespace umtet
