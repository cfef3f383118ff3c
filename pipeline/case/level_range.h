#pragma once

#include <optional>
#include <string>

namespace umtet {

/// The values of an image that are inside the body, as mesh.level specifies them.
struct LevelRange {
  enum class Side { Either, Above, Below, Between };
  Side side = Side::Either;
  double low = 0, high = 0;  ///< equal except for Side::Between
};

/// Parses a level: "300" is either side, "300:" above, ":300" below, "200:500" between. Returns nothing for an
/// empty text.
/// \throw UsageError  any other text
std::optional<LevelRange> parse_level(const std::string& text);

}  // namespace umtet
