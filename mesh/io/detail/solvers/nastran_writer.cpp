#include <algorithm>
#include <charconv>
#include <string>
#include <string_view>

#include "mesh/io/checked_file.h"
#include "mesh/io/detail/solvers/fixed_width.h"
#include "mesh/io/solver_files.h"

namespace umtet {
namespace {

constexpr int kFieldWidth = 8;
constexpr int kFieldsPerLine = 8;

/// A card of whole numbers: fields of 8 characters, continued behind every eighth.
class Card {
 public:
  Card(CheckedFile& file, std::string_view name) : file_(file) { pad(name, kFieldWidth); }
  Card& field(std::size_t value) {
    if (n_ == kFieldsPerLine) {
      file_.text("+\n");
      pad("+", kFieldWidth);
      n_ = 0;
    }
    ++n_;
    char digits[24];
    pad({digits, std::to_chars(digits, digits + sizeof digits, value).ptr}, kFieldWidth);
    return *this;
  }
  void end() { file_.text("\n"); }

 private:
  void pad(std::string_view text, int width) {
    constexpr std::string_view kBlanks = "        ";
    file_.text(text).text(kBlanks.substr(0, static_cast<std::size_t>(width) - text.size()));
  }
  CheckedFile& file_;
  int n_ = 0;
};

void write_grid(CheckedFile& file, std::size_t id, const Vec3& x) {
  constexpr std::string_view kBlanks = "                ";
  const auto pad = [&](std::string_view text) { file.text(text).text(kBlanks.substr(0, 16 - text.size())); };
  char digits[24];
  file.text("GRID*   ");
  pad({digits, std::to_chars(digits, digits + sizeof digits, id).ptr});
  file.text(kBlanks);  // the basic coordinate system
  for (int k = 0; k < 3; ++k) {
    if (k == 2) file.text("*\n*       ");
    pad(detail::FixedWidth(x[k], 16, detail::FixedWidth::Style::Nastran).text());
  }
  file.text("\n");
}

}  // namespace

void write_nastran(const std::filesystem::path& path, const SolverMesh& mesh) {
  require_consistent(mesh);
  const std::vector<MeshPart> parts = mesh.parts();
  int largest = 0;
  for (const MeshPart& part : parts) largest = std::max(largest, part.number);
  for (const MeshPart& patch : mesh.patches) largest = std::max(largest, patch.number);
  detail::require_width(
      std::max({mesh.nodes.size(), mesh.n_tets() + mesh.n_faces(), static_cast<std::size_t>(largest)}), kFieldWidth,
      "a Nastran file");
  CheckedFile file(path);
  for (const MeshPart& part : parts)
    file.text("$ umtet: tets, property ").number(part.number).text(" = ").text(part.name).text("\n");
  for (const MeshPart& patch : mesh.patches) {
    file.text("$ faces, property ").number(patch.number).text(", and nodes, SET1 ").number(patch.number);
    file.text(" = ").text(patch.name).text("\n");
  }
  file.text("BEGIN BULK\n");
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) write_grid(file, i + 1, mesh.nodes[i]);
  // The node order of CTETRA and CTRIA6 is VTK's.
  const auto write_element = [&](const char* name, std::size_t id, int property, const int* ids, int n) {
    Card card(file, name);
    card.field(id).field(static_cast<std::size_t>(property));
    for (int k = 0; k < n; ++k) card.field(static_cast<std::size_t>(ids[k]) + 1);
    card.end();
  };
  for (std::size_t t = 0; t < mesh.n_tets(); ++t) {
    write_element("CTETRA", t + 1, parts[mesh.part_of(t)].number, mesh.tet(t).data(), mesh.nodes_per_tet);
  }
  const char* const triangle = mesh.nodes_per_tet == 4 ? "CTRIA3" : "CTRIA6";
  for (std::size_t f = 0; f < mesh.n_faces(); ++f) {
    write_element(triangle, mesh.n_tets() + f + 1, mesh.patches[mesh.face_patch[f]].number, mesh.face(f).data(),
                  mesh.nodes_per_face());
  }
  const std::vector<std::vector<int>> nodes = patch_nodes(mesh);
  for (std::size_t p = 0; p < nodes.size(); ++p) {
    if (nodes[p].empty()) continue;
    Card card(file, "SET1");
    card.field(static_cast<std::size_t>(mesh.patches[p].number));
    for (const int i : nodes[p]) card.field(static_cast<std::size_t>(i) + 1);
    card.end();
  }
  file.text("ENDDATA\n");
  file.close();
}

}  // namespace umtet
