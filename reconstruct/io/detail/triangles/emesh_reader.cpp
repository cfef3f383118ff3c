#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <optional>
#include <string_view>

#include "reconstruct/io/detail/text_rows.h"
#include "reconstruct/io/detail/triangles/line_readers.h"

namespace umtet::detail {
namespace {

/// The words of a file of OpenFOAM: brackets and semicolons are words; comments are none.
class FoamWords {
 public:
  explicit FoamWords(const CloudSource& source) : source_(source), bytes_(source.bytes) {}

  std::size_t line() const { return line_; }  ///< of the word that was read last
  /// The next word without taking it; empty at the end of the file.
  std::string_view peek() {
    skip_blanks();
    if (at_ == bytes_.size()) return {};
    if (is_single(bytes_[at_])) return bytes_.substr(at_, 1);
    std::size_t end = at_;
    while (end < bytes_.size() && !is_blank(bytes_[end]) && !is_single(bytes_[end])) ++end;
    return bytes_.substr(at_, end - at_);
  }
  std::string_view take() {
    const std::string_view word = peek();
    at_ += word.size();
    return word;
  }
  /// @param where  returns the words for a message
  template <class Where>
  void expect(std::string_view wanted, Where where) {
    const std::string_view word = take();
    if (word == wanted) return;
    if (word.empty())
      refuse(source_, fmt::format("line {}: the file ends before '{}' {}: it is cut short, export it again", line_,
                                  wanted, where()));
    refuse(source_, fmt::format("line {}: {} instead of '{}' {}: a count is wrong, or the file is damaged; export it "
                                "again",
                                line_, in_quotes(word), wanted, where()));
  }

 private:
  static bool is_single(char c) { return c == '(' || c == ')' || c == '{' || c == '}' || c == ';'; }
  static bool is_blank(char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; }
  void skip_to(std::size_t at) {
    line_ += static_cast<std::size_t>(std::count(bytes_.begin() + static_cast<std::ptrdiff_t>(at_),
                                                 bytes_.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
    at_ = at;
  }
  void skip_blanks() {
    for (;;) {
      std::size_t at = at_;
      while (at < bytes_.size() && is_blank(bytes_[at])) ++at;
      skip_to(at);
      const bool is_line = bytes_.substr(at_, 2) == "//", is_block = bytes_.substr(at_, 2) == "/*";
      if (!is_line && !is_block) return;
      const std::string_view end = is_line ? "\n" : "*/";
      skip_to(std::min(bytes_.size(), std::min(bytes_.find(end, at_ + 2), bytes_.size() - end.size()) + end.size()));
    }
  }

  const CloudSource& source_;
  std::string_view bytes_;
  std::size_t at_ = 0, line_ = 1;
};

class EMeshReader {
 public:
  explicit EMeshReader(const CloudSource& source) : source_(source), words_(source) {}

  FeatureLinesFile read() {
    made_.format = "eMesh";
    header();
    list("points", [&](const auto& place) {
      Vec3 x;
      for (int a = 0; a < 3; ++a) x[a] = parse_number(source_, words_.line(), word(place));
      add_point(source_, words_.line(), x, made_);
    });
    list("edges", [&](const auto& place) {
      std::array<int, 2> ends;
      for (int& end : ends) end = index(place);
      made_.lines.segments.push_back(ends);
    });
    if (!is_extended_ && !words_.peek().empty())
      refuse(source_, fmt::format("line {}: {} after the list of edges: a count is wrong, export the file again",
                                  words_.line(), in_quotes(words_.peek())));
    return std::move(made_);
  }

 private:
  template <class Place>
  std::string_view word(Place place) {
    const std::string_view next = words_.take();
    if (next.empty())
      refuse(source_,
             fmt::format("line {}: the file ends in {}: it is cut short, export it again", words_.line(), place()));
    return next;
  }

  void header() {
    words_.expect("FoamFile", [] { return "at the beginning"; });
    words_.expect("{", [] { return "after FoamFile"; });
    const auto here = [] { return "the header FoamFile"; };
    while (words_.peek() != "}") {
      const std::string_view key = word(here), value = word(here);
      if (value == ";") continue;
      if (key == "format" && value != "ascii")
        refuse(source_,
               fmt::format("line {}: format {}: only ascii is read; set 'writeFormat ascii' and write the file "
                           "again",
                           words_.line(), in_quotes(value)));
      if (key == "class") check_class(value);
      while (word(here) != ";") {
      }
    }
    words_.take();
  }

  void check_class(std::string_view name) {
    is_extended_ = name == "extendedFeatureEdgeMesh" || name == "extendedEdgeMesh";
    if (is_extended_ || name == "featureEdgeMesh" || name == "edgeMesh") return;
    refuse(source_, fmt::format("line {}: class {} has no edges: give a featureEdgeMesh, as surfaceFeatures writes it",
                                words_.line(), in_quotes(name)));
  }

  /// Reads "N ( (...) (...) )"; the number may be missing, as OpenFOAM has it.
  template <class Read>
  void list(const std::string& name, Read read) {
    std::optional<std::uint64_t> n;
    if (words_.peek() != "(") {
      const std::string_view count = word([&] { return "the number of " + name; });
      n = parse_count(count);
      if (!n)
        refuse(source_, fmt::format("line {}: {} is no number of {}: export the file again", words_.line(),
                                    in_quotes(count), name));
    }
    words_.expect("(", [&] { return "at the list of " + name; });
    std::uint64_t k = 0;
    for (; n ? k < *n : words_.peek() != ")"; ++k) {
      const auto place = [&] {
        return n ? fmt::format("item {} of {} of the {}", k + 1, *n, name)
                 : fmt::format("item {} of the {}", k + 1, name);
      };
      words_.expect("(", [&] { return "at " + place(); });
      read(place);
      words_.expect(")", [&] { return "at the end of " + place(); });
    }
    words_.expect(")", [&] { return "at the end of the list of " + name; });
  }

  template <class Place>
  int index(Place place) {
    const std::string_view text = word(place);
    const auto n = parse_count(text);
    if (n && *n < made_.lines.points.size()) return static_cast<int>(*n);
    refuse(source_, fmt::format("line {}: {} is no point, of {} (counted from 0): the file is damaged, export it again",
                                words_.line(), in_quotes(text), made_.lines.points.size()));
  }

  const CloudSource& source_;
  FoamWords words_;
  bool is_extended_ = false;
  FeatureLinesFile made_;
};

}  // namespace

FeatureLinesFile read_emesh(const CloudSource& source) { return EMeshReader(source).read(); }

}  // namespace umtet::detail
