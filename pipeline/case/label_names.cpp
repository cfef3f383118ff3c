#include "pipeline/case/label_names.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <set>
#include <sstream>

#include "mesh/io/solver_mesh.h"
#include "pipeline/case/exit_code.h"
#include "pipeline/case/parameters.h"

namespace umtet {
namespace {

/// Converts a whole text to a number; returns nothing if that fails.
template <class Number>
std::optional<Number> number_of(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(number) : std::nullopt;
}

std::optional<int> label_of(const std::string& text, const std::map<int, std::string>& names) {
  if (const std::optional<int> label = number_of<int>(text)) return label;
  const auto at = std::find_if(names.begin(), names.end(), [&](const auto& n) { return n.second == text; });
  return at == names.end() ? std::nullopt : std::optional(at->first);
}

}  // namespace

std::string lower_case(std::string name) {
  for (char& c : name) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  return name;
}

std::map<int, std::string> parse_label_names(const std::string& text) {
  std::map<int, std::string> names;
  std::set<std::string> taken = {"body", kWholeBoundary};
  std::istringstream items(text);
  for (std::string item; std::getline(items, item, ',');) {
    const auto refuse = [&](const std::string& what) {
      throw UsageError(
          {Option{keys::output::label_names}, fmt::format(" '{}': {}; give LABEL=NAME,LABEL=NAME", item, what)});
    };
    const std::size_t equals = std::min(item.find('='), item.size());
    const std::optional<int> label = number_of<int>(std::string_view(item).substr(0, equals));
    if (!label || equals == item.size()) refuse("not LABEL=NAME");
    const std::string name = item.substr(equals + 1);
    if (const std::string problem = problem_of_name(name); !problem.empty()) refuse("the name " + problem);
    if (!taken.insert(lower_case(name)).second) refuse("the name is already in use (ignoring case)");
    if (!names.emplace(*label, name).second) refuse("the label already has a name");
  }
  return names;
}

void add_names_of_file(const std::vector<std::string>& of_file, std::map<int, std::string>& names) {
  constexpr std::size_t kLongest = 40;
  std::set<std::string> taken = {"body", kWholeBoundary, "walls", "closed_holes"};
  for (const auto& [label, name] : names) taken.insert(lower_case(name));
  for (std::size_t i = 0; i < of_file.size(); ++i) {
    const int label = static_cast<int>(i) + 1;
    if (names.contains(label)) continue;
    std::string name = of_file[i].substr(0, kLongest);
    std::replace_if(
        name.begin(), name.end(), [](char c) { return !problem_of_name(std::string("a") + c).empty(); }, '_');
    if (!problem_of_name(name).empty()) name = name.empty() ? fmt::format("patch_{}", label) : "patch_" + name;
    if (!problem_of_name(name).empty()) name = fmt::format("patch_{}", label);
    const std::string base = name;
    for (int k = label; !taken.insert(lower_case(name)).second; ++k) name = fmt::format("{}_{}", base, k);
    names.emplace(label, name);
  }
}

std::map<int, double> parse_label_sizes(const std::string& text, const std::map<int, std::string>& names) {
  std::map<int, double> factors;
  std::istringstream items(text);
  for (std::string item; std::getline(items, item, ',');) {
    const auto refuse = [&](const std::string& what) {
      throw UsageError({Option{keys::mesh::size_at},
                        fmt::format(" '{}': {}; give LABEL=FACTOR,LABEL=FACTOR with factors of h in (0, 1], and labels "
                                    "as numbers or by their names in ",
                                    item, what),
                        Option{keys::output::label_names}});
    };
    const std::size_t equals = std::min(item.find('='), item.size());
    if (equals == item.size()) refuse("not LABEL=FACTOR");
    const std::optional<int> label = label_of(item.substr(0, equals), names);
    if (!label) refuse("no label has this name");
    const std::optional<double> factor = number_of<double>(std::string_view(item).substr(equals + 1));
    if (!factor || !(*factor > 0 && *factor <= 1)) refuse("not a factor");
    if (!factors.emplace(*label, *factor).second) refuse("the label already has a factor");
  }
  return factors;
}

}  // namespace umtet
