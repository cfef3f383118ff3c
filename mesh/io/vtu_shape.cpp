#include "mesh/io/vtu_shape.h"

#include <vtkBase64Utilities.h>

#include <limits>

#include "mesh/io/detail/vtk_xml_text.h"

namespace umtet {
namespace {

class ShapeOfVtu {
 public:
  void text(std::string_view s) { text_ += s; }
  void array(const std::string& type, const std::string& name, std::uint64_t n_bytes, const char* attributes = "") {
    text(detail::array_begin(type, name, attributes));
    flush();
    shape_.arrays.push_back({name, at_, n_bytes});
    at_ += 4 * ((shape_.arrays.back().n_encoded() + 2) / 3);
    text(detail::kArrayEnd);
  }
  void fields(const std::string& section, std::size_t n, const std::vector<VtuField>& fields) {
    text("<" + section + ">\n");
    for (const VtuField& f : fields) {
      switch (f.type) {
        case VtuField::Type::Float64:
          array(detail::kVtkType<double>, f.name, 8 * n);
          break;
        case VtuField::Type::Int64:
          array(detail::kVtkType<std::int64_t>, f.name, 8 * n);
          break;
        case VtuField::Type::UInt8:
          array(detail::kVtkType<std::uint8_t>, f.name, n);
          break;
        case VtuField::Type::ThreeFloat64:
          array(detail::kVtkType<double>, f.name, 24 * n, detail::kThreeComponents);
          break;
      }
    }
    text("</" + section + ">\n");
  }
  VtuShape shape() && {
    flush();
    return std::move(shape_);
  }

 private:
  void flush() {
    if (text_.empty()) return;
    shape_.texts.emplace_back(at_, text_);
    at_ += text_.size();
    text_.clear();
  }

  std::string text_;
  std::uint64_t at_ = 0;
  VtuShape shape_;
};

}  // namespace

VtuShape vtu_shape(std::size_t n_points, std::size_t n_tets, const std::vector<VtuField>& point_fields,
                   const std::vector<VtuField>& cell_fields, std::size_t nodes_per_tet) {
  constexpr const char* kGrid = "UnstructuredGrid";
  const bool is_wide = nodes_per_tet * n_tets > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max());
  const char* const id = is_wide ? detail::kVtkType<std::int64_t> : detail::kVtkType<std::int32_t>;
  const std::size_t n_id = is_wide ? 8 : 4;
  ShapeOfVtu file;
  file.text(detail::file_begin(kGrid) + detail::piece_begin(n_points, "NumberOfCells", n_tets));
  file.fields("PointData", n_points, point_fields);
  file.fields("CellData", n_tets, cell_fields);
  file.text("<Points>\n");
  file.array(detail::kVtkType<double>, "Points", 24 * n_points, detail::kThreeComponents);
  file.text("</Points>\n<Cells>\n");
  file.array(id, "connectivity", n_id * nodes_per_tet * n_tets);
  file.array(id, "offsets", n_id * n_tets);
  file.array(detail::kVtkType<std::uint8_t>, "types", n_tets);
  file.text("</Cells>\n" + detail::file_end(kGrid));
  VtuShape shape = std::move(file).shape();
  shape.has_wide_ids = is_wide;
  return shape;
}

std::string base64(const unsigned char* bytes, std::size_t n) {
  std::string text(4 * ((n + 2) / 3), '\0');
  if (n > 0) vtkBase64Utilities::Encode(bytes, n, reinterpret_cast<unsigned char*>(text.data()));
  return text;
}

}  // namespace umtet
