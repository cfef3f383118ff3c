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

// The sections of the parameters: options of the library with what only a program has, names of files and formulas in
// text. parameters.def lists all fields with their ranges.

/// The section [cloud]: which scan, and how it is prepared.
struct CloudParameters : ScanOptions {
  std::string file;                     ///< the point cloud or triangle mesh
  std::string columns;                  ///< of a table in text
  std::string orient_from;              ///< file of viewpoints; empty: none
  double sample_spacing = 0;            ///< largest of the samples of triangles, model units; 0: chosen
  bool as_points = false;               ///< a PLY with faces is the cloud of its vertices
  Touching touching = Touching::Apart;  ///< what becomes of pieces of triangles that meet along an edge or at a corner
  bool cap = true;                      ///< closes openings of triangles with a plane rim by that plane
};

/// The section [reconstruct]: how psi is fitted.
struct ReconstructParameters : FitOptions {
  bool keep_open = false;  ///< the same as Closing::None
};

/// The section [mesh]: what is meshed, how fine and how.
struct MeshParameters : MeshOptions {
  std::string implicit;     ///< formula of psi; empty: none
  std::string level_set;    ///< file of a grid; empty: none
  std::string level;        ///< the body of an image, as parse_level() reads it
  bool above = false;       ///< the body is above `level`
  std::int64_t part = 0;    ///< number of the body in a segmentation; 0: all that is not 0
  double part_smooth = -1;  ///< standard deviation of a kernel, voxels; -1: no kernel
  std::string box;          ///< as parse_box() reads it; empty: around the level set
  std::string size;         ///< edge lengths: a formula or a file; empty: none
  std::string size_at;      ///< edge lengths by label, as parse_label_sizes() reads them
};

/// The section [output]: limits, gates, names.
struct OutputParameters : VerdictOptions {
  std::string units;           ///< name of the model unit, a label
  double max_memory = 0;       ///< GB that a stage may take; 0: what the machine can give
  std::string label_names;     ///< as parse_label_names() reads them
  double label_min_area = -1;  ///< smaller islands of a label go, model units^2; -1: what three samples stand for
  double patch_angle = 0;      ///< degrees at which patches end; 0: where the surface ends
  double patch_planar = 0;     ///< degrees within which a patch is flat; 0: off
};

/// All of them, at first at their defaults.
struct ParameterValues {
  CloudParameters cloud;
  ReconstructParameters reconstruct;
  MeshParameters mesh;
  OutputParameters output;
};

/// The names of parameters in files and behind --set: keys::mesh::h is "mesh.h".
namespace keys {
#define UMTET_PARAMETER(section, name, ...)          \
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
