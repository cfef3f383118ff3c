#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <string>

#include "pipeline/case/artefact.h"

namespace umtet {

/// The stages in their order; the values are the numbers of their folders.
enum class Stage { Cloud = 1, LevelSet = 2, Mesh = 3 };
inline constexpr std::array kStages = {Stage::Cloud, Stage::LevelSet, Stage::Mesh};
/// "cloud", "level-set", "mesh".
const char* to_string(Stage);
/// \throw UsageError that names the nearest stage
Stage parse_stage(const std::string& name);
/// The section of the parameters that a stage reads: "cloud", "reconstruct", "mesh".
const char* section_of(Stage);

/// True for the names of the files that a stage writes, its record apart.
bool is_artefact(Stage, const std::string& name);

/// The folder of one case: where things are, and what is known of their bytes.
struct CasePaths {
  std::filesystem::path root;
  /// By stage: its folder is the one in next(), where it is made anew beside its finished former self.
  std::array<bool, kStages.size()> renewed = {};
  /// Of the files in it and of those it is made from; copies share them.
  std::shared_ptr<FileStamps> stamps = std::make_shared<FileStamps>();

  bool& renews(Stage stage) { return renewed[static_cast<std::size_t>(stage) - 1]; }
  bool renews(Stage stage) const { return renewed[static_cast<std::size_t>(stage) - 1]; }
  std::filesystem::path next() const { return root / ".next"; }
  std::filesystem::path folder(Stage) const;  ///< 1-cloud, 2-level-set, 3-mesh
  std::filesystem::path record(Stage stage) const { return folder(stage) / "record.json"; }
  std::filesystem::path cloud() const { return folder(Stage::Cloud) / "cloud.ply"; }
  /// What bounds the body where triangles were given; else it is not there.
  std::filesystem::path triangles() const { return folder(Stage::Cloud) / "triangles.ply"; }
  std::filesystem::path level_set() const { return folder(Stage::LevelSet) / "level_set.vti"; }
  std::filesystem::path mesh() const { return folder(Stage::Mesh) / "mesh.vtu"; }
  /// What is left of a mesh that could not be made; never in next(), for it is there to be looked at.
  std::filesystem::path failed() const { return root / "3-mesh" / "failed"; }
  std::filesystem::path exports() const { return root / "4-export"; }
  std::filesystem::path view() const { return root / "5-view"; }
  std::filesystem::path parameters() const { return root / "case.toml"; }
  std::filesystem::path certificate() const { return root / "certificate.json"; }
  std::filesystem::path report() const { return root / "report.html"; }
};

/// What is in CasePaths::view(), of one mesh.
inline constexpr std::array kViewFiles = {"psi.vti", "zero.vtp", "view.py"};
/// Removes these files, and the folder if nothing else is in it.
void remove_view(const CasePaths& paths);

/// The right to write to a case, for as long as the object lives. Creates the folder if there is none, and removes it
/// again if nothing else was put into it.
class CaseLock {
 public:
  /// \throw FileTrouble when another process holds the case (names its pid); std::system_error when the folder cannot
  ///        be made
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
