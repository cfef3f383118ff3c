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

// What a text with a fixed vocabulary may say; the values stand in the order of its words in parameters.def.
enum class NormalsOf { Auto, Given, Estimate };
enum class WindingCheck { Auto, Off };
enum class SampleWeights { Area, Paper };
enum class MaxEntPrior { CompactC2, Gaussian };
enum class FitSolver { Auto, Multilevel, Full, Assembled };
enum class HoleClosing { Auto, Smooth, Flat, None };
enum class TouchingPieces { Apart, Fuse };
enum class MeshingMode { Fast, Paper };
enum class RelaxationDirections { Random, Axes };
enum class Projection { Newton, Damped, Paper };
enum class MaxMinSearch { Exact, Golden };

// The fields, their meaning, units, ranges and defaults are those of parameters.def.

/// The section [cloud]: how a scan is prepared.
struct CloudParameters {
#define UMTET_CLOUD(type, name, ...) type name{};
#include "pipeline/case/parameters.def"
};

/// The section [reconstruct]: how psi is fitted.
struct ReconstructParameters {
#define UMTET_RECONSTRUCT(type, name, ...) type name{};
#include "pipeline/case/parameters.def"
};

/// The section [mesh]: what is meshed, how fine and how.
struct MeshParameters {
#define UMTET_MESH(type, name, ...) type name{};
#include "pipeline/case/parameters.def"
};

/// The section [output]: limits, gates, names.
struct OutputParameters {
#define UMTET_OUTPUT(type, name, ...) type name{};
#include "pipeline/case/parameters.def"
};

/// All of them, at first at their defaults.
struct ParameterValues {
  ParameterValues();
  CloudParameters cloud;
  ReconstructParameters reconstruct;
  MeshParameters mesh;
  OutputParameters output;
};

/// The names of parameters in files and behind --set: keys::mesh::h is "mesh.h".
namespace keys {
#define UMTET_PARAMETER(section, type, name, ...)    \
  namespace section {                                \
  inline constexpr char name[] = #section "." #name; \
  }
#include "pipeline/case/parameters.def"
}  // namespace keys

/// True where a formula or a grid is psi: there is no cloud, and nothing to be fitted to one.
inline bool has_own_psi(const MeshParameters& mesh) { return !mesh.implicit.empty() || !mesh.level_set.empty(); }

/// One parameter as configuration files, the command line, records and the help need it. The fields that a line of
/// parameters.def names come first.
struct ParamField {
  std::string flag{};                  ///< "--h", or empty: only --set and --config reach it
  double min = 0, max = 0;             ///< for numbers
  std::vector<std::string> choices{};  ///< for texts with a fixed vocabulary
  std::string help{};
  std::string key{};    ///< "mesh.h": section and name of the TOML file
  ParamValue preset{};  ///< the default; its type is the type of the parameter
  ParamValue (*get)(const ParamField&, const ParameterValues&) = nullptr;
  void (*put)(const ParamField&, const ParamValue&, ParameterValues&) = nullptr;  ///< of a value that has been checked
};

/// All parameters, in the order of case.toml.
const std::vector<ParamField>& params_fields();

/// The default as it is printed; empty for an empty text.
std::string preset_text(const ParamField&);

/// The candidate with the least edit distance to `word`; empty if none is near enough to be what was meant.
std::string nearest(std::string_view word, const std::vector<std::string>& candidates);

/// Where a value came from, in rising precedence. Derived: computed from other parameters, and computed anew by the
/// next call; its origin begins with "for ".
enum class ParamSource { Default, Derived, Case, File, Set, Flag };

/// A parameter that a case has from former calls.
struct KeptParameter {
  std::string key;
  std::string words;  ///< of a call that gives it: "--h 0.02", "--keep-all", "--set mesh.samples=7"
};

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

  /// Makes the path cloud.file absolute, whoever gave it.
  void make_cloud_absolute();

  /// Makes it the default again, whoever gave it.
  void drop(const std::string& key);
  /// Takes from other parameters what says which body the case is of: the cloud, the formula or the grid, with its
  /// level and part, and the box of a formula. All else stays.
  void take_body(const Parameters& other);
  /// Takes the whole section from other parameters, sources included.
  void copy_section(std::string_view name, const Parameters& other);

  const CloudParameters& cloud() const { return values_.cloud; }
  const ReconstructParameters& reconstruct() const { return values_.reconstruct; }
  const MeshParameters& mesh() const { return values_.mesh; }
  const OutputParameters& output() const { return values_.output; }

  /// \throw std::out_of_range for a key that the table does not have: a bug of the caller
  ParamSource source(const std::string& key) const { return origins_.at(key).source; }

  /// What is not the default and comes from the case, not from this call. The input of the case is not among it.
  std::vector<KeptParameter> kept() const;

  /// Every value with a comment that says where it came from, behind their checksum; load() takes it back.
  std::string toml() const;
  /// The values of one section, for the record of its stage.
  nlohmann::ordered_json section(std::string_view name) const;

 private:
  struct Origin {
    ParamSource source = ParamSource::Default;
    std::string text = "default";
  };
  bool silences_others(const ParamField& field, const ParamValue& value, ParamSource source);
  void take(const std::string& key, const Parameters& other);
  void assign(const ParamField& field, const ParamValue& value, ParamSource source, const std::string& origin);

  ParameterValues values_;
  std::map<std::string, Origin> origins_;  ///< by key
};

/// "x0,y0,z0,x1,y1,z1" of mesh.box; nullopt when it is empty. \throw UsageError
std::optional<Eigen::AlignedBox3d> parse_box(const std::string& text);

}  // namespace umtet
