#include <vtkBase64Utilities.h>
#include <vtkCellType.h>

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <variant>

#include "mesh/detail/checked_file.h"
#include "mesh/tet_mesh_io.h"

namespace umtet {
namespace {

static_assert(std::endian::native == std::endian::little && sizeof(Vec3) == 3 * sizeof(double));

template <typename T>
constexpr const char* kVtkType = nullptr;
template <>
constexpr const char* kVtkType<double> = "Float64";
template <>
constexpr const char* kVtkType<std::int64_t> = "Int64";
template <>
constexpr const char* kVtkType<std::int32_t> = "Int32";
template <>
constexpr const char* kVtkType<std::uint8_t> = "UInt8";

std::string escaped(const std::string& name) {
  std::string text;
  for (const char c : name) {
    text += c == '&' ? "&amp;" : c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '"' ? "&quot;" : std::string(1, c);
  }
  return text;
}

/// Inline base64 blocks, encoded piece by piece on their way to the file. VTK's own writer takes a copy of the mesh and
/// makes the whole text in memory, twice, four times the size of the file in all, because on a full disk VTK 9.1 calls
/// a cut file a success or crashes.
class VtkXmlWriter {
 public:
  explicit VtkXmlWriter(const std::filesystem::path& path) : file_(path) {}
  /// Tets of N nodes.
  template <std::size_t N>
  void mesh(const std::vector<Vec3>& V, const std::vector<std::array<int, N>>& C,
            const std::map<std::string, FieldValues>& point_data, const std::map<std::string, FieldValues>& cell_data);
  void points(const std::vector<Vec3>& V, const std::map<std::string, FieldValues>& point_data);

 private:
  static constexpr std::size_t kPiece = 3 << 14;  ///< bytes encoded at once: whole groups of three

  void begin(const char* type, std::size_t n_points, const char* counted, std::size_t n_cells);
  void end(const char* type);
  void coordinates(const std::vector<Vec3>& V);
  template <class Index, std::size_t N>
  void cells(const std::vector<std::array<int, N>>& C);
  void data(const char* section, const std::map<std::string, FieldValues>& arrays);
  /// A DataArray of n values, which `fill` puts.
  template <class T, class Fill>
  void array(const std::string& name, std::size_t n, const Fill& fill, int components = 1);
  template <class T>
  void put(const T* values, std::size_t n);
  void encode();

  detail::CheckedFile file_;
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
void VtkXmlWriter::array(const std::string& name, std::size_t n, const Fill& fill, int components) {
  file_.text("<DataArray type=\"").text(kVtkType<T>).text("\" Name=\"").text(escaped(name)).text("\"");
  if (components > 1) file_.text(" NumberOfComponents=\"").number(components).text("\"");
  file_.text(" format=\"binary\">\n");
  const std::uint64_t n_bytes = n * sizeof(T);
  put(&n_bytes, 1);
  fill();
  encode();
  file_.text("\n</DataArray>\n");
}

template <class Index, std::size_t N>
void VtkXmlWriter::cells(const std::vector<std::array<int, N>>& C) {
  array<Index>("connectivity", N * C.size(), [&] {
    for (const auto& t : C) {
      std::array<Index, N> nodes;
      std::copy(t.begin(), t.end(), nodes.begin());
      put(nodes.data(), N);
    }
  });
  array<Index>("offsets", C.size(), [&] {
    for (std::size_t t = 1; t <= C.size(); ++t) {
      const auto end = static_cast<Index>(N * t);
      put(&end, 1);
    }
  });
}

void VtkXmlWriter::data(const char* section, const std::map<std::string, FieldValues>& arrays) {
  file_.text("<").text(section).text(">\n");
  for (const auto& [name, any] : arrays) {
    std::visit(
        [&, &name = name](const auto& values) {
          using Value = typename std::decay_t<decltype(values)>::value_type;
          array<Value>(name, values.size(), [&] { put(values.data(), values.size()); });
        },
        any);
  }
  file_.text("</").text(section).text(">\n");
}

void VtkXmlWriter::begin(const char* type, std::size_t n_points, const char* counted, std::size_t n_cells) {
  file_.text("<?xml version=\"1.0\"?>\n<VTKFile type=\"").text(type);
  file_.text("\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<").text(type);
  file_.text(">\n<Piece NumberOfPoints=\"").number(n_points).text("\" ").text(counted).text("=\"").number(n_cells);
  file_.text("\">\n");
}

void VtkXmlWriter::end(const char* type) {
  file_.text("</Piece>\n</").text(type).text(">\n</VTKFile>\n");
  file_.close();
}

void VtkXmlWriter::coordinates(const std::vector<Vec3>& V) {
  file_.text("<Points>\n");
  array<double>(
      "Points", 3 * V.size(), [&] { put(V.data(), V.size()); }, 3);
  file_.text("</Points>\n");
}

template <std::size_t N>
void VtkXmlWriter::mesh(const std::vector<Vec3>& V, const std::vector<std::array<int, N>>& C,
                        const std::map<std::string, FieldValues>& point_data,
                        const std::map<std::string, FieldValues>& cell_data) {
  begin("UnstructuredGrid", V.size(), "NumberOfCells", C.size());
  data("PointData", point_data);
  data("CellData", cell_data);
  coordinates(V);
  file_.text("<Cells>\n");
  if (C.size() <= std::numeric_limits<std::int32_t>::max() / N) {
    cells<std::int32_t>(C);
  } else {
    cells<std::int64_t>(C);
  }
  const std::vector<std::uint8_t> types(C.size(), N == 4 ? VTK_TETRA : VTK_QUADRATIC_TETRA);
  array<std::uint8_t>("types", C.size(), [&] { put(types.data(), types.size()); });
  file_.text("</Cells>\n");
  end("UnstructuredGrid");
}

void VtkXmlWriter::points(const std::vector<Vec3>& V, const std::map<std::string, FieldValues>& point_data) {
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

void check_sizes(const std::map<std::string, FieldValues>& arrays, std::size_t n) {
  for (const auto& [name, any] : arrays) {
    const std::size_t size = std::visit([](const auto& values) { return values.size(); }, any);
    if (size != n) throw std::invalid_argument("data '" + name + "': one value each is needed");
  }
}

}  // namespace

void write_vtu(const std::filesystem::path& path, const MeshFile& file) {
  check_sizes(file.point_data, file.mesh.V.size());
  check_sizes(file.cell_data, file.mesh.C.size());
  VtkXmlWriter(path).mesh(file.mesh.V, file.mesh.C, file.point_data, file.cell_data);
}

void write_vtu(const std::filesystem::path& path, const QuadraticTetMesh& mesh,
               const std::map<std::string, FieldValues>& point_data,
               const std::map<std::string, FieldValues>& cell_data) {
  check_sizes(point_data, mesh.V.size());
  check_sizes(cell_data, mesh.C.size());
  VtkXmlWriter(path).mesh(mesh.V, mesh.C, point_data, cell_data);
}

void write_vtp(const std::filesystem::path& path, const std::vector<Vec3>& points,
               const std::map<std::string, FieldValues>& point_data) {
  check_sizes(point_data, points.size());
  VtkXmlWriter(path).points(points, point_data);
}

}  // namespace umtet
