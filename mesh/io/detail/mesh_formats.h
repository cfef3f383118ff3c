#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "mesh/io/tet_mesh_io.h"

namespace umtet::detail {

/// Bounds-checked cursor over the bytes of a file in memory. It does not read past the end; invalid input is rejected
/// with its position.
class ByteCursor {
 public:
  /// @param comment  a word that begins with this character starts a comment up to the end of the line; '\0': no
  ///                 comments
  ByteCursor(const std::filesystem::path& path, std::string_view bytes, char comment = '\0')
      : path_(path), bytes_(bytes), comment_(comment) {}

  std::size_t position() const { return at_; }
  std::size_t remaining() const { return bytes_.size() - at_; }
  [[noreturn]] void refuse(const std::string& reason) const;
  /// The rest of the line without its end; moves to the next line.
  std::string_view line();
  /// The next word between blanks; empty at the end of the file.
  std::string_view word();
  /// The next word as a number. `what` names it in the error.
  template <typename T>
  T number(const char* what);
  /// A value stored as in memory.
  template <typename T>
  T raw(const char* what);
  void skip(std::size_t n_bytes, const char* what);
  /// Moves to the line after the first one that equals `text`; rejects the file if there is none.
  void skip_behind_line(std::string_view text);
  /// The next word as a count of records, which is rejected if they cannot fit into the file: each takes at least
  /// `least_bytes`.
  std::size_t count(const char* what, std::size_t least_bytes);
  /// Checks a count that was already read in the same way.
  std::size_t checked_count(std::uint64_t n, const char* what, std::size_t least_bytes) const;

 private:
  const std::filesystem::path& path_;
  std::string_view bytes_;
  char comment_;
  std::size_t at_ = 0;
};

/// Rejects a path that is not a regular file. \throw std::system_error naming the path
void require_regular_file(const std::filesystem::path& path);

/// Reads a regular file. The first megabyte of a large file has to contain the keyword of its format; otherwise the
/// file is rejected before the rest is read.
/// @param keyword  compared without regard to case
/// \throw std::system_error naming the path, MeshFileRefused
std::string file_bytes(const std::filesystem::path& path, std::string_view keyword);

/// Nodes and tets as stored in a file, by node number.
struct NumberedMesh {
  std::vector<std::int64_t> number;  ///< number of each node
  std::vector<Vec3> point;
  std::vector<std::array<std::int64_t, 4>> tets;  ///< node numbers
  /// For tets with ten nodes, the other six in the order of QuadraticTet.
  std::vector<std::array<std::int64_t, 6>> mid_sides;
  std::vector<std::int64_t> region = {};                  ///< mark of each tet; empty: the format has none
  std::map<std::int64_t, std::string> region_names = {};  ///< names of marks
};

using MidSideNodes = std::array<int, 6>;

/// Sorts by node number, renumbers the tets and drops unused nodes.
/// \throw MeshFileRefused for a node number that is missing or repeated, and under the conditions of
///        refuse_broken_tets()
MeshFile assemble(const std::filesystem::path& path, NumberedMesh&& numbered);

/// Checks the tets of a file.
/// \throw MeshFileRefused for a tet with a repeated node or with a node whose position is not finite, with the numbers
///        of the file: of vertex i and of tet t
void refuse_broken_tets(const std::filesystem::path& path, const TetMesh& mesh,
                        const std::function<std::int64_t(std::size_t)>& vertex_number,
                        const std::function<std::int64_t(std::size_t)>& tet_number);

/// Sets file.quadratic if there are mid-sides for every tet. Corners come first, and both kinds keep their order. Call
/// it before drop_unused_vertices().
/// @param mid_sides      indices into file.mesh.V
/// @param vertex_number  number of vertex i in the file
/// \throw MeshFileRefused for a mid-side whose position is not finite, or that is a corner
void take_mid_sides(const std::filesystem::path& path, MeshFile& file, const std::vector<MidSideNodes>& mid_sides,
                    const std::function<std::int64_t(std::size_t)>& vertex_number);

/// Drops the vertices (and their data) that no tet uses.
void drop_unused_vertices(MeshFile& file);

/// One reader per format, for read_tet_mesh().
MeshFile read_vtu(const std::filesystem::path& path);
MeshFile read_msh(const std::filesystem::path& path);
MeshFile read_medit(const std::filesystem::path& path);
MeshFile read_inp(const std::filesystem::path& path);

}  // namespace umtet::detail
