// VTK's legacy files of structured points (VTK User's Guide, "Simple Legacy Formats"); binary numbers are big-endian.
#include <bit>

#include "reconstruct/io/detail/grids/grid_source.h"

namespace umtet::detail {
namespace {

constexpr int kMostLines = 1000;  // before the numbers

class LegacyReader {
 public:
  explicit LegacyReader(GridSource& source) : source_(source) {}

  Grid read() {
    source_.line();  // # vtk DataFile Version
    source_.line();  // a title
    const std::string form = source_.line();
    is_text_ = form.starts_with("ASCII");
    if (!is_text_ && !form.starts_with("BINARY")) source_.refuse("ASCII or BINARY is wanted, not " + in_quotes(form));
    for (int n = 0; n < kMostLines; ++n) {
      line_ = source_.line();
      words_ = words_of(line_);
      if (words_.empty()) continue;
      if (take_line()) return std::move(grid_);
    }
    source_.refuse("no numbers in the first thousand lines");
  }

 private:
  /// True when the numbers have been read.
  bool take_line() {
    const std::string_view key = words_.front();
    if (key == "DATASET") {
      if (words_.size() < 2 || words_[1] != "STRUCTURED_POINTS") source_.refuse("STRUCTURED_POINTS are wanted");
    } else if (key == "DIMENSIONS") {
      n_ = {count_of(source_, word(1)), count_of(source_, word(2)), count_of(source_, word(3))};
    } else if (key == "SPACING" || key == "ASPECT_RATIO") {
      grid_.axes = three().asDiagonal();
    } else if (key == "ORIGIN") {
      grid_.origin = three();
    } else if (key == "POINT_DATA" || key == "CELL_DATA") {
      of_cells_ = key == "CELL_DATA";
    } else if (key == "SCALARS") {
      if (words_.size() > 3 && words_[3] != "1") source_.refuse("one number a node is wanted");
      const std::string_view type = word(2);
      const std::string type_name(type);
      if (!source_.line().starts_with("LOOKUP_TABLE")) source_.refuse("LOOKUP_TABLE is missing");
      take_values(type_name);
      return true;
    } else if (key == "FIELD") {
      if (count_of(source_, word(2)) < 1) source_.refuse("a field without an array");
      line_ = source_.line();  // NAME COMPONENTS TUPLES TYPE
      words_ = words_of(line_);
      if (word(1) != "1") source_.refuse("one number a node is wanted");
      take_values(std::string(word(3)));
      return true;
    }
    return false;
  }

  std::string_view word(std::size_t k) const {
    if (k >= words_.size()) source_.refuse("a line that is cut: " + in_quotes(line_));
    return words_[k];
  }
  Vec3 three() const { return {number_of(source_, word(1)), number_of(source_, word(2)), number_of(source_, word(3))}; }

  void take_values(const std::string& type_name) {
    const std::optional<NumberType> type = number_type(type_name);
    if (!type) source_.refuse(in_quotes(type_name) + " is no type of numbers");
    if (n_.size() != 3) source_.refuse("DIMENSIONS are missing");
    if (of_cells_) {
      for (std::int64_t& n : n_) --n;
      grid_.origin += grid_.axes * Vec3::Constant(.5);
    }
    source_.require_nodes(n_, is_text_ ? kBytesOfWord : type->bytes);
    grid_.n = {static_cast<int>(n_[0]), static_cast<int>(n_[1]), static_cast<int>(n_[2])};
    grid_.is_whole = type->kind != NumberType::Kind::Float;
    grid_.values = is_text_ ? source_.take_words(grid_.size())
                            : source_.take_numbers(grid_.size(), *type, std::endian::native == std::endian::little);
  }

  GridSource& source_;
  std::string line_;
  std::vector<std::string_view> words_;  ///< of line_
  std::vector<std::int64_t> n_;
  bool is_text_ = false, of_cells_ = false;
  Grid grid_;
};

}  // namespace

Grid read_structured_points(GridSource& source) { return LegacyReader(source).read(); }

}  // namespace umtet::detail
