#include "mesh/io/file_regions.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <string_view>
#include <variant>

namespace umtet {
namespace {

constexpr const char* kSources[] = {"region",   "gmsh:physical", "medit:ref", "cell_tags", "MaterialIds",
                                    "Material", "material",      "label",     "labels",    "subdomain"};

constexpr std::size_t kLongestShown = 64;  // characters of a name

/// Whole numbers of cell data; empty if they are others.
std::vector<std::int64_t> whole_numbers(const FieldValues& data) {
  if (const auto* wide = std::get_if<std::vector<std::int64_t>>(&data)) return *wide;
  if (const auto* bytes = std::get_if<std::vector<std::uint8_t>>(&data)) return {bytes->begin(), bytes->end()};
  return {};
}

/// Foreign text for people and tables: printable, and not long.
std::string shown(std::string name) {
  if (name.size() > kLongestShown) name.resize(kLongestShown);
  std::replace_if(
      name.begin(), name.end(), [](char c) { return c < ' ' || c > '~'; }, '?');
  return name;
}

bool is_outside(const std::string& name) {
  const std::string_view outside = kOutside;
  return name.size() == outside.size() && std::equal(name.begin(), name.end(), outside.begin(), [](char a, char b) {
           return std::tolower(static_cast<unsigned char>(a)) == b;
         });
}

}  // namespace

std::optional<FileRegions> file_regions(const MeshFile& file) {
  for (const char* source : kSources) {
    const auto found = file.cell_data.find(source);
    if (found == file.cell_data.end()) continue;
    const std::vector<std::int64_t> marks = whole_numbers(found->second);
    if (marks.empty()) continue;
    std::map<std::int64_t, int> region_of;
    for (const std::int64_t mark : marks) region_of[mark] = 0;
    if (region_of.size() < 2) return std::nullopt;
    const auto name_of = [&](std::int64_t mark) {
      const auto name = file.region_names.find(mark);
      return name == file.region_names.end() ? std::to_string(mark) : shown(name->second);
    };
    std::optional<std::int64_t> outside;
    if (region_of.contains(0)) outside = 0;
    for (const auto& [mark, region] : region_of)
      if (is_outside(name_of(mark))) outside = mark;
    FileRegions regions{.source = source, .names = {kOutside}, .marks = {0}, .has_outside = outside.has_value()};
    if (outside) {
      regions.marks[0] = *outside;
      regions.names[0] = *outside == 0 && name_of(0) == "0" ? kOutside : name_of(*outside);
    }
    for (auto& [mark, region] : region_of) {
      if (mark == outside) continue;
      region = static_cast<int>(regions.names.size());
      regions.names.push_back(name_of(mark));
      regions.marks.push_back(mark);
    }
    regions.of_tet.reserve(marks.size());
    for (const std::int64_t mark : marks) regions.of_tet.push_back(region_of[mark]);
    return regions;
  }
  return std::nullopt;
}

}  // namespace umtet
