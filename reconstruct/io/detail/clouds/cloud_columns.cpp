#include "reconstruct/io/detail/clouds/cloud_columns.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace umtet::detail {

CloudColumns cloud_columns(const CloudSource& source, const std::vector<std::string>& names, std::string_view kind) {
  const auto count = [&](std::string_view name) { return std::count(names.begin(), names.end(), name); };
  const bool long_names = count("normal_x") + count("normal_y") + count("normal_z") > 0;
  const std::array<std::string_view, 3> normal =
      long_names ? std::array<std::string_view, 3>{"normal_x", "normal_y", "normal_z"}
                 : std::array<std::string_view, 3>{"nx", "ny", "nz"};
  const std::array<std::string_view, 6> wanted = {"x", "y", "z", normal[0], normal[1], normal[2]};
  const bool without_normals = count(normal[0]) + count(normal[1]) + count(normal[2]) == 0;
  if (source.needs_normals && without_normals && count("x") + count("y") + count("z") == 3)
    refuse(source,
           fmt::format("the points have no normals (no {} nx, ny, nz or normal_x, normal_y, normal_z): estimate "
                       "and orient them first, for example in CloudCompare or MeshLab",
                       kind));

  CloudColumns columns;
  columns.has_normals = source.needs_normals || !without_normals;
  for (std::size_t c = 0; c < (columns.has_normals ? wanted.size() : 3); ++c) {
    if (count(wanted[c]) == 0)
      refuse(source, fmt::format("the points have no {} {}: export them with x y z nx ny nz", kind, wanted[c]));
    if (count(wanted[c]) > 1) refuse(source, fmt::format("the points have {} {} more than once", kind, wanted[c]));
    columns.at[c] = static_cast<std::size_t>(std::find(names.begin(), names.end(), wanted[c]) - names.begin());
  }
  for (const std::string_view name : {"label", "patch"}) {
    if (columns.has_labels || count(name) == 0) continue;
    if (count(name) > 1) refuse(source, fmt::format("the points have {} {} more than once", kind, name));
    columns.has_labels = true;
    columns.at[columns.n_before_label()] =
        static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
  }
  using Origin = std::array<std::string_view, 3>;
  for (const Origin& origin : {Origin{"sx", "sy", "sz"}, Origin{"origin_x", "origin_y", "origin_z"}}) {
    const bool is_there = std::all_of(origin.begin(), origin.end(), [&](auto name) { return count(name) == 1; });
    if (columns.has_origins || !is_there) continue;
    columns.has_origins = true;
    for (std::size_t c = 0; c < 3; ++c) {
      columns.at[columns.n_before_origin() + c] =
          static_cast<std::size_t>(std::find(names.begin(), names.end(), origin[c]) - names.begin());
    }
  }
  columns.fields = field_columns(names);
  return columns;
}

void begin_cloud(OrientedPointCloud& cloud, const CloudColumns& columns, std::size_t n) {
  cloud.points.reserve(n);
  if (columns.has_normals) cloud.normals.reserve(n);
  if (columns.has_labels) cloud.labels.reserve(n);
  if (columns.has_origins) cloud.origins.reserve(n);
  begin_fields(cloud, columns.fields, n);
}

void append_point(const CloudSource& source, OrientedPointCloud& cloud, const std::vector<double>& values,
                  const CloudColumns& columns) {
  const auto& at = columns.at;
  cloud.points.emplace_back(values[at[0]], values[at[1]], values[at[2]]);
  if (columns.has_normals) cloud.normals.emplace_back(values[at[3]], values[at[4]], values[at[5]]);
  if (columns.has_origins) {
    const std::size_t* const o = at.data() + columns.n_before_origin();
    cloud.origins.emplace_back(values[o[0]], values[o[1]], values[o[2]]);
  }
  append_fields(cloud, columns.fields, values);
  if (!columns.has_labels) return;
  const double label = values[columns.label()];
  if (label != std::trunc(label) || std::abs(label) > std::numeric_limits<int>::max()) {
    refuse(source, fmt::format("point {} (counted from 1): its label is {}: labels are whole numbers of 32 bits",
                               cloud.points.size(), label));
  }
  cloud.labels.push_back(static_cast<int>(label));
}

}  // namespace umtet::detail
