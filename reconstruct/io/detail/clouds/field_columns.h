#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "reconstruct/cloud/point_cloud.h"

namespace umtet::detail {

/// Columns of a cloud file besides places, normals, labels and origins: colours, and numbers that belong to a sample.
struct FieldColumns {
  struct Scalar {
    std::size_t at = 0;
    std::string name;
  };
  std::vector<Scalar> scalars;
  std::vector<std::size_t> colour;    ///< of red, green and blue, or one of all three, packed; empty: no colours
  double bytes_per_unit = 1;          ///< a colour's value times this is 0..255
  std::vector<std::size_t> merged;    ///< of count and spread, where both are there: kCount, kSpread; or empty
  std::vector<std::string> left_out;  ///< names of scalars beyond kMostFields, and of those that are there twice

  /// All that append_fields() looks at.
  std::vector<std::size_t> wanted() const;
};

/// The name that a reader gives to a column 0x00rrggbb.
inline constexpr std::string_view kPackedColour = "packed rgb";

/// Columns of a cloud that we have merged (merged_samples.h).
inline constexpr std::string_view kCount = "umtet_count", kSpread = "umtet_spread";

/// Whether a name means something else than a scalar field.
bool is_reserved(std::string_view name);

/// Of red, green and blue, where all are there, and of every other name that is not reserved and has no blank in it
/// (readers put one into what is no number). Names of scalars keep 40 letters, digits, '_', '-' and '.'; '_' stands for
/// what is none of these.
FieldColumns field_columns(const std::vector<std::string>& names);

/// Names the fields of an empty cloud, and reserves memory for n points.
void begin_fields(OrientedPointCloud& cloud, const FieldColumns& columns, std::size_t n);

/// What the columns hold for the next point. A colour that is no number is black, a count that is none is 0.
void append_fields(OrientedPointCloud& cloud, const FieldColumns& columns, const std::vector<double>& values);

}  // namespace umtet::detail
