#pragma once

#include <optional>
#include <string>

namespace umtet {

/// Which values of an image are inside of the body: what mesh.level says.
struct LevelRange {
  enum class Side { Either, Above, Below, Between };
  Side side = Side::Either;
  double low = 0, high = 0;  ///< the same but for Between
};

/// "300" is either side, "300:" above, ":300" below, "200:500" between; none for an empty text.
/// \throw UsageError  anything else
std::optional<LevelRange> parse_level(const std::string& text);

}  // namespace umtet
