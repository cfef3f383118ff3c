#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

// Text between the arrays of VTK XML files, as written by this project.
namespace umtet::detail {

template <typename T>
inline constexpr const char* kVtkType = nullptr;
template <>
inline constexpr const char* kVtkType<double> = "Float64";
template <>
inline constexpr const char* kVtkType<std::int64_t> = "Int64";
template <>
inline constexpr const char* kVtkType<std::int32_t> = "Int32";
template <>
inline constexpr const char* kVtkType<std::uint8_t> = "UInt8";

inline constexpr const char* kThreeComponents = " NumberOfComponents=\"3\"";

/// Escapes a name for an XML attribute.
inline std::string escaped(const std::string& name) {
  std::string text;
  for (const char c : name) {
    text += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '"' ? "&quot;" : std::string(1, c);
  }
  return text;
}

/// @param type  type of the grid
inline std::string file_begin(const std::string& type) {
  return "<?xml version=\"1.0\"?>\n<VTKFile type=\"" + type +
         "\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<" + type + ">\n";
}

inline std::string piece_begin(std::size_t n_points, const std::string& counted, std::size_t n_cells) {
  return "<Piece NumberOfPoints=\"" + std::to_string(n_points) + "\" " + counted + "=\"" + std::to_string(n_cells) +
         "\">\n";
}

inline std::string file_end(const std::string& type) { return "</Piece>\n</" + type + ">\n</VTKFile>\n"; }

inline std::string array_begin(const std::string& type, const std::string& name, const std::string& attributes) {
  return "<DataArray type=\"" + type + "\" Name=\"" + escaped(name) + "\"" + attributes + " format=\"binary\">\n";
}

inline constexpr std::string_view kArrayEnd = "\n</DataArray>\n";

}  // namespace umtet::detail
