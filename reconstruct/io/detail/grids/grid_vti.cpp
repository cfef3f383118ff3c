// VTK ImageData in XML: tags up to the first array of numbers that counts, then its block, inline or appended.
#include <cstdlib>

#include "common/vtk_xml/array_reader.h"
#include "reconstruct/io/detail/grids/grid_source.h"

namespace umtet::detail {
namespace {

class Reader {
 public:
  explicit Reader(GridSource& source) : source_(source), tags_(source), arrays_(source) {}

  Grid read() {
    XmlTag tag;
    while (!is_done_ && tags_.next(tag)) take_tag(tag);
    if (!is_done_) source_.refuse("no array of one number a node");
    return std::move(grid_);
  }

 private:
  void take_tag(const XmlTag& tag) {
    if (tag.is_closing) {
      if (tag.name == section_) section_.clear();
      return;
    }
    if (tags_.parent().empty()) arrays_.take_root(tag, "ImageData");
    if (tag.name == "ImageData") take_image(tag);
    if (tag.name == "Piece" && tag["Extent"] != extent_) source_.refuse("a piece that is not the whole");
    if (tag.name == "PointData" || tag.name == "CellData") {
      section_ = tag.name;
      scalars_ = tag["Scalars"];
    }
    if (tag.name == "DataArray") take_array(tag);
    if (tag.name != "AppendedData") return;
    if (!is_chosen_) source_.refuse("no array of one number a node");
    arrays_.read_appended(tag);
    is_done_ = true;
  }

  void take_image(const XmlTag& tag) {
    extent_ = tag["WholeExtent"];
    const std::vector<std::string_view> ends = words_of(extent_);
    if (ends.size() != 6) source_.refuse("WholeExtent: six numbers are wanted");
    const Vec3 spacing = three(tag["Spacing"], Vec3::Ones());
    grid_.axes = spacing.asDiagonal();
    if (const std::string_view direction = tag["Direction"]; !direction.empty()) {
      const std::vector<std::string_view> words = words_of(direction);
      if (words.size() != 9) source_.refuse("Direction: nine numbers are wanted");
      for (int k = 0; k < 9; ++k) grid_.axes(k / 3, k % 3) = number_of(source_, words[static_cast<std::size_t>(k)]);
      grid_.axes = grid_.axes * spacing.asDiagonal();
    }
    Vec3 first;
    n_.clear();
    for (int k = 0; k < 3; ++k) {
      const std::int64_t begin = count_of(source_, ends[static_cast<std::size_t>(2 * k)]),
                         end = count_of(source_, ends[static_cast<std::size_t>(2 * k + 1)]);
      if (std::abs(begin) > (1 << 30) || end < begin || end > (1 << 30)) source_.refuse("an extent that is none");
      n_.push_back(end - begin + 1);
      first[k] = static_cast<double>(begin);
    }
    grid_.origin = three(tag["Origin"], Vec3::Zero()) + grid_.axes * first;
  }

  Vec3 three(std::string_view text, const Vec3& otherwise) const {
    if (text.empty()) return otherwise;
    const std::vector<std::string_view> words = words_of(text);
    if (words.size() != 3) source_.refuse(in_quotes(text) + ": three numbers are wanted");
    return {number_of(source_, words[0]), number_of(source_, words[1]), number_of(source_, words[2])};
  }

  /// The first array of one number a node, or the one that is named.
  void take_array(const XmlTag& tag) {
    if (section_.empty() || is_chosen_) return skip_inline(tag);
    const XmlArray array = arrays_.array(tag);
    if (array.n_components != 1 || (!scalars_.empty() && array.name != scalars_)) return skip_inline(tag);
    if (n_.size() != 3) source_.refuse("ImageData are missing");
    is_chosen_ = true;
    if (section_ == "CellData") {
      for (std::int64_t& n : n_) --n;
      grid_.origin += grid_.axes * Vec3::Constant(.5);
    }
    source_.require_nodes(n_, arrays_.least_bytes(array));
    grid_.n = {static_cast<int>(n_[0]), static_cast<int>(n_[1]), static_cast<int>(n_[2])};
    grid_.is_whole = array.type && array.type->kind != NumberType::Kind::Float;
    arrays_.read(array, grid_.size(), {.doubles = [this](std::span<const double> some) {
                   grid_.values.insert(grid_.values.end(), some.begin(), some.end());
                 }});
    is_done_ = array.format != XmlArray::Format::Appended;
  }

  /// Of an array that does not count.
  void skip_inline(const XmlTag& tag) {
    if (!tag.is_empty) source_.skip_to('<');
  }

  GridSource& source_;
  XmlTags tags_;
  ArrayReader arrays_;
  Grid grid_;
  std::vector<std::int64_t> n_;
  std::string extent_, section_, scalars_;
  bool is_chosen_ = false, is_done_ = false;
};

}  // namespace

Grid read_image_data(GridSource& source) { return Reader(source).read(); }

}  // namespace umtet::detail
