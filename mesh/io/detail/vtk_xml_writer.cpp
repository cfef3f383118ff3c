#include <vtkBase64Utilities.h>
#include <vtkCellType.h>

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <variant>

#include "mesh/io/checked_file.h"
#include "mesh/io/detail/node_sets.h"
#include "mesh/io/detail/vtk_xml_text.h"
#include "mesh/io/solver_files.h"
#include "mesh/io/tet_mesh_io.h"

namespace umtet {
namespace {

static_assert(std::endian::native == std::endian::little && sizeof(Vec3) == 3 * sizeof(double));

using detail::kThreeComponents;
using detail::kVtkType;

using Arrays = std::map<std::string, FieldValues>;

/// Cells of one kind.
struct Cells {
  std::span<const int> ids;  ///< n_nodes each
  std::size_t n_nodes;
  std::uint8_t type;  ///< VTK's

  std::size_t size() const { return ids.size() / n_nodes; }
};

/// Inline base64 blocks, encoded piece by piece on their way to the file. VTK's own writer takes a copy of the mesh and
/// makes the whole text in memory, twice, four times the size of the file in all, because on a full disk VTK 9.1 calls
/// a cut file a success or crashes.
class VtkXmlWriter {
 public:
  explicit VtkXmlWriter(const std::filesystem::path& path) : file_(path) {}
  void mesh(const std::vector<Vec3>& V, const Cells& cells, const Arrays& point_data, const Arrays& cell_data,
            const std::vector<MeshPart>& numbers = {});
  void points(const std::vector<Vec3>& V, const Arrays& point_data);

 private:
  static constexpr std::size_t kPiece = 3 << 14;  ///< bytes encoded at once: whole groups of three

  void begin(const char* type, std::size_t n_points, const char* counted, std::size_t n_cells,
             const std::vector<MeshPart>& numbers = {});
  void end(const char* type);
  void coordinates(const std::vector<Vec3>& V);
  template <class Index>
  void connect(const Cells& cells);
  void data(const char* section, const Arrays& arrays);
  /// A DataArray of n values, which `fill` puts.
  template <class T, class Fill>
  void array(const std::string& name, std::size_t n, const Fill& fill, const char* attributes = "");
  template <class T>
  void put(const T* values, std::size_t n);
  void encode();

  CheckedFile file_;
  std::vector<unsigned char> raw_ = std::vector<unsigned char>(kPiece);
  std::vector<unsigned char> text_ = std::vector<unsigned char>(kPiece / 3 * 4);
  std::size_t n_raw_ = 0;
};

void VtkXmlWriter::encode() {
  const auto n = vtkBase64Utilities::Encode(raw_.data(), static_cast<unsigned long>(n_raw_), text_.data());
  file_.text({reinterpret_cast<const char*>(text_.data()), n});
  n_raw_ = 0;
}

template <class T>
void VtkXmlWriter::put(const T* values, std::size_t n) {
  const auto* from = reinterpret_cast<const unsigned char*>(values);
  for (std::size_t left = n * sizeof(T); left > 0;) {
    const std::size_t some = std::min(left, kPiece - n_raw_);
    std::copy_n(from, some, raw_.begin() + static_cast<std::ptrdiff_t>(n_raw_));
    n_raw_ += some;
    from += some;
    left -= some;
    if (n_raw_ == kPiece) encode();
  }
}

template <class T, class Fill>
void VtkXmlWriter::array(const std::string& name, std::size_t n, const Fill& fill, const char* attributes) {
  file_.text(detail::array_begin(kVtkType<T>, name, attributes));
  const std::uint64_t n_bytes = n * sizeof(T);
  put(&n_bytes, 1);
  fill();
  encode();
  file_.text(detail::kArrayEnd);
}

template <class Index>
void VtkXmlWriter::connect(const Cells& cells) {
  array<Index>("connectivity", cells.ids.size(), [&] {
    for (const int id : cells.ids) {
      const Index node = id;
      put(&node, 1);
    }
  });
  array<Index>("offsets", cells.size(), [&] {
    for (std::size_t t = 1; t <= cells.size(); ++t) {
      const auto end = static_cast<Index>(cells.n_nodes * t);
      put(&end, 1);
    }
  });
}

void VtkXmlWriter::data(const char* section, const Arrays& arrays) {
  file_.text("<").text(section).text(">\n");
  for (const auto& [name, any] : arrays) {
    std::visit(
        [&, &name = name](const auto& values) {
          using Value = typename std::decay_t<decltype(values)>::value_type;
          const auto fill = [&] { put(values.data(), values.size()); };
          if constexpr (std::is_same_v<Value, Vec3>) {
            array<double>(name, 3 * values.size(), fill, kThreeComponents);
          } else {
            array<Value>(name, values.size(), fill);
          }
        },
        any);
  }
  file_.text("</").text(section).text(">\n");
}

void VtkXmlWriter::begin(const char* type, std::size_t n_points, const char* counted, std::size_t n_cells,
                         const std::vector<MeshPart>& numbers) {
  file_.text(detail::file_begin(type));
  if (!numbers.empty()) {
    file_.text("<FieldData>\n");
    for (const MeshPart& part : numbers) {
      const std::int64_t number = part.number;
      array<std::int64_t>(
          part.name, 1, [&] { put(&number, 1); }, " NumberOfTuples=\"1\"");
    }
    file_.text("</FieldData>\n");
  }
  file_.text(detail::piece_begin(n_points, counted, n_cells));
}

void VtkXmlWriter::end(const char* type) {
  file_.text(detail::file_end(type));
  file_.close();
}

void VtkXmlWriter::coordinates(const std::vector<Vec3>& V) {
  file_.text("<Points>\n");
  array<double>(
      "Points", 3 * V.size(), [&] { put(V.data(), V.size()); }, kThreeComponents);
  file_.text("</Points>\n");
}

void VtkXmlWriter::mesh(const std::vector<Vec3>& V, const Cells& cells, const Arrays& point_data,
                        const Arrays& cell_data, const std::vector<MeshPart>& numbers) {
  begin("UnstructuredGrid", V.size(), "NumberOfCells", cells.size(), numbers);
  data("PointData", point_data);
  data("CellData", cell_data);
  coordinates(V);
  file_.text("<Cells>\n");
  if (cells.ids.size() <= std::numeric_limits<std::int32_t>::max()) {
    connect<std::int32_t>(cells);
  } else {
    connect<std::int64_t>(cells);
  }
  const std::vector<std::uint8_t> types(cells.size(), cells.type);
  array<std::uint8_t>("types", types.size(), [&] { put(types.data(), types.size()); });
  file_.text("</Cells>\n");
  end("UnstructuredGrid");
}

void VtkXmlWriter::points(const std::vector<Vec3>& V, const Arrays& point_data) {
  begin("PolyData", V.size(), "NumberOfVerts", V.size());
  data("PointData", point_data);
  coordinates(V);
  file_.text("<Verts>\n");
  const auto count_from = [&](std::int64_t first) {
    for (std::int64_t i = first; i < first + static_cast<std::int64_t>(V.size()); ++i) put(&i, 1);
  };
  array<std::int64_t>("connectivity", V.size(), [&] { count_from(0); });
  array<std::int64_t>("offsets", V.size(), [&] { count_from(1); });
  file_.text("</Verts>\n");
  end("PolyData");
}

template <std::size_t N>
std::span<const int> ids_of(const std::vector<std::array<int, N>>& C) {
  static_assert(sizeof(std::array<int, N>) == N * sizeof(int));
  return C.empty() ? std::span<const int>() : std::span{C.front().data(), N * C.size()};
}

void check_sizes(const Arrays& arrays, std::size_t n) {
  for (const auto& [name, any] : arrays) {
    const std::size_t size = std::visit([](const auto& values) { return values.size(); }, any);
    if (size != n) throw std::invalid_argument("data '" + name + "': one value each is needed");
  }
}

}  // namespace

void write_vtu(const std::filesystem::path& path, const MeshFile& file) {
  check_sizes(file.point_data, file.mesh.V.size());
  check_sizes(file.cell_data, file.mesh.C.size());
  VtkXmlWriter(path).mesh(file.mesh.V, {ids_of(file.mesh.C), 4, VTK_TETRA}, file.point_data, file.cell_data);
}

void write_vtu(const std::filesystem::path& path, const QuadraticTetMesh& mesh, const Arrays& point_data,
               const Arrays& cell_data) {
  check_sizes(point_data, mesh.V.size());
  check_sizes(cell_data, mesh.C.size());
  VtkXmlWriter(path).mesh(mesh.V, {ids_of(mesh.C), 10, VTK_QUADRATIC_TETRA}, point_data, cell_data);
}

void write_vtu(const std::filesystem::path& path, const SolverMesh& mesh) {
  require_consistent(mesh);
  const bool linear = mesh.nodes_per_tet == 4;
  const Cells tets{mesh.tets, static_cast<std::size_t>(mesh.nodes_per_tet),
                   static_cast<std::uint8_t>(linear ? VTK_TETRA : VTK_QUADRATIC_TETRA)};
  VtkXmlWriter(path).mesh(mesh.nodes, tets, detail::with_node_sets(mesh), mesh.cell_data);
}

void write_boundary_vtu(const std::filesystem::path& path, const SolverMesh& mesh) {
  require_consistent(mesh);
  const bool linear = mesh.nodes_per_tet == 4;
  const std::vector<int> ids = mesh.faces();
  const Cells faces{ids, static_cast<std::size_t>(mesh.nodes_per_face()),
                    static_cast<std::uint8_t>(linear ? VTK_TRIANGLE : VTK_QUADRATIC_TRIANGLE)};
  VtkXmlWriter(path).mesh(mesh.nodes, faces, detail::with_node_sets(mesh), {{"patch", detail::patch_numbers(mesh)}},
                          mesh.patches);
}

void write_vtp(const std::filesystem::path& path, const std::vector<Vec3>& points, const Arrays& point_data) {
  check_sizes(point_data, points.size());
  VtkXmlWriter(path).points(points, point_data);
}

}  // namespace umtet
