#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "reconstruct/io/detail/cloud_source.h"
#include "reconstruct/io/detail/clouds/field_columns.h"

namespace umtet::detail {

/// Columns of a cloud file: x, y, z and, if present, the normal, the label and the origin, consecutively in this order;
/// and other data of points.
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

/// Finds the columns of x, y, z, the normal (nx ny nz or normal_x normal_y normal_z), the label (label, else patch),
/// the origin (sx sy sz or origin_x origin_y origin_z, if all three exist) and the fields (field_columns()) among
/// `names`.
/// @param kind  word of the format for a column ("property", "field")
/// \throw CloudRefused if one of them is missing or repeated; all of the normal may be missing if the source does not
///        need normals
CloudColumns cloud_columns(const CloudSource& source, const std::vector<std::string>& names, std::string_view kind);

/// Prepares an empty cloud for n points. \pre n has been compared with the size of the file
void begin_cloud(OrientedPointCloud& cloud, const CloudColumns& columns, std::size_t n);

/// Appends the point (x, y, z) and, if present, the normal (nx, ny, nz), the label, the origin and the fields from
/// these columns of `values`. \pre begin_cloud()
/// \throw CloudRefused if the label is not a whole number of 32 bits
void append_point(const CloudSource& source, OrientedPointCloud& cloud, const std::vector<double>& values,
                  const CloudColumns& columns);

}  // namespace umtet::detail
