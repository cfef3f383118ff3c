#include "common/vtk_xml/appended_writer.h"

#include <array>

namespace umtet::detail {

std::string escaped(const std::string& name) {
  std::string text;
  for (const char c : name) {
    text += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '"' ? "&quot;" : std::string(1, c);
  }
  return text;
}

std::string piece_begin(std::size_t n_points, const std::string& counted, std::size_t n_cells) {
  return "<Piece NumberOfPoints=\"" + std::to_string(n_points) + "\" " + counted + "=\"" + std::to_string(n_cells) +
         "\">\n";
}

void AppendedLayout::begin(const std::string& type, const std::string& attributes) {
  type_ = type;
  text("<?xml version=\"1.0\"?>\n<VTKFile type=\"" + type +
       "\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<" + type + attributes + ">\n");
}

void AppendedLayout::array(const std::string& type, const std::string& name, std::uint64_t n_bytes,
                           const std::string& attributes) {
  text("<DataArray type=\"" + type + "\" Name=\"" + escaped(name) + "\"" + attributes +
       " format=\"appended\" offset=\"");
  offset_at_.push_back(tags_.size());
  text("\"/>\n");
  arrays_.push_back({name, 0, n_bytes});
}

void AppendedLayout::close() {
  text("</" + type_ + ">\n<AppendedData encoding=\"raw\">\n_");
  std::uint64_t offset = 0;
  for (std::size_t a = arrays_.size(); a-- > 0;) {
    tags_.insert(offset_at_[a], std::to_string(offset));
    arrays_[a].begin = offset + sizeof arrays_[a].n_bytes;
    offset = arrays_[a].begin + arrays_[a].n_bytes;
  }
  for (Array& array : arrays_) array.begin += tags_.size();
}

std::string AppendedLayout::count(const Array& array) {
  const auto bytes = std::bit_cast<std::array<char, sizeof array.n_bytes>>(array.n_bytes);
  return {bytes.begin(), bytes.end()};
}

void AppendedWriter::write(const Put& put) {
  layout_.close();
  put(layout_.tags());
  for (std::size_t a = arrays_.size(); a-- > 0;) {
    put(AppendedLayout::count(layout_.arrays()[a]));
    arrays_[a](put);
  }
  put(AppendedLayout::kEnd);
}

}  // namespace umtet::detail
