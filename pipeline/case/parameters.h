#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace umtet {

using ParamValue = std::variant<bool, std::int64_t, double, std::string>;

/// One row of the table from which configuration files, the command line, records and the help come.
struct ParamField {
  std::string key;                   ///< "mesh.h": section and name of the TOML file
  std::string flag;                  ///< "--h", or empty: only --set and --config reach it
  ParamValue preset;                 ///< the default; its type is the type of the parameter
  double min, max;                   ///< for numbers
  std::vector<std::string> choices;  ///< for texts with a fixed vocabulary
  std::string help;
};

/// All parameters, in the order of case.toml.
const std::vector<ParamField>& params_fields();

/// The default as it is printed; empty for an empty text.
std::string preset_text(const ParamField&);

/// The candidate with the least edit distance to `word`; empty if none is near enough to be what was meant.
std::string nearest(std::string_view word, const std::vector<std::string>& candidates);

/// Where a value came from, in rising precedence.
enum class ParamSource { Default, Case, File, Set, Flag };

/// The value of every parameter and where it came from.
class Parameters {
 public:
  Parameters();

  /// Takes the value unless a source of higher precedence has spoken.
  /// @param origin  goes into case.toml, e.g. "--h"
  /// \throw UsageError  unknown key (names the nearest), or not a value of its type and range
  void set(const std::string& key, const std::string& text, ParamSource source, const std::string& origin);
  /// "key=value", as --set takes it.
  void set(const std::string& assignment);
  /// Reads a TOML file: the user's, or the case.toml of an earlier run, which must be as toml() made it.
  /// \throw UsageError with file, line and column; std::system_error; ArtefactDamaged, of a case.toml
  void load(const std::filesystem::path& file, ParamSource source);

  /// Makes the path absolute, whoever gave it.
  void make_absolute(const std::string& key);

  /// Takes the whole section from other parameters, sources included.
  void copy_section(std::string_view name, const Parameters& other);

  /// \throw std::out_of_range for a key or a type that the table does not have: a bug of the caller
  double real(const std::string& key) const { return std::get<double>(value(key)); }
  std::int64_t integer(const std::string& key) const { return std::get<std::int64_t>(value(key)); }
  bool flag(const std::string& key) const { return std::get<bool>(value(key)); }
  const std::string& text(const std::string& key) const { return std::get<std::string>(value(key)); }
  ParamSource source(const std::string& key) const;

  /// Every value with a comment that says where it came from, behind their checksum; load() takes it back.
  std::string toml() const;
  /// The values of one section, for the record of its stage.
  nlohmann::ordered_json section(std::string_view name) const;

 private:
  struct Entry {
    ParamValue value;
    ParamSource source = ParamSource::Default;
    std::string origin = "default";
  };
  const ParamValue& value(const std::string& key) const { return entries_.at(key).value; }
  bool silences_others(const std::string& key, const ParamValue& value, ParamSource source);
  void assign(const std::string& key, ParamValue value, ParamSource source, const std::string& origin);
  std::map<std::string, Entry> entries_;
};

/// "x0,y0,z0,x1,y1,z1" of mesh.box; nullopt when it is empty. \throw UsageError
std::optional<Eigen::AlignedBox3d> parse_box(const std::string& text);

}  // namespace umtet
