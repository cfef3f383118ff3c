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

#include "body/options.h"
#include "reconstruct/triangles/touching_pieces.h"

namespace umtet {

using ParamValue = std::variant<bool, std::int64_t, double, std::string>;

// The sections of the parameters. Each consists of options of the library, and of options that only the program has:
// names of files, and formulas as text. parameters.def lists all fields with their ranges.

/// The section [cloud]: the scan and its preparation.
struct CloudParameters : ScanOptions {
  std::string file;                     ///< the point cloud or triangle mesh
  std::string columns;                  ///< columns of a table in text
  std::string orient_from;              ///< file of viewpoints; empty: none
  std::string features;                 ///< file of edges that the mesh shall have; empty: none
  double sample_spacing = 0;            ///< largest spacing of the samples of triangles, model units; 0: chosen
  bool as_points = false;               ///< read a PLY with faces as the cloud of its vertices
  Touching touching = Touching::Apart;  ///< treatment of components that meet along an edge or at a corner
  bool cap = true;                      ///< close openings of triangles that have a plane rim by that plane
};

/// The section [reconstruct]: the fit of psi.
struct ReconstructParameters : FitOptions {
  bool keep_open = false;  ///< equivalent to Closing::None
};

/// The section [mesh]: the body, the resolution and the method of meshing.
struct MeshParameters : MeshOptions {
  std::string implicit;     ///< formula of psi; empty: none
  std::string level_set;    ///< file of a grid; empty: none
  std::string level;        ///< values inside the body of an image, for parse_level()
  bool above = false;       ///< the body consists of the values above `level`
  std::int64_t part = 0;    ///< number of the body in a segmentation; 0: all voxels other than 0
  double part_smooth = -1;  ///< standard deviation of a kernel, voxels; -1: no kernel
  std::string box;          ///< box for parse_box(); empty: around the level set
  std::string size;         ///< edge lengths: a formula or a file; empty: none
  std::string size_at;      ///< edge lengths by label, for parse_label_sizes()
};

/// The section [output]: limits, gates, names.
struct OutputParameters : VerdictOptions {
  std::string units;           ///< name of the model unit; nothing is converted
  double max_memory = 0;       ///< maximum memory of a stage, GB; 0: what the machine can provide
  std::string label_names;     ///< names of labels, for parse_label_names()
  double label_min_area = -1;  ///< smaller islands of a label are removed, model units^2; -1: the area of three samples
  double patch_angle = 0;      ///< angle between faces at which patches end, degrees; 0: where the surface ends
  double patch_planar = 0;     ///< angle within which a patch is flat, degrees; 0: off
};

/// The values of all parameters, initially the defaults.
struct ParameterValues {
  CloudParameters cloud;
  ReconstructParameters reconstruct;
  MeshParameters mesh;
  OutputParameters output;
};

/// The names of parameters in files and after --set: keys::mesh::h is "mesh.h".
namespace keys {
#define UMTET_PARAMETER(section, name, ...)          \
  namespace section {                                \
  inline constexpr char name[] = #section "." #name; \
  }
#include "pipeline/case/parameters.def"
}  // namespace keys

/// Returns whether psi is a formula or a grid: then there is no cloud and no fit.
inline bool has_own_psi(const MeshParameters& mesh) { return !mesh.implicit.empty() || !mesh.level_set.empty(); }

/// One parameter, as configuration files, the command line, records and the help need it. The fields that
/// parameters.def sets come first.
struct ParamField {
  std::string flag{};                  ///< "--h"; empty: only --set and --config set it
  double min = 0, max = 0;             ///< range of a number
  std::vector<std::string> choices{};  ///< choices of a text with a fixed vocabulary
  std::string help{};
  std::string key{};    ///< "mesh.h": section and name of the TOML file
  ParamValue preset{};  ///< the default; its type is the type of the parameter
  ParamValue (*get)(const ParamField&, const ParameterValues&) = nullptr;
  void (*put)(const ParamField&, const ParamValue&, ParameterValues&) = nullptr;  ///< the value has been checked
};

/// Returns all parameters in the order of case.toml.
const std::vector<ParamField>& params_fields();

/// Returns the default in printed form; empty for an empty text.
std::string preset_text(const ParamField&);

/// Returns the candidate with the smallest edit distance to `word`; empty if no candidate is similar enough.
std::string nearest(std::string_view word, const std::vector<std::string>& candidates);

/// The source of a value, in ascending precedence. Derived: computed from other parameters, and recomputed by the
/// next call; its origin begins with "for ".
enum class ParamSource { Default, Derived, Case, File, Set, Flag };

/// A parameter that a case keeps from former calls.
struct KeptParameter {
  std::string key;
  std::string words;  ///< arguments that set it: "--h 0.02", "--keep-all", "--set mesh.samples=7"
};

/// The values of all parameters and their sources.
class Parameters {
 public:
  Parameters();

  /// Sets the value unless a source of higher precedence has set the parameter.
  /// @param origin  written to case.toml, e.g. "--h"
  /// \throw UsageError  unknown key (names the nearest), or a value of another type or out of range
  void set(const std::string& key, const std::string& text, ParamSource source, const std::string& origin);
  /// Sets a parameter from "key=value", the argument of --set.
  void set(const std::string& assignment);
  /// Reads a TOML file: a file of the user, or the case.toml of an earlier run, which must be exactly as toml()
  /// wrote it.
  /// \throw UsageError  with file, line and column; std::system_error; ArtefactDamaged  for a case.toml
  void load(const std::filesystem::path& file, ParamSource source);

  /// Makes the path cloud.file absolute, whatever its source.
  void make_cloud_absolute();

  /// Resets the parameter to its default, whatever its source.
  void drop(const std::string& key);
  /// Copies the parameters that define the body of the case: the cloud, the formula or the grid, with its level
  /// and part, and the box of a formula. All others stay.
  void take_body(const Parameters& other);
  /// Copies a whole section from other parameters, including sources.
  void copy_section(std::string_view name, const Parameters& other);

  const CloudParameters& cloud() const { return values_.cloud; }
  const ReconstructParameters& reconstruct() const { return values_.reconstruct; }
  const MeshParameters& mesh() const { return values_.mesh; }
  const OutputParameters& output() const { return values_.output; }

  /// \throw std::out_of_range  the table does not contain the key: a bug of the caller
  ParamSource source(const std::string& key) const { return origins_.at(key).source; }
  /// The origin that was given to set().
  const std::string& origin(const std::string& key) const { return origins_.at(key).text; }

  /// Returns the parameters that differ from their defaults and come from the case, not from this call. The input
  /// of the case is not included.
  std::vector<KeptParameter> kept() const;

  /// Returns all values, each with a comment that names its source, after a checksum; load() reads this text.
  std::string toml() const;
  /// Returns the values of one section, for the record of its stage.
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
  std::map<std::string, Origin> origins_;  ///< origins of the values by key
};

/// Parses mesh.box, "x0,y0,z0,x1,y1,z1"; returns nullopt if it is empty. \throw UsageError
std::optional<Eigen::AlignedBox3d> parse_box(const std::string& text);

}  // namespace umtet
