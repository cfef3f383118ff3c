#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>

#include "common/vtk_xml/appended_writer.h"
#include "mesh/io/checked_file.h"
#include "mesh/io/detail/vtk/node_sets.h"
#include "mesh/io/polylines.h"
#include "mesh/io/pvtu.h"
#include "mesh/io/solver_files.h"
#include "mesh/io/tet_mesh_io.h"

namespace umtet {
namespace {

static_assert(sizeof(Vec3) == 3 * sizeof(double));

using detail::AppendedWriter;
using detail::kThreeComponents;

enum VtkCell : std::uint8_t {  // of vtkCellType.h
  VTK_TRIANGLE = 5,
  VTK_TETRA = 10,
  VTK_QUADRATIC_TRIANGLE = 22,
  VTK_QUADRATIC_TETRA = 24
};

using Arrays = std::map<std::string, FieldValues>;

/// Cells of one kind.
struct Cells {
  std::span<const int> ids;  ///< n_nodes each
  std::size_t n_nodes;
  std::uint8_t type;  ///< VTK's

  std::size_t size() const { return ids.size() / n_nodes; }
};

std::span<const double> components(const std::vector<Vec3>& V) {
  return V.empty() ? std::span<const double>() : std::span{V.front().data(), 3 * V.size()};
}

template <class Index>
void connect(AppendedWriter& out, const Cells& cells) {
  if constexpr (std::is_same_v<Index, int>) {
    out.array("connectivity", cells.ids);
  } else {
    out.array<Index>("connectivity", cells.ids.size(), [ids = cells.ids](std::size_t first, std::size_t n, Index* to) {
      std::copy_n(ids.begin() + static_cast<std::ptrdiff_t>(first), n, to);
    });
  }
  out.array<Index>("offsets", cells.size(), [n_nodes = cells.n_nodes](std::size_t first, std::size_t n, Index* to) {
    for (std::size_t k = 0; k < n; ++k) to[k] = static_cast<Index>(n_nodes * (first + k + 1));
  });
}

std::string tag(const std::string& name) { return "<" + name + ">\n"; }

void add_data(AppendedWriter& out, const std::string& section, const Arrays& arrays) {
  out.text(tag(section));
  for (const auto& [name, any] : arrays) {
    std::visit(
        [&, &name = name](const auto& values) {
          using Value = typename std::decay_t<decltype(values)>::value_type;
          if constexpr (std::is_same_v<Value, Vec3>) {
            out.array(name, components(values), kThreeComponents);
          } else {
            out.array(name, std::span<const Value>(values));
          }
        },
        any);
  }
  out.text(tag("/" + section));
}

void add_points(AppendedWriter& out, const std::vector<Vec3>& V) {
  out.text("<Points>\n").array("Points", components(V), kThreeComponents).text("</Points>\n");
}

void write_to(const std::filesystem::path& path, AppendedWriter& out) {
  CheckedFile file(path);
  out.text("</Piece>\n").write([&](std::string_view bytes) { file.text(bytes); });
  file.close();
}

void write_grid(const std::filesystem::path& path, const std::vector<Vec3>& V, const Cells& cells,
                const Arrays& point_data, const Arrays& cell_data, const std::vector<MeshPart>& numbers = {}) {
  AppendedWriter out;
  out.begin("UnstructuredGrid");
  if (!numbers.empty()) {
    out.text("<FieldData>\n");
    for (const MeshPart& part : numbers) {
      out.array(part.name, std::vector<std::int64_t>{part.number}, " NumberOfTuples=\"1\"");
    }
    out.text("</FieldData>\n");
  }
  out.text(detail::piece_begin(V.size(), "NumberOfCells", cells.size()));
  add_data(out, "PointData", point_data);
  add_data(out, "CellData", cell_data);
  add_points(out, V);
  out.text("<Cells>\n");
  if (cells.ids.size() <= std::numeric_limits<std::int32_t>::max()) {
    connect<std::int32_t>(out, cells);
  } else {
    connect<std::int64_t>(out, cells);
  }
  out.array<std::uint8_t>("types", cells.size(), [type = cells.type](std::size_t, std::size_t n, std::uint8_t* to) {
    std::fill_n(to, n, type);
  });
  write_to(path, out.text("</Cells>\n"));
}

void write_points(const std::filesystem::path& path, const std::vector<Vec3>& V, const Arrays& point_data) {
  AppendedWriter out;
  out.begin("PolyData").text(detail::piece_begin(V.size(), "NumberOfVerts", V.size()));
  add_data(out, "PointData", point_data);
  add_points(out, V);
  const auto count_from = [](std::int64_t begin) {
    return [begin](std::size_t first, std::size_t n, std::int64_t* to) {
      std::iota(to, to + n, begin + static_cast<std::int64_t>(first));
    };
  };
  out.text("<Verts>\n");
  out.array<std::int64_t>("connectivity", V.size(), count_from(0));
  out.array<std::int64_t>("offsets", V.size(), count_from(1));
  write_to(path, out.text("</Verts>\n"));
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
  std::vector<MeshPart> regions;
  for (const auto& [number, name] : file.region_names) regions.push_back({name, static_cast<int>(number)});
  write_grid(path, file.mesh.V, {ids_of(file.mesh.C), 4, VTK_TETRA}, file.point_data, file.cell_data, regions);
}

void write_vtu(const std::filesystem::path& path, const QuadraticTetMesh& mesh, const Arrays& point_data,
               const Arrays& cell_data) {
  check_sizes(point_data, mesh.V.size());
  check_sizes(cell_data, mesh.C.size());
  write_grid(path, mesh.V, {ids_of(mesh.C), 10, VTK_QUADRATIC_TETRA}, point_data, cell_data);
}

void write_vtu(const std::filesystem::path& path, const SolverMesh& mesh) {
  require_consistent(mesh);
  const bool linear = mesh.nodes_per_tet == 4;
  const Cells tets{mesh.tets, static_cast<std::size_t>(mesh.nodes_per_tet),
                   static_cast<std::uint8_t>(linear ? VTK_TETRA : VTK_QUADRATIC_TETRA)};
  write_grid(path, mesh.nodes, tets, detail::with_node_sets(mesh), mesh.cell_data, mesh.regions);
}

void write_vtu_piece(const std::filesystem::path& path, const SolverMesh& mesh) {
  require_consistent(mesh);
  const bool linear = mesh.nodes_per_tet == 4;
  const Cells tets{mesh.tets, static_cast<std::size_t>(mesh.nodes_per_tet),
                   static_cast<std::uint8_t>(linear ? VTK_TETRA : VTK_QUADRATIC_TETRA)};
  const auto [of_nodes, of_tets] = data_of_one_piece(mesh);
  write_grid(path, mesh.nodes, tets, of_nodes, of_tets);
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
  write_grid(path, mesh.nodes, faces, detail::with_node_sets(mesh), {{"patch", detail::patch_numbers(mesh)}},
             mesh.patches);
}

void write_polylines(const std::filesystem::path& path, const std::vector<Vec3>& points,
                     const std::vector<std::vector<int>>& lines, const Arrays& point_data, const Arrays& line_data) {
  check_sizes(point_data, points.size());
  check_sizes(line_data, lines.size());
  std::vector<std::int64_t> connectivity, offsets;
  for (const std::vector<int>& line : lines) {
    for (const int v : line) {
      if (v < 0 || static_cast<std::size_t>(v) >= points.size())
        throw std::invalid_argument("a line has a point that does not exist");
      connectivity.push_back(v);
    }
    offsets.push_back(static_cast<std::int64_t>(connectivity.size()));
  }
  AppendedWriter out;
  out.begin("PolyData").text(detail::piece_begin(points.size(), "NumberOfLines", lines.size()));
  add_data(out, "PointData", point_data);
  add_data(out, "CellData", line_data);
  add_points(out, points);
  out.text("<Lines>\n");
  out.array("connectivity", std::move(connectivity)).array("offsets", std::move(offsets));
  write_to(path, out.text("</Lines>\n"));
}

void write_vtp(const std::filesystem::path& path, const std::vector<Vec3>& points, const Arrays& point_data) {
  check_sizes(point_data, points.size());
  write_points(path, points, point_data);
}

}  // namespace umtet
