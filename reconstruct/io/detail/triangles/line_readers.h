#pragma once

#include "reconstruct/io/detail/cloud_source.h"
#include "reconstruct/io/feature_lines_io.h"

namespace umtet::detail {

/// One reader per format of read_feature_lines(). \throw CloudRefused
FeatureLinesFile read_feat(const CloudSource& source);
FeatureLinesFile read_emesh(const CloudSource& source);
FeatureLinesFile read_obj_lines(const CloudSource& source);

/// Appends a point of a file. \throw CloudRefused  a coordinate that is not finite or beyond 1e50
void add_point(const CloudSource& source, std::size_t line, const Vec3& x, FeatureLinesFile& lines);

}  // namespace umtet::detail
