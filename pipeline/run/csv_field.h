#pragma once

#include <algorithm>
#include <string>

namespace umtet {

/// Returns a field of CSV: in quotes, on one line.
inline std::string csv_field(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  for (std::size_t k = 0; (k = text.find('"', k)) != std::string::npos; k += 2) text.insert(k, 1, '"');
  return '"' + text + '"';
}

}  // namespace umtet
