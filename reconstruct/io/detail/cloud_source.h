#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "reconstruct/io/detail/field_columns.h"
#include "reconstruct/io/point_cloud_io.h"

namespace umtet::detail {

class FileBytes;

/// A cloud file in memory, or its beginning, and its name for messages. The bytes outlive every reader.
struct CloudSource {
  std::string name;
  std::string_view bytes;
  bool needs_normals = true;  ///< false: points without normals make a cloud without normals
  /// Of the file, behind `bytes`. The readers need all of it, check_ply_head() and the like do not.
  std::size_t bytes_left_out = 0;
  FileBytes* rest =
      nullptr;  ///< what reads them block by block (ByteWindow); null: there are none, or all are in memory

  std::size_t size() const { return bytes.size() + bytes_left_out; }  ///< of the file
};

/// \throw CloudRefused  always: "NAME: what"
[[noreturn]] void refuse(const CloudSource& source, const std::string& what);

/// A piece of a file as it may be shown on a terminal: quoted, clipped to 40 characters, unprintable bytes as '?'.
std::string in_quotes(std::string_view text);

/// Columns of x, y, z and, where there are any, of the normal, the label and the origin, in this order, one right
/// behind the other; and of what else belongs to a point.
struct CloudColumns {
  std::array<std::size_t, 10> at{};
  bool has_normals = true;
  bool has_labels = false;
  bool has_origins = false;
  FieldColumns fields = {};

  std::size_t n_before_label() const { return has_normals ? 6 : 3; }
  std::size_t n_before_origin() const { return n_before_label() + (has_labels ? 1 : 0); }
  std::size_t label() const { return at[n_before_label()]; }
  const std::size_t* begin() const { return at.data(); }
  const std::size_t* end() const { return at.data() + n_before_origin() + (has_origins ? 3 : 0); }
};

/// Where x, y, z, the normal (nx ny nz or normal_x normal_y normal_z), the label (label, else patch) and the origin (sx
/// sy sz or origin_x origin_y origin_z, if all three are there) are among `names`, and what field_columns() finds.
/// \throw CloudRefused  one of them missing, unless all of the normal are and the source does not need them, or there
/// twice; `kind` ("property", "field") is the format's word for them
CloudColumns cloud_columns(const CloudSource& source, const std::vector<std::string>& names, std::string_view kind);

/// Makes an empty cloud ready for n points. \pre n has been compared with the size of the file
void begin_cloud(OrientedPointCloud& cloud, const CloudColumns& columns, std::size_t n);

/// Appends the point (x, y, z) and, where there are, the normal (nx, ny, nz), the label, the origin and the fields
/// found in values at columns. \pre begin_cloud() \throw CloudRefused  the label is not a whole number of 32 bits
void append_point(const CloudSource& source, OrientedPointCloud& cloud, const std::vector<double>& values,
                  const CloudColumns& columns);

/// \throw CloudRefused  anything but blanks and NUL padding from `offset` on: then a count of the header is wrong
void refuse_surplus(const CloudSource& source, std::size_t offset);
/// The same of some bytes of the file. @param offset  where they begin
void refuse_surplus(const CloudSource& source, std::string_view bytes, std::size_t offset);

/// What the beginning of a file is enough for: its header and, of binary files, counts against the size of the file; of
/// XYZ the rows that are there. Headers are shorter than this beginning.
/// \throw CloudRefused  as the reader would
void check_ply_head(const CloudSource& head);
void check_pcd_head(const CloudSource& head);
void check_xyz_head(const CloudSource& head);

/// Whether the points are stored as numbers one after the other, so that a block of them can be read at a time.
bool is_in_blocks_ply(const CloudSource& head);
bool is_in_blocks_pcd(const CloudSource& head);

/// One reader per format. They check the shape of the file; what the numbers are is checked by read_point_cloud.
/// \throw CloudRefused
CloudFile read_ply(const CloudSource& source);
CloudFile read_pcd(const CloudSource& source);
CloudFile read_xyz(const CloudSource& source);

}  // namespace umtet::detail
