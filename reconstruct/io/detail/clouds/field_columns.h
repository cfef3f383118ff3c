#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "reconstruct/cloud/point_cloud.h"

namespace umtet::detail {

/// Columns of a cloud file besides positions, normals, labels and origins: colours, and numbers per sample.
struct FieldColumns {
  struct Scalar {
    std::size_t at = 0;
    std::string name;
  };
  std::vector<Scalar> scalars;
  std::vector<std::size_t> colour;    ///< red, green and blue, or one packed column; empty: no colours
  double bytes_per_unit = 1;          ///< factor from a colour's value to 0..255
  std::vector<std::size_t> merged;    ///< count and spread, if both exist: kCount, kSpread; else empty
  std::vector<std::string> left_out;  ///< names of scalars beyond kMostFields, and of duplicates

  /// All columns that append_fields() reads.
  std::vector<std::size_t> wanted() const;
};

/// The name that readers give to a column 0x00rrggbb.
inline constexpr std::string_view kPackedColour = "packed rgb";

/// Columns of a cloud merged by this library (merged_samples.h).
inline constexpr std::string_view kCount = "umtet_count", kSpread = "umtet_spread";

/// True if a name has another meaning than a scalar field.
bool is_reserved(std::string_view name);

/// Finds the columns of red, green and blue, if all exist, and of every other name that is not reserved and contains no
/// blank (readers insert a blank for columns without numbers). Names of scalars keep 40 letters, digits, '_', '-' and
/// '.'; other characters are replaced by '_'.
FieldColumns field_columns(const std::vector<std::string>& names);

/// Names the fields of an empty cloud, and reserves memory for n points.
void begin_fields(OrientedPointCloud& cloud, const FieldColumns& columns, std::size_t n);

/// Appends the values of the columns for the next point. A colour that is not a number becomes black, an invalid count
/// 0.
void append_fields(OrientedPointCloud& cloud, const FieldColumns& columns, const std::vector<double>& values);

}  // namespace umtet::detail
