#include "mesh/io/vtu_shape.h"

#include <limits>

#include "common/vtk_xml/appended_writer.h"

namespace umtet {
namespace {

using detail::kVtkType;

void add_fields(detail::AppendedLayout& layout, const std::string& section, std::size_t n,
                const std::vector<VtuField>& fields) {
  layout.text("<" + section + ">\n");
  for (const VtuField& f : fields) {
    switch (f.type) {
      case VtuField::Type::Float64:
        layout.array(kVtkType<double>, f.name, 8 * n);
        break;
      case VtuField::Type::Int64:
        layout.array(kVtkType<std::int64_t>, f.name, 8 * n);
        break;
      case VtuField::Type::UInt8:
        layout.array(kVtkType<std::uint8_t>, f.name, n);
        break;
      case VtuField::Type::ThreeFloat64:
        layout.array(kVtkType<double>, f.name, 24 * n, detail::kThreeComponents);
        break;
    }
  }
  layout.text("</" + section + ">\n");
}

}  // namespace

VtuShape vtu_shape(std::size_t n_points, std::size_t n_tets, const std::vector<VtuField>& point_fields,
                   const std::vector<VtuField>& cell_fields, std::size_t nodes_per_tet) {
  const bool is_wide = nodes_per_tet * n_tets > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max());
  const char* const id = is_wide ? kVtkType<std::int64_t> : kVtkType<std::int32_t>;
  const std::size_t n_id = is_wide ? 8 : 4;
  detail::AppendedLayout layout;
  layout.begin("UnstructuredGrid");
  layout.text(detail::piece_begin(n_points, "NumberOfCells", n_tets));
  add_fields(layout, "PointData", n_points, point_fields);
  add_fields(layout, "CellData", n_tets, cell_fields);
  layout.text("<Points>\n");
  layout.array(kVtkType<double>, "Points", 24 * n_points, detail::kThreeComponents);
  layout.text("</Points>\n<Cells>\n");
  layout.array(id, "connectivity", n_id * nodes_per_tet * n_tets);
  layout.array(id, "offsets", n_id * n_tets);
  layout.array(kVtkType<std::uint8_t>, "types", n_tets);
  layout.text("</Cells>\n</Piece>\n");
  layout.close();

  VtuShape shape;
  shape.has_wide_ids = is_wide;
  shape.texts.emplace_back(0, layout.tags());
  for (const auto& [name, begin, n_bytes] : layout.arrays()) {
    const std::string count = detail::AppendedLayout::count({name, begin, n_bytes});
    shape.texts.emplace_back(begin - count.size(), count);
    shape.arrays.push_back({name, begin, n_bytes});
  }
  const VtuShape::Array& last = shape.arrays.front();  // of the file
  shape.texts.emplace_back(last.begin + last.n_bytes, detail::AppendedLayout::kEnd);
  return shape;
}

}  // namespace umtet
