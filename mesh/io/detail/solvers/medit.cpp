#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <string>

#include "mesh/io/checked_file.h"
#include "mesh/io/detail/mesh_formats.h"
#include "mesh/io/solver_files.h"

namespace umtet {

void write_medit(const std::filesystem::path& path, const SolverMesh& mesh) {
  require_consistent(mesh);
  const std::vector<MeshPart> parts = mesh.parts();
  std::vector<int> reference(mesh.nodes.size(), parts.front().number);
  for (std::size_t t = 0; !mesh.regions.empty() && t < mesh.n_tets(); ++t) {
    for (const int i : mesh.tet(t)) reference[i] = parts[mesh.part_of(t)].number;
  }
  const std::vector<std::vector<int>> nodes = patch_nodes(mesh);
  for (std::size_t p = nodes.size(); p-- > 0;) {
    for (const int i : nodes[p]) reference[i] = mesh.patches[p].number;
  }
  CheckedFile file(path);
  file.text("MeshVersionFormatted 2\nDimension 3\n\nVertices\n").number(mesh.nodes.size()).text("\n");
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    for (int k = 0; k < 3; ++k) file.number(mesh.nodes[i][k]).text(" ");
    file.number(reference[i]).text("\n");
  }
  const bool linear = mesh.nodes_per_tet == 4;
  file.text(linear ? "\nTriangles\n" : "\nTrianglesP2\n").number(mesh.n_faces()).text("\n");
  for (std::size_t f = 0; f < mesh.n_faces(); ++f) {
    const std::array<int, 6> ids = mesh.face(f);
    for (int k = 0; k < mesh.nodes_per_face(); ++k) file.number(ids[k] + 1).text(" ");
    file.number(mesh.patches[mesh.face_patch[f]].number).text("\n");
  }
  file.text(linear ? "\nTetrahedra\n" : "\nTetrahedraP2\n").number(mesh.n_tets()).text("\n");
  for (std::size_t t = 0; t < mesh.n_tets(); ++t) {
    for (const int v : mesh.tet(t)) file.number(v + 1).text(" ");
    file.number(parts[mesh.part_of(t)].number).text("\n");
  }
  file.text("\nEnd\n");
  file.close();
}

namespace detail {
namespace {

std::string lower(std::string_view w) {
  std::string s(w.substr(0, 64));
  std::transform(s.begin(), s.end(), s.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return s;
}

void read_vertices(ByteCursor& in, NumberedMesh& mesh) {
  const std::size_t n = in.count("number of vertices", 8);  // "0 0 0 0\n"
  const auto known = static_cast<std::int64_t>(mesh.point.size());
  mesh.number.reserve(n);
  mesh.point.reserve(n);
  for (std::size_t i = 0; i < n; ++i) {
    Vec3 x;
    for (int k = 0; k < 3; ++k) x[k] = in.number<double>("vertex coordinate");
    in.number<std::int64_t>("vertex reference");
    mesh.number.push_back(known + static_cast<std::int64_t>(i) + 1);
    mesh.point.push_back(x);
  }
}

void read_tets(ByteCursor& in, int nodes, NumberedMesh& mesh) {
  const std::size_t n = in.count("number of tets", 2 * static_cast<std::size_t>(nodes) + 2);
  mesh.tets.reserve(mesh.tets.size() + n);
  for (std::size_t t = 0; t < n; ++t) {
    for (auto& v : mesh.tets.emplace_back()) v = in.number<std::int64_t>("vertex of a tet");
    if (nodes == 10) {
      for (auto& v : mesh.mid_sides.emplace_back()) v = in.number<std::int64_t>("vertex of a tet");
    }
    mesh.region.push_back(in.number<std::int64_t>("tet reference"));
  }
}

}  // namespace

MeshFile read_medit(const std::filesystem::path& path) {
  const std::string bytes = file_bytes(path, "MeshVersionFormatted");
  ByteCursor in(path, bytes, '#');
  NumberedMesh mesh;
  bool known = false;
  for (std::string_view w = in.word(); !w.empty(); w = in.word()) {
    const std::string keyword = lower(w);
    if (keyword == "meshversionformatted") {
      in.number<std::int64_t>("version");
      known = true;
    } else if (!known) {
      in.refuse("not a MEDIT file: no MeshVersionFormatted at its beginning");
    } else if (keyword == "dimension") {
      if (const auto d = in.number<std::int64_t>("dimension"); d != 3)
        in.refuse("dimension " + std::to_string(d) + ": must be 3");
    } else if (keyword == "vertices") {
      read_vertices(in, mesh);
    } else if (keyword == "tetrahedra") {
      read_tets(in, 4, mesh);
    } else if (keyword == "tetrahedrap2") {
      read_tets(in, 10, mesh);
    } else if (keyword == "end") {
      break;
    }
    // Anything else is a keyword we do not need, or one of its numbers.
  }
  if (!known) in.refuse("not a MEDIT file: it is empty");
  if (mesh.tets.empty()) in.refuse("no tets in this file");
  return assemble(path, std::move(mesh));
}

}  // namespace detail
}  // namespace umtet
