#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "mesh/background/background_mesh.h"
#include "mesh/certify/certificate.h"
#include "mesh/core/implicit_function.h"
#include "mesh/fast/fast_params.h"
#include "mesh/submesh/um_result.h"
#include "pipeline/case/parameters.h"

// A mesh that several processes make, and that none of them has as a whole. Who they are and how they speak with each
// other is not known here.
namespace umtet {

enum class MeshState {
  Chosen,     ///< vertices where the background has them
  Projected,  ///< UmResult::projected
  Final,
};

/// Such a mesh. It is gone everywhere when the last who has this is.
class MeshInParts {
 public:
  virtual ~MeshInParts() = default;
  /// The .vtu that one process writes of this state, of all tets or of those with a vertex that moves.
  /// \throw std::system_error naming the file
  virtual void write(const std::filesystem::path& file, MeshState state, bool moving_alone) const = 0;
  /// quality.csv. \throw std::system_error naming the file
  virtual void write_quality(const std::filesystem::path& file) const = 0;
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

class PartMesher {
 public:
  virtual ~PartMesher() = default;
  /// What one process makes in this lattice by universal_mesh(), rounds to a file and certifies: the same to the bit.
  /// None where there is no mesh; why, one process finds out.
  virtual std::optional<MadeInParts> make(const BackgroundMesh& background, ImplicitFunctionRef psi,
                                          const FastParams& params, const RoundedPlaces& places) = 0;
};

/// Why a mesh of these parameters is for one process; empty if it is not.
std::string for_one_process(const Parameters& parameters);

}  // namespace umtet
