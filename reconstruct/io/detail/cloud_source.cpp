#include "reconstruct/io/detail/cloud_source.h"

#include <fmt/format.h>

#include <utility>

namespace umtet::detail {

void refuse(const CloudSource& source, Message what) { throw CloudRefused(source.name + ": " + std::move(what)); }

void refuse_surplus(const CloudSource& source, std::size_t offset) {
  if (offset < source.bytes.size()) refuse_surplus(source, source.bytes.substr(offset), offset);
}

void refuse_surplus(const CloudSource& source, std::string_view bytes, std::size_t offset) {
  constexpr std::string_view kPadding{" \t\r\n\0", 5};
  const std::size_t surplus = bytes.find_first_not_of(kPadding);
  if (surplus != std::string_view::npos)
    refuse(source, fmt::format("byte {}: data go on after the last item the header announces: its counts or types do "
                               "not fit the data, export the file again",
                               offset + surplus));
}

}  // namespace umtet::detail
