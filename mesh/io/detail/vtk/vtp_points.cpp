// The points of VTK PolyData in XML.
#include <cstdint>
#include <limits>
#include <optional>

#include "common/vtk_xml/array_reader.h"
#include "mesh/io/points_io.h"

namespace umtet {
namespace {

constexpr std::uint64_t kMostVtpPoints = std::numeric_limits<int>::max();

class VtpReader {
 public:
  explicit VtpReader(const std::filesystem::path& path)
      : source_(path, [](const std::string& file, const std::string& what) { throw MeshFileRefused(file, "", what); }),
        tags_(source_),
        arrays_(source_) {}

  PointFile read();

 private:
  void take_array(const detail::XmlTag& tag);
  void take_points(const detail::XmlArray& array);
  void take_data(const detail::XmlArray& array);

  detail::ByteStream source_;
  detail::XmlTags tags_;
  detail::ArrayReader arrays_;
  std::optional<std::uint64_t> n_points_;
  PointFile file_;
};

void VtpReader::take_points(const detail::XmlArray& array) {
  if (array.n_components != 3 || !file_.points.empty())
    source_.refuse("Points: one array of three components is wanted");
  arrays_.read(array, 3 * *n_points_, {.doubles = [this, k = 0](std::span<const double> some) mutable {
                 for (const double v : some) {
                   if (k == 0) file_.points.emplace_back();
                   file_.points.back()[k] = v;
                   k = (k + 1) % 3;
                 }
               }});
}

void VtpReader::take_data(const detail::XmlArray& array) {
  const bool is_known = !array.name.empty() && !file_.point_data.contains(array.name) && array.n_components == 1;
  if (!is_known) return arrays_.read(array, array.n_components * *n_points_, {});
  FieldValues& values = file_.point_data[array.name];
  if (array.type && array.type->kind == detail::NumberType::Kind::Float) {
    auto& list = values.emplace<std::vector<double>>();
    arrays_.read(array, *n_points_, {.doubles = [&list](std::span<const double> some) {
                   list.insert(list.end(), some.begin(), some.end());
                 }});
  } else if (array.type_name == "UInt8") {
    auto& list = values.emplace<std::vector<std::uint8_t>>();
    arrays_.read(array, *n_points_, {.integers = [&list](std::span<const std::int64_t> some) {
                   for (const std::int64_t v : some) list.push_back(static_cast<std::uint8_t>(v));
                 }});
  } else {
    auto& list = values.emplace<std::vector<std::int64_t>>();
    arrays_.read(array, *n_points_, {.integers = [&list](std::span<const std::int64_t> some) {
                   list.insert(list.end(), some.begin(), some.end());
                 }});
  }
}

void VtpReader::take_array(const detail::XmlTag& tag) {
  const detail::XmlArray array = arrays_.array(tag);
  const std::string_view section = tags_.parent();
  if (n_points_ && section == "Points") return take_points(array);
  if (n_points_ && section == "PointData" && array.type_name != "String") return take_data(array);
  if (array.format == detail::XmlArray::Format::Appended) return;
  if (!tag.is_empty) source_.skip_to('<');
}

PointFile VtpReader::read() {
  detail::XmlTag tag;
  while (tags_.next(tag)) {
    if (tag.is_closing) continue;
    if (tags_.parent().empty()) arrays_.take_root(tag, "PolyData");
    if (tag.name == "Piece") {
      if (n_points_) source_.refuse("several pieces");
      n_points_ = tag.count("NumberOfPoints", source_);
      if (*n_points_ > kMostVtpPoints || static_cast<double>(*n_points_) > arrays_.most_values())
        source_.refuse(std::to_string(*n_points_) + " points: more than the file can hold");
    }
    if (tag.name == "DataArray" || tag.name == "Array") take_array(tag);
    if (tag.name != "AppendedData") continue;
    arrays_.read_appended(tag);
    break;
  }
  arrays_.finish();
  if (!n_points_ || file_.points.size() != *n_points_) source_.refuse("no points in this file");
  return std::move(file_);
}

}  // namespace

PointFile read_points(const std::filesystem::path& path) { return VtpReader(path).read(); }

}  // namespace umtet
