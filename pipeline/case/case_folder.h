#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <string>

#include "pipeline/case/artefact.h"

namespace umtet {

/// The stages in order; the values are the numbers of their folders.
enum class Stage { Cloud = 1, LevelSet = 2, Mesh = 3 };
inline constexpr std::array kStages = {Stage::Cloud, Stage::LevelSet, Stage::Mesh};
/// Returns "cloud", "level-set" or "mesh".
const char* to_string(Stage);
/// \throw UsageError  names the nearest stage
Stage parse_stage(const std::string& name);
/// Returns the section of the parameters that a stage reads: "cloud", "reconstruct" or "mesh".
const char* section_of(Stage);

/// Returns whether a stage writes a file with this name. The record does not count.
bool is_artefact(Stage, const std::string& name);

/// The folder of one case: the paths of its files, and what is known of their contents.
struct CasePaths {
  std::filesystem::path root;
  /// For each stage, whether its folder is in next(), where the stage is made again beside its former result.
  std::array<bool, kStages.size()> renewed = {};
  /// Stamps of the files in the case and of its sources; copies of this object share them.
  std::shared_ptr<FileStamps> stamps = std::make_shared<FileStamps>();

  bool& renews(Stage stage) { return renewed[static_cast<std::size_t>(stage) - 1]; }
  bool renews(Stage stage) const { return renewed[static_cast<std::size_t>(stage) - 1]; }
  std::filesystem::path next() const { return root / ".next"; }
  std::filesystem::path folder(Stage) const;  ///< 1-cloud, 2-level-set, 3-mesh
  std::filesystem::path record(Stage stage) const { return folder(stage) / "record.json"; }
  std::filesystem::path cloud() const { return folder(Stage::Cloud) / "cloud.ply"; }
  /// The triangles that bound the body; the file exists only if triangles were given.
  std::filesystem::path triangles() const { return folder(Stage::Cloud) / "triangles.ply"; }
  std::filesystem::path level_set() const { return folder(Stage::LevelSet) / "level_set.vti"; }
  std::filesystem::path mesh() const { return folder(Stage::Mesh) / "mesh.vtu"; }
  /// The remains of a mesh that could not be made, for inspection; never in next().
  std::filesystem::path failed() const { return root / "3-mesh" / "failed"; }
  std::filesystem::path exports() const { return root / "4-export"; }
  std::filesystem::path view() const { return root / "5-view"; }
  std::filesystem::path parameters() const { return root / "case.toml"; }
  std::filesystem::path certificate() const { return root / "certificate.json"; }
  std::filesystem::path report() const { return root / "report.html"; }
};

/// Names of the files in CasePaths::view(), which show one mesh.
inline constexpr std::array kViewFiles = {"psi.vti", "view.py"};
/// Removes these files, and the folder if it is empty afterwards.
void remove_view(const CasePaths& paths);

/// Locks a case for writing while the object lives. Creates the folder if it does not exist, and removes a folder
/// that it created if it is still empty at the end.
class CaseLock {
 public:
  /// \throw FileTrouble  another process holds the lock (names its pid); std::system_error  the folder cannot be
  ///   created
  explicit CaseLock(const std::filesystem::path& root);
  ~CaseLock();
  CaseLock(const CaseLock&) = delete;
  CaseLock& operator=(const CaseLock&) = delete;

 private:
  std::filesystem::path root_;
  bool created_;
  int fd_ = -1;
};

}  // namespace umtet
