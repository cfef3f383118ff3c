// Input files of Abaqus and CalculiX: nodes, tets, and the sets of elements that divide the tets.
#include <algorithm>
#include <cctype>
#include <charconv>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mesh/io/detail/mesh_formats.h"

namespace umtet::detail {
namespace {

constexpr int kNone = -1;     // in place of a set
constexpr int kSeveral = -2;  // sets

std::string upper(std::string_view text) {
  std::string s(text);
  std::transform(s.begin(), s.end(), s.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return s;
}

std::string_view trimmed(std::string_view text) {
  const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

/// The fields between commas. A comma at the end of a line adds no field.
std::vector<std::string_view> fields_of(std::string_view line) {
  std::vector<std::string_view> fields;
  for (;;) {
    const std::size_t comma = line.find(',');
    fields.push_back(trimmed(line.substr(0, comma)));
    if (comma == std::string_view::npos) break;
    line.remove_prefix(comma + 1);
  }
  if (fields.size() > 1 && fields.back().empty()) fields.pop_back();
  return fields;
}

/// A line such as *ELEMENT, TYPE=C3D4, ELSET=bone.
struct Keyword {
  std::string name;                               ///< upper case, without the star
  std::map<std::string, std::string_view> value;  ///< by parameter in upper case
  std::string_view operator[](const char* parameter) const {
    const auto found = value.find(parameter);
    return found == value.end() ? std::string_view() : found->second;
  }
};

Keyword keyword_of(std::string_view line) {
  Keyword keyword;
  const std::vector<std::string_view> fields = fields_of(line.substr(1));
  keyword.name = upper(fields.front());
  for (std::size_t k = 1; k < fields.size(); ++k) {
    const std::size_t equals = fields[k].find('=');
    std::string_view value = equals == std::string_view::npos ? "" : trimmed(fields[k].substr(equals + 1));
    if (value.size() > 1 && value.front() == '"' && value.back() == '"') value = value.substr(1, value.size() - 2);
    keyword.value.emplace(upper(trimmed(fields[k].substr(0, equals))), value);
  }
  return keyword;
}

/// The nodes of a type of solid tets, such as C3D4, DC3D10 or C3D10M; 0: another type.
int nodes_of(std::string_view type) {
  const std::string name = upper(type);
  const std::size_t at = name.find("3D");
  if (at == std::string::npos) return 0;
  int n = 0;
  std::from_chars(name.data() + at + 2, name.data() + name.size(), n);
  return n == 4 || n == 10 ? n : 0;
}

class InpReader {
 public:
  InpReader(const std::filesystem::path& path, std::string_view bytes) : in_(path, bytes) {}
  NumberedMesh read();

 private:
  void begin(const Keyword& keyword);
  void take_line(std::string_view line);
  void take_node(const std::vector<std::string_view>& fields);
  void take_element(const std::vector<std::string_view>& fields);
  void take_members(const std::vector<std::string_view>& fields);
  std::int64_t whole(std::string_view text, const char* what);
  double real(std::string_view text);
  int set_of(std::string_view name);
  std::optional<std::vector<int>> sets_of_tets();

  enum class Section : std::uint8_t { Other, Nodes, Elements, Members };
  /// Elements of a set: from first to last in steps.
  struct Range {
    int set;
    std::int64_t first, last, step;
  };

  ByteCursor in_;
  NumberedMesh mesh_;
  Section section_ = Section::Other;
  int n_nodes_ = 0, n_parts_ = 0;
  int set_ = kNone;  ///< of the lines that follow
  bool generates_ = false;
  std::vector<std::int64_t> element_;              ///< the fields of an element that goes on in the next line
  std::vector<std::pair<std::int64_t, int>> tet_;  ///< number of each tet, and its index
  std::vector<int> marks_;                         ///< the set on the *ELEMENT line of each tet
  std::map<std::string, int> index_of_set_;        ///< by the name in upper case
  std::vector<std::string> set_names_;
  std::vector<Range> ranges_;
  std::vector<std::pair<int, std::string>> nested_;  ///< sets with the names of their members
};

std::int64_t InpReader::whole(std::string_view text, const char* what) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size())
    in_.refuse(std::string(what) + ": not a whole number in the line before");
  return value;
}

double InpReader::real(std::string_view text) {
  if (text.empty()) return 0;  // so Abaqus reads it
  std::string copy(text);
  std::replace_if(
      copy.begin(), copy.end(), [](char c) { return c == 'd' || c == 'D'; }, 'e');
  const char* begin = copy.data() + (copy.front() == '+' ? 1 : 0);
  double value = 0;
  const auto [end, error] = std::from_chars(begin, copy.data() + copy.size(), value);
  if (error != std::errc() || end != copy.data() + copy.size())
    in_.refuse("node coordinate: not a number in the line before");
  return value;
}

int InpReader::set_of(std::string_view name) {
  if (name.empty()) return kNone;
  const auto [at, is_new] = index_of_set_.emplace(upper(name), static_cast<int>(set_names_.size()));
  if (is_new) set_names_.emplace_back(name);
  return at->second;
}

void InpReader::begin(const Keyword& keyword) {
  if (!element_.empty()) in_.refuse("an element without all of its nodes before this line");
  section_ = Section::Other;
  if (keyword.name == "NODE") {
    section_ = Section::Nodes;
  } else if (keyword.name == "ELEMENT") {
    n_nodes_ = nodes_of(keyword["TYPE"]);
    if (n_nodes_ > 0) section_ = Section::Elements;
    set_ = set_of(keyword["ELSET"]);
  } else if (keyword.name == "ELSET") {
    set_ = set_of(keyword["ELSET"]);
    generates_ = keyword.value.contains("GENERATE");
    if (set_ != kNone) section_ = Section::Members;
  } else if (keyword.name == "PART" && ++n_parts_ > 1) {
    in_.refuse("a second *PART; files with one part are read");
  }
}

void InpReader::take_node(const std::vector<std::string_view>& fields) {
  if (fields.size() < 2) in_.refuse("a node without coordinates before this line");
  Vec3 x = Vec3::Zero();
  for (std::size_t k = 1; k < std::min<std::size_t>(fields.size(), 4); ++k)
    x[static_cast<int>(k) - 1] = real(fields[k]);
  mesh_.number.push_back(whole(fields[0], "node number"));
  mesh_.point.push_back(x);
}

void InpReader::take_element(const std::vector<std::string_view>& fields) {
  for (const std::string_view field : fields) element_.push_back(whole(field, "node of an element"));
  const auto wanted = static_cast<std::size_t>(n_nodes_) + 1;
  if (element_.size() > wanted) in_.refuse("an element with more nodes than its type has, before this line");
  if (element_.size() < wanted) return;
  tet_.emplace_back(element_[0], static_cast<int>(mesh_.tets.size()));
  marks_.push_back(set_);
  std::copy_n(element_.begin() + 1, 4, mesh_.tets.emplace_back().begin());
  if (n_nodes_ == 10) std::copy_n(element_.begin() + 5, 6, mesh_.mid_sides.emplace_back().begin());
  element_.clear();
}

void InpReader::take_members(const std::vector<std::string_view>& fields) {
  if (generates_) {
    if (fields.size() < 2) in_.refuse("GENERATE: first, last and step are wanted before this line");
    const std::int64_t step = fields.size() > 2 ? whole(fields[2], "step") : 1;
    ranges_.push_back({set_, whole(fields[0], "element number"), whole(fields[1], "element number"),
                       std::max<std::int64_t>(step, 1)});
    return;
  }
  for (const std::string_view field : fields) {
    if (field.empty()) continue;
    if (std::isdigit(static_cast<unsigned char>(field.front()))) {
      const std::int64_t number = whole(field, "element number");
      ranges_.push_back({set_, number, number, 1});
    } else {
      nested_.emplace_back(set_, upper(field));
    }
  }
}

void InpReader::take_line(std::string_view line) {
  const std::vector<std::string_view> fields = fields_of(line);
  if (section_ == Section::Nodes) take_node(fields);
  if (section_ == Section::Elements) take_element(fields);
  if (section_ == Section::Members) take_members(fields);
}

/// The set of each tet, where the sets that *ELSET defines contain each tet once. A set of all tets does not count.
std::optional<std::vector<int>> InpReader::sets_of_tets() {
  std::sort(tet_.begin(), tet_.end());
  std::vector<std::vector<int>> members(set_names_.size());
  std::vector<char> is_listed(set_names_.size(), 0);
  for (const Range& r : ranges_) {
    is_listed[static_cast<std::size_t>(r.set)] = 1;
    for (auto at = std::lower_bound(tet_.begin(), tet_.end(), std::pair(r.first, 0));
         at != tet_.end() && at->first <= r.last; ++at) {
      // Unsigned: numbers may be as far apart as 64 bits allow.
      const auto from_first = static_cast<std::uint64_t>(at->first) - static_cast<std::uint64_t>(r.first);
      if (from_first % static_cast<std::uint64_t>(r.step) == 0)
        members[static_cast<std::size_t>(r.set)].push_back(at->second);
    }
  }
  for (const auto& [set, name] : nested_) {
    const auto found = index_of_set_.find(name);
    if (found == index_of_set_.end() || found->second == set) continue;
    is_listed[static_cast<std::size_t>(set)] = 1;
    std::vector<int>& all = members[static_cast<std::size_t>(set)];
    for (std::size_t t = 0; t < marks_.size(); ++t)
      if (marks_[t] == found->second) all.push_back(static_cast<int>(t));
  }
  std::vector<int> of_tet(mesh_.tets.size(), kNone);
  for (std::size_t s = 0; s < members.size(); ++s) {
    std::vector<int>& tets = members[s];
    std::sort(tets.begin(), tets.end());
    tets.erase(std::unique(tets.begin(), tets.end()), tets.end());
    if (!is_listed[s] || tets.size() == of_tet.size()) continue;
    for (const int t : tets) of_tet[t] = of_tet[t] == kNone ? static_cast<int>(s) : kSeveral;
  }
  if (std::any_of(of_tet.begin(), of_tet.end(), [](int s) { return s < 0; })) return std::nullopt;
  return of_tet;
}

NumberedMesh InpReader::read() {
  bool known = false;
  while (in_.remaining() > 0) {
    std::string_view line = trimmed(in_.line());
    if (line.empty() || line.starts_with("**")) continue;
    if (line.front() != '*') {
      if (!known) in_.refuse("not an input file of Abaqus: no keyword at its beginning");
      take_line(line);
      continue;
    }
    known = true;
    std::string joined(line);  // a comma at its end continues a keyword in the next line
    while (joined.back() == ',' && in_.remaining() > 0) joined += trimmed(in_.line());
    begin(keyword_of(joined));
  }
  if (!element_.empty()) in_.refuse("the file ends in an element");
  if (mesh_.tets.empty()) in_.refuse("no tets in this file (files of *INCLUDE are not read)");
  const std::optional<std::vector<int>> sets = sets_of_tets();
  for (const int s : sets ? *sets : marks_)
    mesh_.region.push_back((s == kNone ? static_cast<std::int64_t>(set_names_.size()) : s) + 1);
  for (std::size_t s = 0; s < set_names_.size(); ++s)
    mesh_.region_names.emplace(static_cast<std::int64_t>(s) + 1, set_names_[s]);
  return std::move(mesh_);
}

}  // namespace

MeshFile read_inp(const std::filesystem::path& path) {
  const std::string bytes = file_bytes(path, "*NODE");
  return assemble(path, InpReader(path, bytes).read());
}

}  // namespace umtet::detail
