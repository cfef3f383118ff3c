#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace umtet::detail {

/// Writer of the text and inline base64 arrays of a .vti file, piece by piece. VTK's own writer holds copies of the
/// arrays and the whole text twice, takes four times as long, and returns success on a full disk.
class VtiWriter {
 public:
  explicit VtiWriter(const std::filesystem::path& file) : path_(file), out_(file, std::ios::binary) {}
  VtiWriter& text(std::string_view);
  /// Writes an array of FieldData, which states its number of values.
  VtiWriter& field(const std::string& name, const std::vector<double>& values);
  VtiWriter& field(const std::string& name, const std::vector<float>& values);
  /// Writes an array of PointData.
  VtiWriter& points(const std::string& name, const std::vector<double>& values);
  /// \throw std::system_error if not everything could be written
  void close();

 private:
  template <class T>
  VtiWriter& array(const std::string& attributes, const std::vector<T>& values);

  std::filesystem::path path_;
  std::ofstream out_;
};

}  // namespace umtet::detail
