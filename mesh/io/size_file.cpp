#include "mesh/io/size_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>

#include "mesh/io/tet_mesh_io.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

// Maximum number of points along an edge of a mesh whose requested sizes are much smaller than its own tets: 165 in a
// tet.
constexpr int kMostPerEdge = 8;

constexpr std::array<const char*, 4> endings = {".vtu", ".csv", ".xyz", ".txt"};

std::vector<std::string_view> words_of(std::string_view line) {
  constexpr std::string_view between = " ,;\t\r";
  std::vector<std::string_view> words;
  line = line.substr(0, line.find('#'));
  while (true) {
    const std::size_t begin = line.find_first_not_of(between);
    if (begin == line.npos) return words;
    const std::size_t end = std::min(line.find_first_of(between, begin), line.size());
    words.push_back(line.substr(begin, end - begin));
    line.remove_prefix(end);
  }
}

std::optional<double> number(std::string_view word) {
  double v = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), v);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return v;
}

SizeSource checked(const fs::path& file, const std::string& place, const Vec3& x, double h) {
  if (!x.allFinite()) throw MeshFileRefused(file, place, "coordinates that are not finite");
  if (!(h > 0) || !std::isfinite(h)) throw MeshFileRefused(file, place, fmt::format("size {}: must be > 0", h));
  return {x, h};
}

/// The columns of x, y, z and the size.
using Columns = std::array<std::size_t, 4>;

std::optional<Columns> columns_of(const std::vector<std::string_view>& names) {
  constexpr std::array<std::array<std::string_view, 2>, 4> names_of = {
      {{"x", "X"}, {"y", "Y"}, {"z", "Z"}, {"size", "h"}}};
  Columns columns{};
  for (std::size_t k = 0; k < 4; ++k) {
    const auto at = std::find_first_of(names.begin(), names.end(), names_of[k].begin(), names_of[k].end());
    if (at == names.end()) return std::nullopt;
    columns[k] = static_cast<std::size_t>(at - names.begin());
  }
  return columns;
}

std::vector<SizeSource> read_text_sizes(const fs::path& file) {
  std::ifstream in(file);
  if (!in) throw std::system_error(errno, std::generic_category(), file.string() + ": cannot be opened");
  std::vector<SizeSource> sources;
  Columns columns = {0, 1, 2, 3};
  std::string line;
  bool is_first = true;
  for (int n = 1; std::getline(in, line); ++n) {
    const std::vector<std::string_view> words = words_of(line);
    if (words.empty()) continue;
    const std::string place = fmt::format("line {}", n);
    if (std::exchange(is_first, false) && !number(words[0])) {
      const auto named = columns_of(words);
      if (!named) throw MeshFileRefused(file, place, "no columns x, y, z and size");
      columns = *named;
      continue;
    }
    std::array<double, 4> v{};
    for (std::size_t k = 0; k < 4; ++k) {
      const auto value = columns[k] < words.size() ? number(words[columns[k]]) : std::nullopt;
      if (!value) throw MeshFileRefused(file, place, "not four numbers; a line of a point is x y z size");
      v[k] = *value;
    }
    sources.push_back(checked(file, place, {v[0], v[1], v[2]}, v[3]));
  }
  if (in.bad()) throw std::system_error(errno, std::generic_category(), file.string() + ": cannot be read");
  return sources;
}

/// Adds points of a tet between its corners, spaced by the smallest of the corner sizes; none if the edges are shorter.
void add_inside(const TetMesh& mesh, const Tet& tet, const std::vector<double>& h, std::vector<SizeSource>& sources) {
  double longest = 0, least = h[tet[0]];
  for (int a = 0; a < 4; ++a) {
    least = std::min(least, h[tet[a]]);
    for (int b = 0; b < a; ++b) longest = std::max(longest, (mesh.V[tet[a]] - mesh.V[tet[b]]).norm());
  }
  const int n = static_cast<int>(std::clamp(std::ceil(longest / least), 1., double{kMostPerEdge}));
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; i + j <= n; ++j) {
      for (int k = 0; i + j + k <= n; ++k) {
        const std::array<double, 4> w = {double(i) / n, double(j) / n, double(k) / n, double(n - i - j - k) / n};
        if (*std::max_element(w.begin(), w.end()) == 1) continue;  // a corner
        SizeSource s{Vec3::Zero(), 0};
        for (int a = 0; a < 4; ++a) s.x += w[a] * mesh.V[tet[a]], s.h += w[a] * h[tet[a]];
        sources.push_back(s);
      }
    }
  }
}

std::vector<SizeSource> read_mesh_sizes(const fs::path& file) {
  const MeshFile content = read_tet_mesh(file);
  const std::vector<double>* h = nullptr;
  for (const char* name : {"h", "size"}) {
    const auto at = content.point_data.find(name);
    if (at != content.point_data.end() && std::holds_alternative<std::vector<double>>(at->second)) {
      h = &std::get<std::vector<double>>(at->second);
    }
  }
  if (!h) throw MeshFileRefused(file, "point data", "neither size nor h with floating-point numbers");
  std::vector<SizeSource> sources;
  for (std::size_t i = 0; i < h->size(); ++i) {
    sources.push_back(checked(file, fmt::format("point {}", i), content.mesh.V[i], (*h)[i]));
  }
  for (const Tet& tet : content.mesh.C) add_inside(content.mesh, tet, *h, sources);
  return sources;
}

}  // namespace

bool is_size_file(const std::string& text) {
  const std::string ending = fs::path(text).extension();
  return std::find(endings.begin(), endings.end(), ending) != endings.end();
}

std::vector<SizeSource> read_sizes(const fs::path& file) {
  std::vector<SizeSource> sources = file.extension() == ".vtu" ? read_mesh_sizes(file) : read_text_sizes(file);
  if (sources.empty()) throw MeshFileRefused(file, "the file", "no point; give lines x y z size");
  return sources;
}

}  // namespace umtet
