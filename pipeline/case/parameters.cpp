#include "pipeline/case/parameters.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <numeric>

#include "mesh/background/tiling.h"
#include "pipeline/case/detail/param_field.h"
#include "pipeline/case/exit_code.h"
#include "pipeline/case/level_range.h"

namespace umtet {
namespace {

template <class T>
T parse_number(const ParamField& f, const std::string& text) {
  T v{};
  const char* end = text.data() + text.size();
  if constexpr (std::is_integral_v<T>) {          // 1e6 is a whole number, too
    constexpr double kExact = 9007199254740992.;  // 2^53
    double whole = 0;
    const auto [stop, error] = std::from_chars(text.data(), end, whole);
    if (error == std::errc() && stop == end && std::abs(whole) <= kExact && whole == std::trunc(whole)) {
      return static_cast<T>(whole);
    }
  }
  const auto [stop, error] = std::from_chars(text.data(), end, v);
  if (error != std::errc() || stop != end || text.empty()) {
    throw UsageError(fmt::format("{} = {}: not {} number", f.key, text, std::is_integral_v<T> ? "a whole" : "a"));
  }
  return v;
}

ParamValue parse(const ParamField& f, const std::string& text) {
  switch (f.preset.index()) {
    case 0:
      if (text == "true" || text == "1") return true;
      if (text == "false" || text == "0") return false;
      throw UsageError(f.key + " = " + text + ": must be true or false");
    case 1:
      return parse_number<std::int64_t>(f, text);
    case 2:
      return parse_number<double>(f, text);
    default:
      return text;
  }
}

/// Returns a value as the argument of a shell.
std::string typed(const ParamValue& value) {
  const auto* text = std::get_if<std::string>(&value);
  if (!text) {
    return std::visit([](const auto& v) { return fmt::format("{}", v); }, value);
  }
  constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789.,:/=+-_%@";
  if (!text->empty() && text->find_first_not_of(kPlain) == std::string::npos) return *text;
  std::string quoted = "'";
  for (const char c : *text) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return quoted + "'";
}

bool is_utf8(const std::string& text) {
  try {
    nlohmann::json(text).dump();
    return true;
  } catch (const nlohmann::json::type_error&) {
    return false;
  }
}

void check_background(const std::string& name) {
  const auto tilings = tiling_names();
  std::vector<std::string> names(tilings.begin(), tilings.end());
  names.emplace_back("graded");
  names.emplace_back("auto");
  const std::string ending = std::filesystem::path(name).extension();
  const bool is_file = ending == ".vtu" || ending == ".msh" || ending == ".mesh";
  if (is_file || std::find(names.begin(), names.end(), name) != names.end()) return;
  throw UsageError(
      fmt::format("mesh.background = {}: must be {} or a .vtu, .msh or .mesh file", name, fmt::join(names, ", ")));
}

void check(const ParamField& f, const ParamValue& value) {
  const auto in_range = [&](double v) {
    if (v >= f.min && v <= f.max) return;  // false for NaN
    throw UsageError(f.min == detail::kAboveZero ? fmt::format("{} = {}: must be > 0 and <= {}", f.key, v, f.max)
                                                 : fmt::format("{} = {}: must be in [{}, {}]", f.key, v, f.min, f.max));
  };
  if (const auto* i = std::get_if<std::int64_t>(&value)) in_range(static_cast<double>(*i));
  if (const auto* d = std::get_if<double>(&value)) in_range(*d);
  const auto* t = std::get_if<std::string>(&value);
  if (t && !f.choices.empty() && std::find(f.choices.begin(), f.choices.end(), *t) == f.choices.end()) {
    throw UsageError(fmt::format("{} = {}: this version has {} only", f.key, *t, fmt::join(f.choices, ", ")));
  }
  // TOML and JSON contain only UTF-8.
  if (t && !is_utf8(*t)) throw UsageError(f.key + ": the text is not valid UTF-8");
  if (f.key == keys::mesh::box) parse_box(*t);
  if (f.key == keys::mesh::level) parse_level(*t);
  if (f.key == keys::mesh::background) check_background(*t);
}

}  // namespace

const ParamField& detail::field(const std::string& key) {
  static const std::map<std::string, const ParamField*> index = [] {
    std::map<std::string, const ParamField*> m;
    for (const ParamField& f : params_fields()) m[f.key] = &f;
    return m;
  }();
  const auto it = index.find(key);
  if (it != index.end()) return *it->second;
  std::vector<std::string> keys;
  for (const ParamField& f : params_fields()) keys.push_back(f.key);
  const std::string near = nearest(key, keys);
  throw UsageError("unknown parameter " + key + (near.empty() ? "" : "; did you mean " + near + "?"));
}

std::string preset_text(const ParamField& f) {
  if (const auto* t = std::get_if<std::string>(&f.preset)) return *t;
  return detail::print(f.preset);
}

std::string nearest(std::string_view word, const std::vector<std::string>& candidates) {
  std::string best;
  // A candidate whose distance is larger than a third of the word is a different word.
  std::size_t best_distance = word.size() / 3 + 2;
  bool best_goes_on = false;
  for (const std::string& candidate : candidates) {
    std::vector<std::size_t> row(candidate.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 0; i < word.size(); ++i) {
      std::size_t diagonal = row[0];
      row[0] = i + 1;
      for (std::size_t j = 0; j < candidate.size(); ++j) {
        const std::size_t replace = diagonal + (word[i] != candidate[j]);
        diagonal = row[j + 1];
        row[j + 1] = std::min({replace, row[j] + 1, diagonal + 1});
      }
    }
    // Of two candidates at the same distance, prefer the one that begins with the word: --tet is --tets, not
    // --set.
    const bool goes_on = candidate.starts_with(word);
    if (row.back() < best_distance || (row.back() == best_distance && goes_on && !best_goes_on && !best.empty())) {
      best_distance = row.back();
      best_goes_on = goes_on;
      best = candidate;
    }
  }
  return best;
}

Parameters::Parameters() {
  for (const ParamField& f : params_fields()) origins_[f.key];
}

void Parameters::set(const std::string& key, const std::string& text, ParamSource source, const std::string& origin) {
  const ParamField& f = detail::field(key);
  assign(f, parse(f, text), source, origin);
}

void Parameters::set(const std::string& assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string::npos) throw UsageError("--set " + assignment + ": must be key=value");
  set(assignment.substr(0, equals), assignment.substr(equals + 1), ParamSource::Set, "--set");
}

namespace {

/// Parameters that set the same thing in different ways: the source of higher precedence overrides the others.
struct Ways {
  std::vector<const char*> keys;
  bool exclude;  ///< two of equal precedence are an error
};

const std::vector<Ways>& ways() {
  static const std::vector<Ways> list = {{{keys::mesh::h, keys::mesh::tets, keys::mesh::max_deviation}, true},
                                         {{keys::output::patch_angle, keys::output::patch_planar}, false},
                                         {{keys::reconstruct::close, keys::reconstruct::keep_open}, false}};
  return list;
}

/// Returns false for a number or switch that is 0, since it sets nothing. A text always sets something.
bool speaks(const ParamValue& v) {
  return v != ParamValue(0.) && v != ParamValue(std::int64_t{0}) && v != ParamValue(false);
}

}  // namespace

/// Resets the parameters that this value overrides. Returns false if another parameter of higher precedence
/// overrides it.
bool Parameters::silences_others(const ParamField& field, const ParamValue& value, ParamSource source) {
  const auto same = std::find_if(ways().begin(), ways().end(), [&](const Ways& w) {
    return std::find(w.keys.begin(), w.keys.end(), field.key) != w.keys.end();
  });
  if (same == ways().end() || !speaks(value)) return true;
  for (const char* way : same->keys) {
    const ParamField& other = detail::field(way);
    Origin& origin = origins_.at(way);
    if (way == field.key || origin.source == ParamSource::Default || !speaks(other.get(other, values_))) continue;
    if (origin.source == source) {
      if (!same->exclude) continue;
      throw UsageError({fmt::format("{} and {} are mutually exclusive: give one of ", std::min(field.key, other.key),
                                    std::max(field.key, other.key)),
                        Option{same->keys[0]}, ", ", Option{same->keys[1]}, " and ", Option{same->keys[2]}});
    }
    if (origin.source > source) return false;
    drop(way);
  }
  return true;
}

void Parameters::assign(const ParamField& field, const ParamValue& value, ParamSource source,
                        const std::string& origin) {
  check(field, value);
  Origin& former = origins_.at(field.key);
  if (source < former.source) return;
  if (!silences_others(field, value, source)) return;
  field.put(field, value, values_);
  former = {source, origin};
}

void Parameters::make_cloud_absolute() {
  std::string& path = values_.cloud.file;
  if (!path.empty()) path = std::filesystem::absolute(path).lexically_normal().string();
}

void Parameters::drop(const std::string& key) {
  const ParamField& f = detail::field(key);
  f.put(f, f.preset, values_);
  origins_.at(key) = {};
}

void Parameters::take(const std::string& key, const Parameters& other) {
  const ParamField& f = detail::field(key);
  f.put(f, f.get(f, other.values_), values_);
  origins_.at(key) = other.origins_.at(key);
}

void Parameters::take_body(const Parameters& other) {
  for (const char* key : {keys::cloud::file, keys::mesh::implicit, keys::mesh::level_set, keys::mesh::level,
                          keys::mesh::above, keys::mesh::part}) {
    if (source(key) <= ParamSource::Case) take(key, other);
  }
  if (!values_.mesh.implicit.empty() && source(keys::mesh::box) <= ParamSource::Case) take(keys::mesh::box, other);
}

void Parameters::copy_section(std::string_view name, const Parameters& other) {
  for (const ParamField& f : params_fields()) {
    if (f.key.substr(0, f.key.find('.')) == name) take(f.key, other);
  }
}

std::vector<KeptParameter> Parameters::kept() const {
  constexpr std::array<std::string_view, 3> kInput = {keys::cloud::file, keys::mesh::implicit, keys::mesh::level_set};
  std::vector<KeptParameter> list;
  for (const ParamField& f : params_fields()) {
    const ParamValue value = f.get(f, values_);
    const bool is_input = std::find(kInput.begin(), kInput.end(), f.key) != kInput.end();
    if (is_input || source(f.key) != ParamSource::Case || value == f.preset) continue;
    const bool is_switch = std::holds_alternative<bool>(value);
    if (!f.flag.empty() && value == ParamValue(true)) {
      list.push_back({f.key, f.flag});
    } else if (f.flag.empty() || is_switch) {
      list.push_back({f.key, "--set " + f.key + "=" + typed(value)});
    } else {
      list.push_back({f.key, f.flag + " " + typed(value)});
    }
  }
  return list;
}

nlohmann::ordered_json Parameters::section(std::string_view name) const {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  for (const ParamField& f : params_fields()) {
    const std::size_t dot = f.key.find('.');
    // A cloud is identified by its bytes, which the record lists among its inputs, so its path may change.
    if (f.key.substr(0, dot) != name || f.key == keys::cloud::file) continue;
    std::visit([&](const auto& v) { json[f.key.substr(dot + 1)] = v; }, f.get(f, values_));
  }
  return json;
}

std::optional<Eigen::AlignedBox3d> parse_box(const std::string& text) {
  if (text.empty()) return std::nullopt;
  std::array<double, 6> v{};
  const char* at = text.data();
  const char* end = at + text.size();
  for (std::size_t k = 0; k < 6; ++k) {
    while (at != end && *at == ' ') ++at;
    const auto [stop, error] = std::from_chars(at, end, v[k]);
    at = stop;
    while (at != end && *at == ' ') ++at;
    const bool separated = k == 5 ? at == end : at != end && *at == ',';
    if (error != std::errc() || !separated || !std::isfinite(v[k])) {
      throw UsageError("mesh.box = " + text + ": must be six numbers x0,y0,z0,x1,y1,z1");
    }
    if (k < 5) ++at;
  }
  const Eigen::AlignedBox3d box(Eigen::Vector3d(v[0], v[1], v[2]), Eigen::Vector3d(v[3], v[4], v[5]));
  if (!(box.sizes().array() > 0).all())
    throw UsageError("mesh.box = " + text + ": empty; the first corner must be the lower one");
  if (!std::isfinite(box.volume())) throw UsageError("mesh.box = " + text + ": too large: its volume is not finite");
  return box;
}

}  // namespace umtet
