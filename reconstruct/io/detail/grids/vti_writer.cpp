#include "reconstruct/io/detail/grids/vti_writer.h"

#include <fmt/format.h>
#include <vtkBase64Utilities.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <system_error>

namespace umtet::detail {

VtiWriter& VtiWriter::text(std::string_view text) {
  out_.write(text.data(), static_cast<std::streamsize>(text.size()));
  return *this;
}

template <class T>
VtiWriter& VtiWriter::array(const std::string& attributes, const std::vector<T>& values) {
  constexpr std::size_t kPiece = 3 << 14;  // bytes encoded at once: whole groups of three
  std::vector<unsigned char> raw(kPiece), base64(kPiece / 3 * 4);
  text(fmt::format("<DataArray type=\"Float{}\" {} format=\"binary\">\n", 8 * sizeof(T), attributes));
  const std::uint64_t n_bytes = values.size() * sizeof(T);
  std::memcpy(raw.data(), &n_bytes, sizeof(n_bytes));  // the block begins with its length
  const auto* from = reinterpret_cast<const unsigned char*>(values.data());
  std::size_t n_raw = sizeof(n_bytes), left = n_bytes;
  do {
    const std::size_t some = std::min(left, kPiece - n_raw);
    std::copy_n(from, some, raw.begin() + static_cast<std::ptrdiff_t>(n_raw));
    const auto n_text = vtkBase64Utilities::Encode(raw.data(), n_raw + some, base64.data());
    out_.write(reinterpret_cast<const char*>(base64.data()), static_cast<std::streamsize>(n_text));
    from += some, left -= some, n_raw = 0;
  } while (left > 0);
  return text("\n</DataArray>\n");
}

VtiWriter& VtiWriter::field(const std::string& name, const std::vector<double>& values) {
  return array(fmt::format("Name=\"{}\" NumberOfTuples=\"{}\"", name, values.size()), values);
}
VtiWriter& VtiWriter::field(const std::string& name, const std::vector<float>& values) {
  return array(fmt::format("Name=\"{}\" NumberOfTuples=\"{}\"", name, values.size()), values);
}
VtiWriter& VtiWriter::points(const std::string& name, const std::vector<double>& values) {
  return array(fmt::format("Name=\"{}\"", name), values);
}

void VtiWriter::close() {
  out_.close();
  if (!out_) {
    throw std::system_error(errno ? errno : EIO, std::generic_category(),
                            fmt::format("{}: could not be written completely", path_.string()));
  }
}

}  // namespace umtet::detail
