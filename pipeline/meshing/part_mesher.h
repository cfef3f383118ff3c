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

// Files of a mesh that several processes make, and the interface by which the program uses these processes.
namespace umtet {

/// The processes were called with different requests. what() describes the difference.
struct CallsDiffer : UsageError {
  using UsageError::UsageError;
};

enum class MeshState {
  Chosen,     ///< vertices at their positions in the background
  Projected,  ///< UmResult::projected
  Final,
};

/// Files that the processes write together, or one file per process.
enum class PieceFormat {
  Pvtu,  ///< write_pvtu()
  Msh,   ///< write_msh_pieces()
  Xdmf,  ///< write_whole_xdmf()
};

/// Additional point data for the vertices of the boundary.
struct BoundaryData {
  struct Array {
    std::string name;
    FieldValues values;  ///< in the order of `vertices`, then of CurvedInParts::mid_sides; double or three numbers
    double none;         ///< value for all other vertices
  };
  std::vector<std::int64_t> vertices;  ///< ids in the background, ascending
  std::vector<Array> arrays;           ///< ascending by name
};

/// Patches of the boundary faces in the order of SolverMesh, and data of their vertices.
struct PieceData {
  std::vector<MeshPart> patches;
  int body_number = 1;
  std::vector<int> face_patch;
  BoundaryData of_vertices;
};

/// A distributed mesh that its processes write to files.
class WrittenInParts : public MeshInParts {
 public:
  /// Writes the mesh in this state to one .vtu: all tets, or only tets with a vertex that moves.
  /// @param data  its names are alphabetically after the names of standard data
  /// \throw std::system_error  names the file
  virtual void write(const std::filesystem::path& file, MeshState state, bool moving_alone,
                     const BoundaryData& data = {}) const = 0;
  /// Writes quality.csv. \throw std::system_error  names the file
  virtual void write_quality(const std::filesystem::path& file) const = 0;
  /// Writes the final state to files whose names derive from `file`.
  /// @param data  null: patches are connected components of the boundary. PieceFormat::Xdmf supports nothing else
  /// @return the files, data before the files that refer to them \throw std::system_error  names a file
  virtual std::vector<std::filesystem::path> write_pieces(const std::filesystem::path& file, PieceFormat format,
                                                          const PieceData* data) const = 0;
};

/// Returns the mesh of an attempt that a PartMesher made. \pre mesh is not null
std::shared_ptr<const WrittenInParts> written_in_parts(const std::shared_ptr<const MeshInParts>& mesh);

/// A distributed mesh with its boundary in this process.
struct MeshWithBoundary {
  std::shared_ptr<const WrittenInParts> mesh;
  std::vector<Vec3> V;          ///< vertices of the boundary, model coordinates
  std::vector<Triangle> faces;  ///< in the order of the whole mesh
  BoundaryData data;
};

/// The processes of the program. All meshes that they make are WrittenInParts.
class PartMesher : public PartMaker {
 public:
  /// Returns the maximum memory of a mesh in all processes together, bytes: output.max_memory in each process, or the
  /// amount that machines like this one can provide.
  virtual double allowed_bytes(const Parameters& parameters) const = 0;
  /// Call it before the mesh of another domain: of a new fit, or of the formula at another t.
  virtual void forget_domain(std::optional<double> t) = 0;
  /// Sets the threads of each process while all processes work. Work of this process alone uses the threads of the
  /// program.
  virtual void set_threads(int n) = 0;
  /// Returns the object that computes the bands of a fit on all processes; null: this process computes them.
  virtual BandRefiner* bands() { return nullptr; }
};

/// The reason why one process has to make a mesh of these parameters; none if the parameters give no reason.
std::optional<Message> for_one_process(const Parameters& parameters);

}  // namespace umtet
