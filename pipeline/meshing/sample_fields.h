#pragma once

#include <limits>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "mesh/io/tet_mesh_io.h"
#include "body/body.h"

namespace umtet {

/// What the samples of a scan carry is point data of the mesh under this prefix: no name in a file can hide an array of
/// ours.
inline constexpr std::string_view kScanPrefix = "scan_";
/// Of red, green and blue.
inline constexpr const char* kScanColours = "scan_rgb";
/// Of vertices that no sample is near.
inline constexpr double kNoSample = std::numeric_limits<double>::quiet_NaN();

bool is_of_scan(std::string_view name);

/// Fields and colours of the domain's cloud at some vertices on psi = 0, into point data with one entry a vertex, by
/// fields_at() with support_radius(). Arrays that are not there yet are made, shorter ones are made longer, with NaN.
/// Nothing without fields. @param V  working coordinates \throw Cancelled
void set_sample_fields(const Domain& domain, const std::vector<Vec3>& V, const std::vector<int>& vertices,
                       std::map<std::string, FieldValues>& point_data);

}  // namespace umtet
