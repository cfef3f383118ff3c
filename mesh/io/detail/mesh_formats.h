#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "mesh/io/tet_mesh_io.h"

namespace umtet::detail {

/// A bounded walk over the bytes of a file that is held in memory. Nothing here reads past the end; what cannot be
/// read is refused with its place.
class ByteCursor {
 public:
  /// @param comment  a word that begins with it, and the rest of its line, is no word; '\0': there are no comments
  ByteCursor(const std::filesystem::path& path, std::string_view bytes, char comment = '\0')
      : path_(path), bytes_(bytes), comment_(comment) {}

  std::size_t position() const { return at_; }
  std::size_t remaining() const { return bytes_.size() - at_; }
  [[noreturn]] void refuse(const std::string& reason) const;
  /// The rest of the line without its end; moves behind it.
  std::string_view line();
  /// The next word between blanks, empty at the end of the file.
  std::string_view word();
  /// The next word as a number. `what` names it in the refusal.
  template <typename T>
  T number(const char* what);
  /// A value as it lies in memory.
  template <typename T>
  T raw(const char* what);
  void skip(std::size_t n_bytes, const char* what);
  /// Moves behind the first line that equals `text`, or refuses.
  void skip_behind_line(std::string_view text);
  /// The next word as a count of records, refused if they cannot fit: each takes at least `least_bytes`.
  std::size_t count(const char* what, std::size_t least_bytes);
  /// The same for a count already read.
  std::size_t checked_count(std::uint64_t n, const char* what, std::size_t least_bytes) const;

 private:
  const std::filesystem::path& path_;
  std::string_view bytes_;
  char comment_;
  std::size_t at_ = 0;
};

/// The bytes of a regular file. Of a large one the first megabyte has to hold the keyword of its format: else it is
/// refused before the rest is read.
/// @param keyword  compared without regard to case
/// \throw std::system_error naming the path, MeshFileRefused
std::string file_bytes(const std::filesystem::path& path, std::string_view keyword);

/// Nodes and tets as they stand in a file, by node number.
struct NumberedMesh {
  std::vector<std::int64_t> number;  ///< of each node
  std::vector<Vec3> point;
  std::vector<std::array<std::int64_t, 4>> tets;  ///< node numbers
  /// Of those tets that have ten nodes, the other six in the order of QuadraticTet.
  std::vector<std::array<std::int64_t, 6>> mid_sides;
};

using MidSideNodes = std::array<int, 6>;

/// Sorts by node number, renumbers the tets and drops unused nodes.
/// \throw MeshFileRefused for a node number that is missing or given twice, and as refuse_broken_tets()
MeshFile assemble(const std::filesystem::path& path, NumberedMesh&& numbered);

/// \throw MeshFileRefused for a tet with a node twice or with a node that has no finite place, by the numbers of the
///        file: of vertex i and of tet t
void refuse_broken_tets(const std::filesystem::path& path, const TetMesh& mesh,
                        const std::function<std::int64_t(std::size_t)>& vertex_number,
                        const std::function<std::int64_t(std::size_t)>& tet_number);

/// Fills file.quadratic if there are mid-sides for every tet; corners come first, and both kinds keep their order.
/// To be called before drop_unused_vertices(). @param mid_sides  indices into file.mesh.V
/// @param vertex_number  of vertex i in the file
/// \throw MeshFileRefused for a mid-side that has no finite place, or is a corner
void take_mid_sides(const std::filesystem::path& path, MeshFile& file, const std::vector<MidSideNodes>& mid_sides,
                    const std::function<std::int64_t(std::size_t)>& vertex_number);

/// Drops the vertices (and their data) that no tet uses.
void drop_unused_vertices(MeshFile& file);

MeshFile read_vtu(const std::filesystem::path& path);
MeshFile read_msh(const std::filesystem::path& path);
MeshFile read_medit(const std::filesystem::path& path);

}  // namespace umtet::detail
