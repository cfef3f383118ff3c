#include "mesh/io/pvtu.h"

#include <type_traits>
#include <variant>

#include "common/vtk_xml/appended_writer.h"

namespace umtet {
namespace {

std::string array_text(const std::string& type, const std::string& name, bool has_three) {
  return "<PDataArray type=\"" + type + "\" Name=\"" + detail::escaped(name) + "\"" +
         (has_three ? detail::kThreeComponents : "") + "/>\n";
}

std::string data_text(const std::string& section, const std::map<std::string, FieldValues>& data) {
  std::string text = "<" + section + ">\n";
  for (const auto& [name, any] : data) {
    text += std::visit(
        [&, &name = name](const auto& values) {
          using Value = typename std::decay_t<decltype(values)>::value_type;
          constexpr bool kIsVector = std::is_same_v<Value, Vec3>;
          return array_text(detail::kVtkType<std::conditional_t<kIsVector, double, Value>>, name, kIsVector);
        },
        any);
  }
  return text + "</" + section + ">\n";
}

}  // namespace

std::string pvtu_text(const std::map<std::string, FieldValues>& point_data,
                      const std::map<std::string, FieldValues>& cell_data, const std::vector<std::string>& pieces) {
  std::string text =
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"PUnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" "
      "header_type=\"UInt64\">\n<PUnstructuredGrid GhostLevel=\"0\">\n";
  text += data_text("PPointData", point_data) + data_text("PCellData", cell_data);
  text += "<PPoints>\n" + array_text("Float64", "Points", true) + "</PPoints>\n";
  for (const std::string& piece : pieces) text += "<Piece Source=\"" + detail::escaped(piece) + "\"/>\n";
  return text + "</PUnstructuredGrid>\n</VTKFile>\n";
}

}  // namespace umtet
