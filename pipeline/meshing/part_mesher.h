#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mesh/background/background_mesh.h"
#include "mesh/certify/certificate.h"
#include "mesh/fast/fast_params.h"
#include "mesh/implicit/closest_point.h"
#include "mesh/io/solver_mesh.h"
#include "mesh/io/tet_mesh_io.h"
#include "mesh/submesh/um_result.h"
#include "pipeline/case/exit_code.h"
#include "pipeline/case/parameters.h"
#include "body/body.h"
#include "pipeline/reports/certificate_report.h"
#include "reconstruct/solve/multilevel_fit.h"

// A mesh that several processes make, and that none of them has as a whole. Who they are and how they speak with each
// other is not known here.
namespace umtet {

/// Processes were called for different meshes. what() says what differs.
struct CallsDiffer : UsageError {
  using UsageError::UsageError;
};

enum class MeshState {
  Chosen,     ///< vertices where the background has them
  Projected,  ///< UmResult::projected
  Final,
};

/// Files that processes write together, or each its own.
enum class PieceFormat {
  Pvtu,  ///< write_pvtu()
  Msh,   ///< write_msh_pieces()
  Xdmf,  ///< write_whole_xdmf()
};

/// Point data besides those of all meshes, of the vertices of the boundary alone.
struct BoundaryData {
  struct Array {
    std::string name;
    FieldValues values;  ///< by place in `vertices`, then in CurvedInParts::mid_sides; numbers in double, or three
    double none;         ///< of all other vertices
  };
  std::vector<std::int64_t> vertices;  ///< ids in the background, ascending
  std::vector<Array> arrays;           ///< ascending by name
};

/// Patches of the boundary faces in their order, as SolverMesh has them, and what their vertices carry.
struct PieceData {
  std::vector<MeshPart> patches;
  int body_number = 1;
  std::vector<int> face_patch;
  BoundaryData of_vertices;
};

/// What there is of a mesh of second order besides.
struct CurvedInParts {
  SecondOrderReport report;
  std::vector<Vec3> mid_sides;  ///< those of boundary edges
};

/// Such a mesh. It is gone everywhere when the last who has this is.
class MeshInParts {
 public:
  virtual ~MeshInParts() = default;
  /// What one process makes by curved_mesh() and measures of it: MeshState::Final is of second order from now on.
  /// @param domain  that it was made in
  virtual CurvedInParts curve(const Domain& domain, const ClosestPointParams& params) const = 0;
  /// The .vtu that one process writes of this state, of all tets or of those with a vertex that moves.
  /// @param data  names are greater than those of standard data
  /// \throw std::system_error naming the file
  virtual void write(const std::filesystem::path& file, MeshState state, bool moving_alone,
                     const BoundaryData& data = {}) const = 0;
  /// quality.csv. \throw std::system_error naming the file
  virtual void write_quality(const std::filesystem::path& file) const = 0;
  /// Of the final state, all named after this file.
  /// @param data  null: patches are connected pieces of the boundary. PieceFormat::Xdmf has no other
  /// @return what was written, data before what refers to it \throw std::system_error naming a file
  virtual std::vector<std::filesystem::path> write_pieces(const std::filesystem::path& file, PieceFormat format,
                                                          const PieceData* data) const = 0;
};

/// With what this process knows of its boundary.
struct MeshWithBoundary {
  std::shared_ptr<const MeshInParts> mesh;
  std::vector<Vec3> V;          ///< vertices of the boundary, model coordinates
  std::vector<Triangle> faces;  ///< in their order in the whole mesh
  BoundaryData data;
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
  /// Bytes that a mesh may take in all processes together: output.max_memory in each, or what machines like this one
  /// can give.
  virtual double allowed_bytes(const Parameters& parameters) const = 0;
  /// What one process makes in this lattice by universal_mesh(), rounds to a file and certifies: the same to the bit.
  /// None where there is no mesh; why, one process finds out.
  /// @param box     that the background was asked to cover
  /// @param domain  cut for places.h; the same one whenever this is called, unless forget_domain() is called before
  /// @param seeds   of SubmeshSearch::Crawl, where some pieces of psi = 0 are left out; else empty
  virtual std::optional<MadeInParts> make(const BackgroundMesh& background, const Box& box, const Domain& domain,
                                          const FastParams& params, const std::vector<Vec3>& seeds,
                                          const RoundedPlaces& places) = 0;
  /// The next mesh is one of another domain: of a fit, or of the formula at another t.
  virtual void forget_domain(std::optional<double> t) = 0;
  /// How many processes.
  virtual int n() const = 0;
  /// Threads of each while all work; what this one does alone has those of the program.
  virtual void set_threads(int n) = 0;
  /// Who makes the bands of a fit before; null: this process does.
  virtual BandRefiner* bands() { return nullptr; }
};

/// Why a mesh of these parameters is for one process; empty if it is not, as far as they say.
std::string for_one_process(const Parameters& parameters);

}  // namespace umtet
