#pragma once

#include <string>
#include <string_view>

namespace umtet::detail {

/// A piece of a file in a form that is safe on a terminal: quoted, clipped to 40 characters, with '?' for unprintable
/// bytes.
inline std::string in_quotes(std::string_view text) {
  constexpr std::size_t kShown = 40;
  std::string shown(text.substr(0, kShown));
  for (char& c : shown)
    if (c < ' ' || c > '~') c = '?';
  return "'" + shown + (text.size() > kShown ? "...'" : "'");
}

}  // namespace umtet::detail
