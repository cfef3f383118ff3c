#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "body/errors.h"
#include "body/search/part_maker.h"
#include "mesh/io/solver_mesh.h"
#include "mesh/io/tet_mesh_io.h"
#include "pipeline/case/parameters.h"
#include "reconstruct/solve/multilevel_fit.h"

// Files of a mesh that several processes make, and what the program asks of these.
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

/// A mesh in parts that its processes write to files.
class WrittenInParts : public MeshInParts {
 public:
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

/// The mesh of an attempt that a PartMesher has made. \pre mesh is not null
std::shared_ptr<const WrittenInParts> written_in_parts(const std::shared_ptr<const MeshInParts>& mesh);

/// With what this process knows of its boundary.
struct MeshWithBoundary {
  std::shared_ptr<const WrittenInParts> mesh;
  std::vector<Vec3> V;          ///< vertices of the boundary, model coordinates
  std::vector<Triangle> faces;  ///< in their order in the whole mesh
  BoundaryData data;
};

/// Processes of the program. All meshes that they make are WrittenInParts.
class PartMesher : public PartMaker {
 public:
  /// Bytes that a mesh may take in all processes together: output.max_memory in each, or what machines like this one
  /// can give.
  virtual double allowed_bytes(const Parameters& parameters) const = 0;
  /// The next mesh is one of another domain: of a fit, or of the formula at another t.
  virtual void forget_domain(std::optional<double> t) = 0;
  /// Threads of each while all work; what this one does alone has those of the program.
  virtual void set_threads(int n) = 0;
  /// Who makes the bands of a fit before; null: this process does.
  virtual BandRefiner* bands() { return nullptr; }
};

/// Why a mesh of these parameters is for one process; empty if it is not, as far as they say.
std::string for_one_process(const Parameters& parameters);

}  // namespace umtet
