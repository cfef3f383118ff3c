#pragma once

#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "mesh/io/tet_mesh_io.h"
#include "body/body.h"

namespace umtet {

/// Prefix of point data that come from the samples of a scan. It keeps the names of a file apart from the names of
/// umtet.
inline constexpr std::string_view kScanPrefix = "scan_";
/// Name of the array with red, green and blue.
inline constexpr const char* kScanColours = "scan_rgb";
/// Value at vertices without a sample nearby.
inline constexpr double kNoSample = std::numeric_limits<double>::quiet_NaN();

bool is_of_scan(std::string_view name);

/// Stores fields and colours of the domain's cloud at some vertices on psi = 0 in point data with one entry per vertex,
/// by fields_at() with support_radius(). Missing arrays are created, and shorter arrays are extended with NaN. Does
/// nothing without fields. @param V  working coordinates \throw Cancelled
void set_sample_fields(const Domain& domain, const std::vector<Vec3>& V, const std::vector<int>& vertices,
                       std::map<std::string, FieldValues>& point_data);

}  // namespace umtet
