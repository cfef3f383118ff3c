// VTK UnstructuredGrid in XML: every piece, its tets and the data of its points and cells.
#include <algorithm>
#include <limits>
#include <list>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "common/vtk_xml/array_reader.h"
#include "mesh/io/detail/mesh_formats.h"

namespace umtet {
namespace {

constexpr std::uint8_t kTetra = 10, kQuadraticTetra = 24;  // VTK's
constexpr std::size_t kHead = 1 << 20;
constexpr std::uint64_t kMostPoints = std::numeric_limits<int>::max();

using Data = std::map<std::string, FieldValues>;

/// What a Piece holds, as it comes.
struct Piece {
  std::uint64_t n_points = 0, n_cells = 0;
  std::vector<Vec3> points;
  std::vector<int> connectivity;  ///< -1: out of range
  std::vector<std::int64_t> offsets;
  std::vector<std::uint8_t> types;
  Data point_data, cell_data;
  std::map<std::int64_t, std::string> region_names;
  bool has_points = false, has_types = false;
};

/// A sink that appends numbers to Vec3s.
detail::NumberSink into(std::vector<Vec3>& values) {
  return {.doubles = [&values, k = 0](std::span<const double> some) mutable {
    for (const double v : some) {
      if (k == 0) values.emplace_back();
      values.back()[k] = v;
      k = (k + 1) % 3;
    }
  }};
}

detail::NumberSink into(std::vector<double>& values) {
  return {
      .doubles = [&values](std::span<const double> some) { values.insert(values.end(), some.begin(), some.end()); }};
}

/// @param as  of a number as it is stored
template <class T, class As>
detail::NumberSink into(std::vector<T>& values, As as) {
  return {.integers = [&values, as](std::span<const std::int64_t> some) {
    for (const std::int64_t v : some) values.push_back(as(v));
  }};
}

class VtuReader {
 public:
  explicit VtuReader(const std::filesystem::path& path)
      : path_(path),
        source_(path, [](const std::string& file, const std::string& what) { throw MeshFileRefused(file, "", what); }),
        tags_(source_),
        arrays_(source_) {}

  Piece read();

 private:
  void open(const detail::XmlTag& tag);
  void begin_piece(const detail::XmlTag& tag);
  void take_array(const detail::XmlTag& tag);
  void take_cells(const detail::XmlArray& array, Piece& piece);
  void take_data(const detail::XmlArray& array, Data& data, std::uint64_t n);
  Piece joined();
  void name_regions(Piece& piece) const;

  const std::filesystem::path& path_;
  detail::ByteStream source_;
  detail::XmlTags tags_;
  detail::ArrayReader arrays_;
  std::list<Piece> pieces_;
  std::map<std::string, std::vector<std::int64_t>> field_data_;  ///< the first whole numbers of each array
};

Piece VtuReader::read() {
  if (source_.head(kHead).find("<VTKFile") == std::string_view::npos) {
    source_.refuse("not a VTK XML file: no <VTKFile in the first megabyte");
  }
  detail::XmlTag tag;
  while (tags_.next(tag)) {
    if (tag.is_closing) continue;
    open(tag);
    if (tag.name != "AppendedData") continue;
    arrays_.read_appended(tag);
    break;
  }
  arrays_.finish();
  Piece all = joined();
  name_regions(all);
  return all;
}

void VtuReader::open(const detail::XmlTag& tag) {
  if (tags_.parent().empty()) arrays_.take_root(tag, "UnstructuredGrid");
  if (tag.name == "Piece") begin_piece(tag);
  if (tag.name == "DataArray" || tag.name == "Array") take_array(tag);
}

/// A point takes at least three numbers, a cell at least its type: a byte each.
void VtuReader::begin_piece(const detail::XmlTag& tag) {
  Piece& piece = pieces_.emplace_back();
  piece.n_points = tag.count("NumberOfPoints", source_);
  piece.n_cells = tag.count("NumberOfCells", source_);
  double n_all = 0;
  for (const Piece& p : pieces_) n_all += static_cast<double>(p.n_points) + static_cast<double>(p.n_cells);
  if (n_all > arrays_.most_values()) {
    source_.refuse(std::to_string(piece.n_points) + " points and " + std::to_string(piece.n_cells) +
                   " cells: more than the file can hold");
  }
  if (piece.n_points > kMostPoints || piece.n_cells > kMostPoints) source_.refuse("more than 2^31 points or cells");
}

void VtuReader::take_array(const detail::XmlTag& tag) {
  const detail::XmlArray array = arrays_.array(tag);
  if (array.name == "faces" || array.name == "faceoffsets") source_.refuse("polyhedral cells are not read");
  const std::string_view section = tags_.parent();
  const bool is_whole = array.type && array.type->kind != detail::NumberType::Kind::Float;
  if (section == "FieldData" && is_whole && !array.name.empty() && !field_data_.contains(array.name)) {
    std::vector<std::int64_t>& values = field_data_[array.name];
    return arrays_.read(array, std::nullopt, {.integers = [&values](std::span<const std::int64_t> some) {
                          for (const std::int64_t v : some)
                            if (values.size() < 2) values.push_back(v);
                        }});
  }
  const bool is_of_a_piece =
      section == "PointData" || section == "CellData" || section == "Points" || section == "Cells";
  if (!is_of_a_piece || (array.type_name == "String" && section != "Points" && section != "Cells")) {
    if (!tag.is_empty) source_.skip_to('<');
    return;
  }
  if (pieces_.empty()) source_.refuse("an array that is in no piece");
  Piece& piece = pieces_.back();
  if (section == "PointData") return take_data(array, piece.point_data, piece.n_points);
  if (section == "CellData") return take_data(array, piece.cell_data, piece.n_cells);
  if (section == "Cells") return take_cells(array, piece);
  if (array.n_components != 3 || piece.has_points) source_.refuse("Points: one array of three components is wanted");
  piece.has_points = true;
  arrays_.read(array, 3 * piece.n_points, into(piece.points));
}

void VtuReader::take_cells(const detail::XmlArray& array, Piece& piece) {
  const bool is_whole = array.type && array.type->kind != detail::NumberType::Kind::Float;
  if (!is_whole || array.n_components != 1) source_.refuse("Cells: whole numbers are wanted");
  if (array.name == "connectivity") {
    arrays_.read(array, std::nullopt, into(piece.connectivity, [](std::int64_t v) {
                   return v >= 0 && v < std::int64_t{kMostPoints} ? static_cast<int>(v) : -1;
                 }));
  } else if (array.name == "offsets") {
    arrays_.read(array, piece.n_cells, into(piece.offsets, [this](std::int64_t v) {
                   if (v >= 0 && static_cast<double>(v) <= arrays_.most_values()) return v;
                   source_.refuse("offset " + std::to_string(v) + ": more than the file can hold");
                 }));
  } else if (array.name == "types") {
    piece.has_types = true;
    arrays_.read(array, piece.n_cells, into(piece.types, [](std::int64_t v) {
                   return static_cast<std::uint8_t>(v >= 0 && v < 256 ? v : 0);
                 }));
  } else {
    arrays_.read(array, std::nullopt, {});
  }
}

/// One number each, or three floats; others are checked and forgotten.
void VtuReader::take_data(const detail::XmlArray& array, Data& data, std::uint64_t n) {
  const bool is_float = array.type && array.type->kind == detail::NumberType::Kind::Float;
  const bool is_vector = is_float && array.n_components == 3;
  const std::uint64_t n_numbers = array.n_components * n;
  if (array.name.empty() || data.contains(array.name) || (array.n_components != 1 && !is_vector)) {
    return arrays_.read(array, n_numbers, {});
  }
  FieldValues& values = data[array.name];
  if (is_vector) {
    arrays_.read(array, n_numbers, into(values.emplace<std::vector<Vec3>>()));
  } else if (is_float) {
    arrays_.read(array, n_numbers, into(values.emplace<std::vector<double>>()));
  } else if (array.type_name == "UInt8") {
    arrays_.read(array, n_numbers, into(values.emplace<std::vector<std::uint8_t>>(), [](std::int64_t v) {
                   return static_cast<std::uint8_t>(v);
                 }));
  } else {
    arrays_.read(array, n_numbers, into(values.emplace<std::vector<std::int64_t>>(), [](std::int64_t v) { return v; }));
  }
}

template <class T>
void append(std::vector<T>& all, std::vector<T>&& some) {
  if (all.empty()) {
    all = std::move(some);
  } else {
    all.insert(all.end(), some.begin(), some.end());
    some = {};
  }
}

/// Only arrays that all pieces have, of one type, are of the whole.
void append(Data& all, Data&& some) {
  for (auto at = all.begin(); at != all.end();) {
    const auto other = some.find(at->first);
    if (other == some.end() || other->second.index() != at->second.index()) {
      at = all.erase(at);
      continue;
    }
    std::visit(
        [&]<class T>(std::vector<T>& values) { append(values, std::move(std::get<std::vector<T>>(other->second))); },
        at->second);
    ++at;
  }
}

/// Field data NAME = number are the names of regions, if each region has one.
void VtuReader::name_regions(Piece& piece) const {
  const auto found = piece.cell_data.find("region");
  const auto* regions =
      found == piece.cell_data.end() ? nullptr : std::get_if<std::vector<std::int64_t>>(&found->second);
  if (!regions) return;
  std::map<std::int64_t, std::string> names;
  for (const auto& [name, values] : field_data_) {
    if (values.size() == 1 && !names.emplace(values.front(), name).second) return;
  }
  if (std::all_of(regions->begin(), regions->end(), [&](std::int64_t r) { return names.contains(r); }))
    piece.region_names = std::move(names);
}

Piece VtuReader::joined() {
  if (pieces_.empty()) throw MeshFileRefused(path_, "", "no points in this file");
  for (const Piece& p : pieces_) {
    if (!p.has_points) throw MeshFileRefused(path_, "", "no points in this file");
    if (!p.has_types && p.n_cells > 0) throw MeshFileRefused(path_, "cell 0", "no cell types");
    if (p.offsets.size() != p.n_cells) throw MeshFileRefused(path_, "cell 0", "offsets missing");
  }
  Piece all = std::move(pieces_.front());
  for (pieces_.pop_front(); !pieces_.empty(); pieces_.pop_front()) {
    Piece& next = pieces_.front();
    if (all.n_points + next.n_points > kMostPoints || all.n_cells + next.n_cells > kMostPoints) {
      throw MeshFileRefused(path_, "", "more than 2^31 points or cells");
    }
    const auto n_before = static_cast<std::int64_t>(all.connectivity.size());
    for (int& v : next.connectivity) {
      v = v >= 0 && static_cast<std::uint64_t>(v) < next.n_points ? v + static_cast<int>(all.n_points) : -1;
    }
    for (std::int64_t& offset : next.offsets) offset += n_before;
    append(all.points, std::move(next.points));
    append(all.connectivity, std::move(next.connectivity));
    append(all.offsets, std::move(next.offsets));
    append(all.types, std::move(next.types));
    append(all.point_data, std::move(next.point_data));
    append(all.cell_data, std::move(next.cell_data));
    all.n_points += next.n_points;
    all.n_cells += next.n_cells;
  }
  return all;
}

/// Corners of the tets, every offset and index checked. `kept` receives the cell ids, `mid_sides` the other nodes of
/// those that have ten.
void take_tets(const std::filesystem::path& path, const Piece& grid, TetMesh& mesh, std::vector<std::size_t>& kept,
               std::vector<detail::MidSideNodes>& mid_sides) {
  const auto refuse = [&](std::size_t cell, const char* reason) {
    throw MeshFileRefused(path, "cell " + std::to_string(cell), reason);
  };
  const auto n_indices = static_cast<std::int64_t>(grid.connectivity.size());
  for (std::size_t c = 0; c < grid.n_cells; ++c) {
    const std::uint8_t type = grid.types[c];
    if (type != kTetra && type != kQuadraticTetra) continue;
    const std::int64_t begin = c == 0 ? 0 : grid.offsets[c - 1], end = grid.offsets[c];
    if (!(begin >= 0 && end >= begin && end <= n_indices)) refuse(c, "offsets do not ascend within the connectivity");
    if (end - begin != (type == kTetra ? 4 : 10)) refuse(c, "a tet with a wrong number of points");
    QuadraticTet tet{};
    for (std::int64_t k = 0; k < end - begin; ++k) {
      const int v = grid.connectivity[static_cast<std::size_t>(begin + k)];
      if (v < 0 || static_cast<std::uint64_t>(v) >= grid.n_points) refuse(c, "a point index out of range");
      tet[static_cast<std::size_t>(k)] = v;
    }
    mesh.C.push_back({tet[0], tet[1], tet[2], tet[3]});
    if (type == kQuadraticTetra) mid_sides.push_back({tet[4], tet[5], tet[6], tet[7], tet[8], tet[9]});
    kept.push_back(c);
  }
}

/// Data of the kept cells, of those of all.
void keep(Data& data, const std::vector<std::size_t>& kept, std::size_t n_cells) {
  if (kept.size() == n_cells) return;
  const auto keep_values = [&](auto& values) {
    for (std::size_t i = 0; i < kept.size(); ++i) values[i] = values[kept[i]];
    values.resize(kept.size());
  };
  for (auto& [name, values] : data) std::visit(keep_values, values);
}

Piece grid_of(const std::filesystem::path& path) {
  try {
    return VtuReader(path).read();
  } catch (const std::bad_alloc&) {
    throw MeshFileRefused(path, "", "its arrays do not fit into memory");
  }
}

}  // namespace

MeshFile detail::read_vtu(const std::filesystem::path& path) {
  require_regular_file(path);
  Piece grid = grid_of(path);
  MeshFile file;
  std::vector<std::size_t> kept;
  std::vector<MidSideNodes> mid_sides;
  take_tets(path, grid, file.mesh, kept, mid_sides);
  if (file.mesh.C.empty()) throw MeshFileRefused(path, "", "no tets in this file");
  grid.connectivity = {};
  grid.offsets = {};
  file.mesh.V = std::move(grid.points);
  file.point_data = std::move(grid.point_data);
  file.cell_data = std::move(grid.cell_data);
  file.region_names = std::move(grid.region_names);
  keep(file.cell_data, kept, grid.n_cells);
  const auto point_number = [](std::size_t v) { return static_cast<std::int64_t>(v); };
  refuse_broken_tets(path, file.mesh, point_number, [&](std::size_t t) { return static_cast<std::int64_t>(kept[t]); });
  take_mid_sides(path, file, mid_sides, point_number);
  drop_unused_vertices(file);
  return file;
}

}  // namespace umtet
