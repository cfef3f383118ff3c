#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mesh/io/checked_file.h"
#include "mesh/io/detail/solvers/fixed_width.h"
#include "mesh/io/solver_files.h"

namespace umtet {
namespace {

constexpr int kIdWidth = 9;     // NBLOCK and EBLOCK: i9, as CDWRITE writes them
constexpr int kItemWidth = 10;  // CMBLOCK: i10, with a sign
constexpr std::size_t kItemsPerLine = 8;
constexpr int kNodesPerLine = 8;          // a line of EBLOCK has 19 fields, 11 of them before the nodes
constexpr std::size_t kLongestName = 32;  // the limit of the command CM

void write_right_aligned(CheckedFile& file, long long value, int width) {
  constexpr std::string_view kBlanks = "          ";
  char digits[24];
  const std::string_view text(
      digits, static_cast<std::size_t>(std::to_chars(digits, digits + sizeof digits, value).ptr - digits));
  file.text(kBlanks.substr(0, static_cast<std::size_t>(width) - text.size())).text(text);
}

std::string lower(std::string s) {
  std::transform(s.begin(), s.end(), s.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return s;
}

/// Names of components for names of parts, which begin with a letter (problem_of_name()). Components have at most 32
/// letters, digits and '_', and are not called ALL, STAT or DEFA (command CM). Names that fit are kept. In others '_'
/// replaces what does not fit, and a number is appended if the name is taken, case aside.
std::vector<std::string> component_names(const std::vector<std::string>& parts) {
  std::set<std::string> taken = {"all", "stat", "defa"};
  std::vector<std::string> names;
  for (const std::string& part : parts) {
    std::string name = part.substr(0, kLongestName);
    std::replace_if(
        name.begin(), name.end(), [](unsigned char c) { return !std::isalnum(c); }, '_');
    names.push_back(name);
  }
  std::vector<std::size_t> changed;
  for (std::size_t k = 0; k < parts.size(); ++k) {
    if (names[k] != parts[k] || !taken.insert(lower(names[k])).second) changed.push_back(k);
  }
  for (const std::size_t k : changed) {
    const std::string begin = names[k];
    for (int n = 2; !taken.insert(lower(names[k])).second; ++n) {
      const std::string end = fmt::format("_{}", n);
      names[k] = begin.substr(0, kLongestName - end.size()) + end;
    }
  }
  return names;
}

void write_header(CheckedFile& file, const SolverMesh& mesh, const std::vector<std::string>& parts,
                  const std::vector<std::string>& names) {
  file.text("/COM,umtet: nodes, tets and components\n");
  for (std::size_t k = 0; k < parts.size(); ++k) {
    if (names[k] != parts[k]) file.text("! component ").text(names[k]).text(" = ").text(parts[k]).text("\n");
  }
  file.text("/PREP7\nET,1,").text(mesh.nodes_per_tet == 4 ? "285" : "187").text("\n");
}

/// Writes the command of a block of solids: its largest number, and how many there are.
void write_block_command(CheckedFile& file, std::string_view command, std::size_t n, std::string_view format) {
  file.text(command);
  for (int k = 0; k < 2; ++k) {
    file.text(",");
    write_right_aligned(file, static_cast<long long>(n), kIdWidth);
  }
  file.text("\n").text(format).text("\n");
}

void write_nodes(CheckedFile& file, const SolverMesh& mesh) {
  write_block_command(file, "NBLOCK,6,SOLID", mesh.nodes.size(), "(3i9,6e21.13e3)");
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    write_right_aligned(file, static_cast<long long>(i) + 1, kIdWidth);
    file.text("        0        0");  // the solid model
    for (int k = 0; k < 3; ++k) file.text(detail::FortranReal(mesh.nodes[i][k]).text());
    file.text("\n");
  }
  file.text("N,R5.3,LOC,       -1,\n");
}

/// The node order of SOLID187 is VTK's: I J K L, then the middles of IJ JK KI IL JL KL.
void write_elements(CheckedFile& file, const SolverMesh& mesh) {
  write_block_command(file, "EBLOCK,19,SOLID", mesh.n_tets(), "(19i9)");
  for (std::size_t t = 0; t < mesh.n_tets(); ++t) {
    // Material, type, real constants and section; then coordinates, death, solid model and shape, which are not used.
    write_right_aligned(file, mesh.regions.empty() ? 1 : mesh.regions[mesh.part_of(t)].number, kIdWidth);
    file.text("        1        1        1        0        0        0        0");
    write_right_aligned(file, mesh.nodes_per_tet, kIdWidth);
    file.text("        0");
    write_right_aligned(file, static_cast<long long>(t) + 1, kIdWidth);
    for (int k = 0; k < mesh.nodes_per_tet; ++k) {
      if (k == kNodesPerLine) file.text("\n");
      write_right_aligned(file, mesh.tet(t)[static_cast<std::size_t>(k)] + 1LL, kIdWidth);
    }
    file.text("\n");
  }
  file.text("       -1\n");
}

/// Writes a component of ranges: a number below 0 is the end of a range that the number before it begins.
/// @param ranges  first and last number of each, from 1
void write_component(CheckedFile& file, const std::string& name, std::string_view entity,
                     const std::vector<std::pair<long long, long long>>& ranges) {
  std::vector<long long> items;
  for (const auto& [first, last] : ranges) {
    items.push_back(first);
    if (last > first) items.push_back(-last);
  }
  if (items.empty()) return;
  file.text("CMBLOCK,").text(name).text(",").text(entity).text(",").number(items.size()).text("\n(8i10)\n");
  for (std::size_t k = 0; k < items.size(); ++k) {
    write_right_aligned(file, items[k], kItemWidth);
    if (k + 1 == items.size() || (k + 1) % kItemsPerLine == 0) file.text("\n");
  }
}

/// Appends index i, which is greater than all before.
void append(std::vector<std::pair<long long, long long>>& ranges, long long i) {
  if (!ranges.empty() && ranges.back().second == i) {
    ++ranges.back().second;
  } else {
    ranges.emplace_back(i + 1, i + 1);
  }
}

/// @param nodes  ascending
void write_node_component(CheckedFile& file, const std::string& name, const std::vector<int>& nodes) {
  std::vector<std::pair<long long, long long>> ranges;
  for (const int i : nodes) append(ranges, i);
  write_component(file, name, "NODE", ranges);
}

/// The tets of each part. @param names  beginning with those of the parts
void write_element_components(CheckedFile& file, const SolverMesh& mesh, const std::vector<std::string>& names) {
  std::vector<std::vector<std::pair<long long, long long>>> ranges(mesh.parts().size());
  for (std::size_t t = 0; t < mesh.n_tets(); ++t) append(ranges[mesh.part_of(t)], static_cast<long long>(t));
  for (std::size_t p = 0; p < ranges.size(); ++p) write_component(file, names[p], "ELEM", ranges[p]);
}

}  // namespace

void write_cdb(const std::filesystem::path& path, const SolverMesh& mesh) {
  require_consistent(mesh);
  detail::require_width(std::max(mesh.nodes.size(), mesh.n_tets()), kIdWidth, "an Ansys file");
  std::vector<std::string> parts;
  for (const MeshPart& part : mesh.parts()) parts.push_back(part.name);
  const std::size_t n_bodies = parts.size();
  for (const MeshPart& patch : mesh.patches) parts.push_back(patch.name);
  if (mesh.patches.size() > 1) parts.emplace_back(kWholeBoundary);
  const std::size_t n_before_curves = parts.size();
  for (const MeshCurve& curve : mesh.curves) parts.push_back(curve.part.name);
  const std::vector<std::string> names = component_names(parts);
  CheckedFile file(path);
  write_header(file, mesh, parts, names);
  write_nodes(file, mesh);
  write_elements(file, mesh);
  write_element_components(file, mesh, names);
  const std::vector<std::vector<int>> nodes = patch_nodes(mesh);
  for (std::size_t p = 0; p < nodes.size(); ++p) write_node_component(file, names[n_bodies + p], nodes[p]);
  if (mesh.patches.size() > 1) write_node_component(file, names[n_before_curves - 1], boundary_nodes(mesh));
  for (std::size_t c = 0; c < mesh.curves.size(); ++c)
    write_node_component(file, names[n_before_curves + c], curve_nodes(mesh.curves[c]));
  file.text("FINISH\n");
  file.close();
}

}  // namespace umtet
