#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "reconstruct/io/detail/cloud_source.h"
#include "reconstruct/io/detail/clouds/field_columns.h"

namespace umtet::detail {

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

}  // namespace umtet::detail
