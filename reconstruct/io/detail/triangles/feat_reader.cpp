#include <fmt/format.h>

#include <string_view>
#include <vector>

#include "reconstruct/io/detail/text_rows.h"
#include "reconstruct/io/detail/triangles/line_readers.h"

namespace umtet::detail {
namespace {

class FeatReader {
 public:
  explicit FeatReader(const CloudSource& source) : source_(source), lines_(source.bytes) {}

  FeatureLinesFile read() {
    made_.format = "feat";
    next([] { return "the word feat and the number of polylines"; });
    if (words_.size() == 1) {
      next([] { return "the number of polylines"; });
    } else {
      words_.erase(words_.begin());
    }
    const std::uint64_t n = count("polylines");
    for (std::uint64_t k = 0; k < n; ++k) {
      if (!find_words())
        refuse(source_,
               fmt::format("line {}: the file ends before polyline {} of {}: it is cut short, or it has {} and "
                           "its first count is wrong; export it again",
                           lines_.line(), k + 1, n, k));
      polyline(count("points"), k, n);
    }
    if (find_words()) {
      refuse(source_, fmt::format("line {}: the file goes on after its {} polylines: a count is wrong, export it again",
                                  lines_.line(), n));
    }
    return std::move(made_);
  }

 private:
  /// Splits the next line that is neither blank nor a comment.
  bool find_words() {
    std::string_view line;
    while (lines_.next_filled(line)) {
      split(line, " \t", words_);
      if (words_[0][0] != '#') return true;
    }
    return false;
  }

  /// @param wanted  returns the words for a message
  template <class Wanted>
  void next(Wanted wanted) {
    if (find_words()) return;
    refuse(source_,
           fmt::format("line {}: the file ends before {}: it is cut short, export it again", lines_.line(), wanted()));
  }

  std::uint64_t count(const char* what) const {
    const auto n = parse_count(words_[0]);
    if (n && words_.size() == 1) return *n;
    refuse(source_, fmt::format("line {}: {} is no number of {}: export the file again", lines_.line(),
                                in_quotes(words_[0]), what));
  }

  void polyline(std::uint64_t n_points, std::uint64_t k, std::uint64_t n) {
    for (std::uint64_t i = 0; i < n_points; ++i) {
      next([&] { return fmt::format("point {} of {} of polyline {} of {}", i + 1, n_points, k + 1, n); });
      if (words_.size() != 3)
        refuse(source_,
               fmt::format("line {}: {} values instead of x y z, of point {} of {} of polyline {} of {}: a count "
                           "is wrong, or the file is damaged; export it again",
                           lines_.line(), words_.size(), i + 1, n_points, k + 1, n));
      Vec3 x;
      for (int a = 0; a < 3; ++a) x[a] = parse_number(source_, lines_.line(), words_[a]);
      add_point(source_, lines_.line(), x, made_);
      const int at = static_cast<int>(made_.lines.points.size()) - 1;
      if (i > 0) made_.lines.segments.push_back({at - 1, at});
    }
  }

  const CloudSource& source_;
  LineReader lines_;
  std::vector<std::string_view> words_;
  FeatureLinesFile made_;
};

}  // namespace

FeatureLinesFile read_feat(const CloudSource& source) { return FeatReader(source).read(); }

}  // namespace umtet::detail
