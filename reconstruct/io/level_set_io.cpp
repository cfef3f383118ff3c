#include "reconstruct/io/level_set_io.h"

#include <fmt/format.h>
#include <xxhash.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <utility>
#include <variant>

#include "common/vtk_xml/array_reader.h"
#include "reconstruct/io/detail/grids/vti_writer.h"

namespace umtet {

namespace {

// Two halves of the hash of all coefficients.
std::vector<double> hash(const LevelSet& psi) {
  XXH64_hash_t h = XXH64(psi.coarsest().coefficients.data(),
                         static_cast<std::size_t>(psi.coarsest().lattice.size()) * sizeof(double), 0);
  for (int level = 1; level < psi.n_levels(); ++level) {
    const LevelSetBand& band = psi.band(level);
    h = XXH64(band.blocks.blocks().data(), band.blocks.blocks().size() * sizeof(Eigen::Vector3i), h);
    h = XXH64(band.coefficients.data(), band.coefficients.size() * sizeof(float), h);
  }
  return {static_cast<double>(h >> 32), static_cast<double>(h & 0xffffffffu)};
}

std::string band_name(int level, const char* what) { return fmt::format("level_{}_{}", level, what); }

using Values = std::variant<std::vector<double>, std::vector<float>>;

// The arrays of a .vti that write_level_set() made. Strict: what else ImageData may hold is refused.
class LevelSetFile {
 public:
  explicit LevelSetFile(const std::filesystem::path& path)
      : source_(path,
                [](const std::string& file, const std::string& what) { throw LevelSetRefused(file + ": " + what); }),
        tags_(source_),
        arrays_(source_) {
    detail::XmlTag tag;
    bool has_appended = false;
    while (!has_appended && tags_.next(tag)) {
      if (!tag.is_closing) open(tag);
      has_appended = tag.name == "AppendedData";
    }
    if (has_appended) arrays_.read_appended(tag);
    arrays_.finish();
    if (!has_piece_) source_.refuse("the file is cut");
  }

  const Eigen::Vector3i& n() const { return n_; }
  double n_bytes() const { return source_.most_bytes(); }
  bool has_field(const std::string& name) const { return fields_.contains(name); }
  // @param size  0: any
  template <class Value = double>
  std::vector<Value> field(const std::string& name, std::size_t size) {
    const auto found = fields_.find(name);
    auto* values = found == fields_.end() ? nullptr : std::get_if<std::vector<Value>>(&found->second);
    if (!values || (size > 0 && values->size() != size)) {
      throw LevelSetRefused(
          fmt::format("{}: field data '{}' with {} numbers is missing: not a level set of this program", source_.name(),
                      name, size));
    }
    return std::move(*values);
  }
  // Null if they are none of doubles.
  std::vector<double>* of_points(const std::string& name) {
    const auto found = points_.find(name);
    return found == points_.end() ? nullptr : std::get_if<std::vector<double>>(&found->second);
  }

 private:
  void open(const detail::XmlTag& tag) {
    static const std::map<std::string_view, std::vector<std::string_view>> kParents = {
        {"VTKFile", {""}},
        {"ImageData", {"VTKFile"}},
        {"FieldData", {"ImageData"}},
        {"Piece", {"ImageData"}},
        {"PointData", {"Piece"}},
        {"CellData", {"Piece"}},
        {"AppendedData", {"VTKFile"}},
        {"DataArray", {"FieldData", "PointData"}}};
    const auto it = kParents.find(tag.name);
    if (it == kParents.end() || std::find(it->second.begin(), it->second.end(), tags_.parent()) == it->second.end())
      source_.refuse("not what a level set of this program has here");
    if (tag.name == "VTKFile") {
      arrays_.take_root(tag, "ImageData");
      if (!arrays_.is_little_endian() || !arrays_.has_wide_headers() || arrays_.is_packed()) {
        source_.refuse("not a VTK ImageData file of this program");
      }
    }
    if (tag.name == "ImageData") take_extent(tag["WholeExtent"]);
    if (tag.name == "Piece") {
      if (has_piece_ || tag["Extent"] != extent_) source_.refuse("a piece that is not the whole");
      has_piece_ = true;
    }
    if (tag.name == "DataArray") take_array(tag);
  }

  // "0 n-1 0 n-1 0 n-1"; no more nodes than the file has bytes.
  void take_extent(std::string_view text) {
    extent_ = text;
    double n_nodes = 1;
    const char *at = text.data(), *end = at + text.size();
    for (int k = 0; k < 6; ++k) {
      while (at != end && *at == ' ') ++at;
      std::uint32_t value = 0;
      const auto [stop, error] = std::from_chars(at, end, value);
      if (error != std::errc() || (k % 2 == 0 && value != 0)) source_.refuse("an extent that is not 0 n 0 n 0 n");
      at = stop;
      if (k % 2 == 0) continue;
      n_nodes *= double(value) + 1;
      if (n_nodes > n_bytes()) source_.refuse("more nodes than the file has bytes");
      n_[k / 2] = static_cast<int>(value) + 1;
    }
    if (at != end) source_.refuse("an extent that is not 0 n 0 n 0 n");
  }

  void take_array(const detail::XmlTag& tag) {
    const detail::XmlArray array = arrays_.array(tag);
    const bool is_float = array.type && array.type->kind == detail::NumberType::Kind::Float;
    if (!is_float || array.format == detail::XmlArray::Format::Ascii || array.name.empty() || array.n_components != 1) {
      source_.refuse("an array of a kind that a level set does not have");
    }
    const bool is_field = tags_.parent() == "FieldData";
    const std::uint64_t n =
        is_field ? tag.count("NumberOfTuples", source_) : static_cast<std::uint64_t>(n_.cast<std::int64_t>().prod());
    if (static_cast<double>(n) > n_bytes()) source_.refuse("NumberOfTuples is no count");
    auto& arrays = is_field ? fields_ : points_;
    const auto [at, is_new] = arrays.try_emplace(array.name);
    if (!is_new) source_.refuse("an array that is there twice");
    Values& values = at->second;
    if (array.type->bytes == 4) values = std::vector<float>();
    arrays_.read(array, n, {.doubles = [&values](std::span<const double> some) {
                   std::visit([&](auto& all) { all.insert(all.end(), some.begin(), some.end()); }, values);
                 }});
  }

  detail::ByteStream source_;
  detail::XmlTags tags_;
  detail::ArrayReader arrays_;
  std::string extent_;
  Eigen::Vector3i n_ = Eigen::Vector3i::Zero();
  bool has_piece_ = false;
  std::map<std::string, Values> fields_, points_;
};

// The bands, on lattices that follow from the coarsest one.
std::vector<LevelSetBand> read_bands(LevelSetFile& content, const Lattice& coarsest, int half_width,
                                     const std::string& file) {
  const double n_bytes = content.n_bytes();
  std::vector<LevelSetBand> bands;
  Lattice lattice = coarsest;
  for (int level = 1; content.has_field(band_name(level, "blocks")); ++level) {
    // A band around a surface has more bytes than its lattice has blocks.
    const Eigen::Array3d n_blocks = 2 * lattice.n.array().cast<double>() / LatticeBlocks::kEdge;
    if (n_blocks.prod() > n_bytes || n_blocks.maxCoeff() > n_bytes) {
      throw LevelSetRefused(fmt::format("{}: level {} is finer than a file of {} bytes can be", file, level, n_bytes));
    }
    lattice.h /= 2;
    lattice.n = (2 * (lattice.n.array() - 1) + 1).matrix();
    const std::vector<double> corners = content.field(band_name(level, "blocks"), 0);
    std::vector<Eigen::Vector3i> blocks;
    for (std::size_t i = 0; i + 3 <= corners.size(); i += 3) {
      const Eigen::Vector3d at(corners[i], corners[i + 1], corners[i + 2]);
      // What is no index becomes none that a lattice has.
      const bool is_index = (at.array() >= 0).all() && (at.array() < n_bytes).all();
      blocks.push_back(is_index ? at.cast<int>() : Eigen::Vector3i(-1, -1, -1));
    }
    LevelSetBand band{LatticeBlocks(lattice, half_width, blocks), {}};
    if (corners.size() % 3 != 0 || band.blocks.blocks() != blocks) {
      throw LevelSetRefused(fmt::format("{}: the blocks of level {} are not in order", file, level));
    }
    band.coefficients = content.field<float>(band_name(level, "psi_a"), blocks.size() * LatticeBlocks::kNodes);
    bands.push_back(std::move(band));
  }
  return bands;
}

}  // namespace

void write_level_set(const std::filesystem::path& file, const LevelSet& psi, const Vec3& shown_at) {
  const LevelSetLevel& level = psi.coarsest();
  const Lattice& L = level.lattice;
  const detail::ImageNodes nodes{L.n, L.origin + shown_at, Vec3::Constant(L.h)};
  detail::AppendedWriter out;
  const auto field = [&out]<class T>(const std::string& name, std::span<const T> values) {
    out.array(name, values, fmt::format(" NumberOfTuples=\"{}\"", values.size()));
  };
  const LmePrior& prior = psi.prior();
  const std::vector<double> lattice{L.origin[0],    L.origin[1],    L.origin[2],   L.h,
                                    double(L.n[0]), double(L.n[1]), double(L.n[2])},
      of_prior{double(prior.kind), prior.gamma, double(prior.support), prior.epsilon}, check = hash(psi);
  detail::begin_image(out, nodes);
  field("lattice", std::span(lattice));
  field("prior", std::span(of_prior));
  std::vector<std::vector<double>> corners(static_cast<std::size_t>(psi.n_levels()));
  for (int l = 1; l < psi.n_levels(); ++l) {
    const LevelSetBand& band = psi.band(l);
    std::vector<double>& of_level = corners[static_cast<std::size_t>(l)];
    for (const Eigen::Vector3i& b : band.blocks.blocks()) of_level.insert(of_level.end(), b.begin(), b.end());
    field(band_name(l, "blocks"), std::span<const double>(of_level));
    field(band_name(l, "psi_a"), std::span<const float>(band.coefficients));
  }
  field("xxh64", std::span(check));
  detail::begin_point_data(out, nodes, "psi_a");
  out.array("psi_a", std::span(level.coefficients));
  detail::write_image(file, out);
}

LevelSet read_level_set(const std::filesystem::path& path) {
  const std::string file = path.string();
  LevelSetFile content(path);
  const std::vector<double> l = content.field("lattice", 7), p = content.field("prior", 4);
  const auto is_finite = [](double v) { return std::isfinite(v); };
  if (!std::all_of(l.begin(), l.end(), is_finite) || !std::all_of(p.begin(), p.end(), is_finite)) {
    throw LevelSetRefused(file + ": 'lattice' or 'prior' is absurd");
  }
  for (const double number : {p[0], p[2]}) {
    if (!(number >= 0 && number <= 4)) throw LevelSetRefused(file + ": unknown prior");
  }
  const LmePrior prior{static_cast<LmePrior::Kind>(static_cast<int>(p[0])), p[1], static_cast<int>(p[2]), p[3]};
  const std::vector<std::string> wrong = problems(prior);
  if (p[0] != 0 && p[0] != 1) throw LevelSetRefused(file + ": unknown prior");
  if (!wrong.empty()) throw LevelSetRefused(file + ": " + wrong.front());
  const Eigen::Vector3i& dims = content.n();
  Lattice lattice{{l[0], l[1], l[2]}, l[3], {dims[0], dims[1], dims[2]}};
  if (l[4] != dims[0] || l[5] != dims[1] || l[6] != dims[2] || !(l[3] > 0)) {
    throw LevelSetRefused(file + ": the field data 'lattice' does not fit the image");
  }
  std::vector<double>* a = content.of_points("psi_a");
  if (!a || static_cast<std::int64_t>(a->size()) != lattice.size()) {
    throw LevelSetRefused(fmt::format("{}: point data 'psi_a' with {} doubles is missing", file, lattice.size()));
  }
  std::vector<double> c = std::move(*a);
  for (const double v : c) {
    if (!std::isfinite(v)) throw LevelSetRefused(file + ": a coefficient is not finite");
  }
  try {
    LevelSet psi(prior, {lattice, std::move(c)}, read_bands(content, lattice, half_width(prior), file));
    if (content.field("xxh64", 2) != hash(psi)) {
      throw LevelSetRefused(file + ": damaged: the coefficients do not have the hash that was written with them");
    }
    return psi;
  } catch (const std::invalid_argument& e) {
    throw LevelSetRefused(fmt::format("{}: {}", file, e.what()));
  }
}

}  // namespace umtet
