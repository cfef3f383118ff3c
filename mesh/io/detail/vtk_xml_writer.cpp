#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/parallel_invoke.h>
#include <vtkCellType.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <numeric>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>

#include "mesh/io/checked_file.h"
#include "mesh/io/detail/base64.h"
#include "mesh/io/detail/node_sets.h"
#include "mesh/io/detail/vtk_xml_text.h"
#include "mesh/io/pvtu.h"
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

/// Inline base64 blocks, encoded piece by piece by all threads while one of them writes what is done. VTK's own writer
/// takes a copy of the mesh and makes the whole text in memory, twice, four times the size of the file in all, because
/// on a full disk VTK 9.1 calls a cut file a success or crashes.
class VtkXmlWriter {
 public:
  explicit VtkXmlWriter(const std::filesystem::path& path) : file_(path) {}
  void mesh(const std::vector<Vec3>& V, const Cells& cells, const Arrays& point_data, const Arrays& cell_data,
            const std::vector<MeshPart>& numbers = {});
  void points(const std::vector<Vec3>& V, const Arrays& point_data);

 private:
  /// Bytes that a task encodes: whole groups of three, and whole values behind the eight bytes of their number.
  static constexpr std::size_t kPiece = 3 << 14;
  static constexpr std::size_t kPieces = 64;  ///< to a round: 4 MB of text, of which two are held
  static constexpr std::size_t kPieceText = kPiece / 3 * 4;

  void begin(const char* type, std::size_t n_points, const char* counted, std::size_t n_cells,
             const std::vector<MeshPart>& numbers = {});
  void end(const char* type);
  void coordinates(const std::vector<Vec3>& V);
  template <class Index>
  void connect(const Cells& cells);
  void data(const char* section, const Arrays& arrays);
  /// A DataArray of n values. @param fill  (first, n, to) writes n values from the first on, from several threads
  template <class T, class Fill>
  void array(const std::string& name, std::size_t n, const Fill& fill, const char* attributes = "");
  template <class T>
  void array(const std::string& name, std::span<const T> values, const char* attributes = "");

  CheckedFile file_;
  std::array<std::string, 2> text_;  ///< what is written, and what is encoded meanwhile
};

template <class T, class Fill>
void VtkXmlWriter::array(const std::string& name, std::size_t n, const Fill& fill, const char* attributes) {
  file_.text(detail::array_begin(kVtkType<T>, name, attributes));
  const std::uint64_t n_bytes = n * sizeof(T);
  const std::size_t n_all = sizeof n_bytes + n_bytes, n_pieces = (n_all + kPiece - 1) / kPiece;
  const auto encode = [&](std::size_t piece, char* text) {
    alignas(T) std::array<unsigned char, kPiece> raw;
    const std::size_t begin = piece * kPiece, size = std::min(kPiece, n_all - begin),
                      n_head = piece == 0 ? sizeof n_bytes : 0;
    if (piece == 0) std::memcpy(raw.data(), &n_bytes, n_head);
    const std::size_t first = piece == 0 ? 0 : (begin - sizeof n_bytes) / sizeof(T);
    fill(first, (size - n_head) / sizeof(T), reinterpret_cast<T*>(raw.data() + n_head));
    detail::encode_base64({raw.data(), size}, text);
  };
  const auto encode_round = [&](std::size_t first, std::string& text) {
    const std::size_t last = std::min(n_pieces, first + kPieces);
    text.resize(first < last ? detail::base64_length(std::min(n_all, last * kPiece) - first * kPiece) : 0);
    tbb::parallel_for(first, std::max(first, last),
                      [&](std::size_t piece) { encode(piece, text.data() + (piece - first) * kPieceText); });
  };
  encode_round(0, text_[0]);
  for (std::size_t first = 0; first < n_pieces; first += kPieces) {
    tbb::parallel_invoke([&] { file_.text(text_[0]); }, [&] { encode_round(first + kPieces, text_[1]); });
    std::swap(text_[0], text_[1]);
  }
  file_.text(detail::kArrayEnd);
}

template <class T>
void VtkXmlWriter::array(const std::string& name, std::span<const T> values, const char* attributes) {
  array<T>(
      name, values.size(),
      [&](std::size_t first, std::size_t n, T* to) {
        std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(first), n, to);
      },
      attributes);
}

std::span<const double> components(const std::vector<Vec3>& V) {
  return V.empty() ? std::span<const double>() : std::span{V.front().data(), 3 * V.size()};
}

template <class Index>
void VtkXmlWriter::connect(const Cells& cells) {
  array<Index>("connectivity", cells.ids.size(), [&](std::size_t first, std::size_t n, Index* to) {
    std::copy_n(cells.ids.begin() + static_cast<std::ptrdiff_t>(first), n, to);
  });
  array<Index>("offsets", cells.size(), [&](std::size_t first, std::size_t n, Index* to) {
    for (std::size_t k = 0; k < n; ++k) to[k] = static_cast<Index>(cells.n_nodes * (first + k + 1));
  });
}

void VtkXmlWriter::data(const char* section, const Arrays& arrays) {
  file_.text("<").text(section).text(">\n");
  for (const auto& [name, any] : arrays) {
    std::visit(
        [&, &name = name](const auto& values) {
          using Value = typename std::decay_t<decltype(values)>::value_type;
          if constexpr (std::is_same_v<Value, Vec3>) {
            array(name, components(values), kThreeComponents);
          } else {
            array(name, std::span<const Value>(values));
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
      array(part.name, std::span(&number, 1), " NumberOfTuples=\"1\"");
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
  array("Points", components(V), kThreeComponents);
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
  array<std::uint8_t>("types", cells.size(),
                      [&](std::size_t, std::size_t n, std::uint8_t* to) { std::fill_n(to, n, cells.type); });
  file_.text("</Cells>\n");
  end("UnstructuredGrid");
}

void VtkXmlWriter::points(const std::vector<Vec3>& V, const Arrays& point_data) {
  begin("PolyData", V.size(), "NumberOfVerts", V.size());
  data("PointData", point_data);
  coordinates(V);
  file_.text("<Verts>\n");
  const auto count_from = [](std::int64_t begin) {
    return [begin](std::size_t first, std::size_t n, std::int64_t* to) {
      std::iota(to, to + n, begin + static_cast<std::int64_t>(first));
    };
  };
  array<std::int64_t>("connectivity", V.size(), count_from(0));
  array<std::int64_t>("offsets", V.size(), count_from(1));
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

std::pair<Arrays, Arrays> data_of_one_piece(const SolverMesh& mesh) {
  std::vector<std::int64_t> vertices(mesh.nodes.size()), tets(mesh.n_tets());
  std::iota(vertices.begin(), vertices.end(), 0);
  std::iota(tets.begin(), tets.end(), 0);
  std::pair<Arrays, Arrays> data{detail::with_node_sets(mesh), mesh.cell_data};
  data.first.insert_or_assign("owner", std::vector<std::int64_t>(vertices.size(), 0));
  data.first.insert_or_assign("global_vertex", std::move(vertices));
  data.second.insert_or_assign("global_tet", std::move(tets));
  return data;
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

void write_vtu_piece(const std::filesystem::path& path, const SolverMesh& mesh) {
  require_consistent(mesh);
  const bool linear = mesh.nodes_per_tet == 4;
  const Cells tets{mesh.tets, static_cast<std::size_t>(mesh.nodes_per_tet),
                   static_cast<std::uint8_t>(linear ? VTK_TETRA : VTK_QUADRATIC_TETRA)};
  const auto [of_nodes, of_tets] = data_of_one_piece(mesh);
  VtkXmlWriter(path).mesh(mesh.nodes, tets, of_nodes, of_tets);
}

void write_pvtu(const std::filesystem::path& path, const SolverMesh& mesh, const std::string& piece) {
  const auto [of_nodes, of_tets] = data_of_one_piece(mesh);
  CheckedFile(path).text(pvtu_text(of_nodes, of_tets, {piece})).close();
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
