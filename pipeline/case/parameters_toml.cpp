// Parameters as text, in case.toml and in files for --config.

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <sstream>

#include "pipeline/case/artefact.h"
#include "pipeline/case/detail/param_field.h"
#include "pipeline/case/exit_code.h"
#include "pipeline/case/parameters.h"

namespace umtet {
namespace {

/// Returns a name for use in a comment, where a control character would end the comment.
std::string one_line(std::string s) {
  for (char& c : s) {
    if (static_cast<unsigned char>(c) < 32 || c == 127) c = '?';
  }
  return s;
}

// If a line of case.toml were lost, its parameter would silently have its default again. The checksum prevents this.
// Files of former versions begin with the same text, so it must not change.
const std::string kTomlHead =
    "# Effective parameters of this case. Feed it back with --config.\n# Checksum of what follows: ";

// The beginning of the origin of a derived value: "for --h".
constexpr std::string_view kDerivedFrom = "for ";

bool is_as_written(std::string_view text) {
  if (!text.starts_with(kTomlHead)) return false;
  text.remove_prefix(kTomlHead.size());
  const std::size_t line = std::min(text.find('\n'), text.size());
  return line < text.size() && text.substr(0, line) == checksum(text.substr(line + 1));
}

/// Returns the origin of a value from a line of case.toml, "key = value  # origin: help"; empty if the line does
/// not have this form.
std::string origin_in(std::string_view text, std::size_t line, std::string_view key, const ParamValue& value) {
  for (; line > 1; --line) text.remove_prefix(std::min(text.find('\n'), text.size() - 1) + 1);
  text = text.substr(0, text.find('\n'));
  const std::string head = fmt::format("{} = {}  # ", key, detail::print(value));
  if (!text.starts_with(head)) return "";
  text.remove_prefix(head.size());
  const std::size_t end = text.find(": ");
  return end == std::string_view::npos ? "" : std::string(text.substr(0, end));
}

/// Returns whether the key is a parameter of 0.9.0 that no longer exists: it is ignored in files.
bool is_former(const std::string& key) { return key == "mesh.allow_thin"; }

/// Returns the shortest decimal that reads back as the same double, always in the form of a TOML float.
std::string decimal(double v) {
  std::string s = fmt::format("{}", v);
  if (s.find_first_of(".e") == std::string::npos) s += ".0";
  return s;
}

}  // namespace

std::string detail::print(const ParamValue& value) {
  std::ostringstream s;
  if (const auto* b = std::get_if<bool>(&value)) s << (*b ? "true" : "false");
  if (const auto* i = std::get_if<std::int64_t>(&value)) s << *i;
  if (const auto* d = std::get_if<double>(&value)) s << decimal(*d);
  if (const auto* t = std::get_if<std::string>(&value)) s << toml::value<std::string>(*t);
  return s.str();
}

void Parameters::load(const std::filesystem::path& file, ParamSource source) {
  if (is_too_large_a_text(file)) {
    if (source == ParamSource::Case) throw ArtefactDamaged(file.string() + ": too large for parameters");
    throw UsageError(file.string() + ": too large for a parameter file");
  }
  const std::string text = read_text(file);
  if (source == ParamSource::Case && !is_as_written(text)) {
    throw ArtefactDamaged(file.string() +
                          ": truncated, damaged or edited: `umtet run CLOUD -o CASE` with its flags makes "
                          "it again; --config reads an edited file");
  }
  toml::table root;
  try {
    root = toml::parse(text, file.string());
  } catch (const toml::parse_error& e) {
    throw UsageError(
        fmt::format("{}:{}:{}: {}", file.string(), e.source().begin.line, e.source().begin.column, e.description()));
  }
  const std::string origin = "file " + one_line(file.filename().string());
  const auto at = [&](const toml::node& node) {
    return fmt::format("{}:{}: ", file.string(), node.source().begin.line);
  };
  for (const auto& [section, node] : root) {
    const std::string name(section.str());
    if (!node.is_table()) throw UsageError(at(node) + name + ": expected a section such as [mesh]");
    for (const auto& [key, entry] : *node.as_table()) {
      try {
        if (is_former(name + "." + std::string(key.str()))) continue;
        const ParamField& f = detail::field(name + "." + std::string(key.str()));
        ParamValue value;
        if (f.preset.index() == 0 && entry.is_boolean()) {
          value = *entry.value<bool>();
        } else if (f.preset.index() == 1 && entry.is_integer()) {
          value = *entry.value<std::int64_t>();
        } else if (f.preset.index() == 2 && entry.is_number()) {
          value = *entry.value<double>();
        } else if (f.preset.index() == 3 && entry.is_string()) {
          value = *entry.value<std::string>();
        } else if (f.key == keys::mesh::level && entry.is_number()) {  // 0: no level, as in cases of 0.9
          const double level = *entry.value<double>();
          value = level == 0 ? std::string() : decimal(level);
        } else {
          constexpr const char* kTypes[] = {"true or false", "a whole number", "a number", "a text"};
          throw UsageError(f.key + ": must be " + kTypes[f.preset.index()]);
        }
        const std::string former =
            source == ParamSource::Case ? origin_in(text, entry.source().begin.line, key.str(), value) : "";
        const ParamSource of = former.starts_with(kDerivedFrom) ? ParamSource::Derived : source;
        assign(f, value, of, former.empty() ? origin : former);
      } catch (const UsageError& e) {
        throw UsageError(at(entry) + e.message);
      }
    }
  }
}

std::string Parameters::toml() const {
  std::string out, section;
  for (const ParamField& f : params_fields()) {
    const std::size_t dot = f.key.find('.');
    if (f.key.substr(0, dot) != section) {
      section = f.key.substr(0, dot);
      out += fmt::format("\n[{}]\n", section);
    }
    out += fmt::format("{} = {}  # {}: {}\n", f.key.substr(dot + 1), detail::print(f.get(f, values_)),
                       origins_.at(f.key).text, f.help);
  }
  return kTomlHead + checksum(out) + "\n" + out;
}

}  // namespace umtet
