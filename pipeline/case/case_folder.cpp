#include "pipeline/case/case_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <system_error>

#include "pipeline/case/artefact.h"
#include "pipeline/case/exit_code.h"
#include "pipeline/case/parameters.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

constexpr const char* kLockName = ".lock";

}  // namespace

const char* to_string(Stage stage) {
  switch (stage) {
    case Stage::Cloud:
      return "cloud";
    case Stage::LevelSet:
      return "level-set";
    case Stage::Mesh:
      return "mesh";
  }
  throw std::invalid_argument("not a stage");
}

Stage parse_stage(const std::string& name) {
  std::vector<std::string> names;
  for (const Stage stage : kStages) {
    if (name == to_string(stage)) return stage;
    names.push_back(to_string(stage));
  }
  const std::string near = nearest(name, names);
  throw UsageError("unknown stage " + name +
                   (near.empty() ? "; the stages are cloud, level-set, mesh" : "; did you mean " + near + "?"));
}

void remove_view(const CasePaths& paths) {
  for (const char* name : kViewFiles) fs::remove(paths.view() / name);
  fs::remove(paths.view() / "zero.vtp");  // version 0.9 wrote it
  std::error_code not_empty;
  fs::remove(paths.view(), not_empty);
}

const char* section_of(Stage stage) { return stage == Stage::LevelSet ? "reconstruct" : to_string(stage); }

bool is_artefact(Stage stage, const std::string& name) {
  if (stage == Stage::Cloud) return name == "cloud.ply" || name == "triangles.ply" || name == "marked.vtp";
  if (stage == Stage::LevelSet) return name == "level_set.vti" || name == "features.vtp" || name == "patches.vtp";
  for (const char* mesh : {"omega_h.vtu", "projected.vtu", "mesh.vtu", "quality.csv", "features.vtp", "too_thin.vtp",
                           "defects.vtp", "iterates.pvd"}) {
    if (name == mesh) return true;
  }
  constexpr std::string_view kPass = "pass_", kSuffix = ".vtu";
  if (name.size() <= kPass.size() + kSuffix.size() || !name.starts_with(kPass) || !name.ends_with(kSuffix))
    return false;
  return std::all_of(name.begin() + kPass.size(), name.end() - kSuffix.size(),
                     [](char c) { return c >= '0' && c <= '9'; });
}

fs::path CasePaths::folder(Stage stage) const {
  return (renews(stage) ? next() : root) / (std::to_string(static_cast<int>(stage)) + "-" + to_string(stage));
}

CaseLock::CaseLock(const fs::path& root) : root_(root), created_(fs::create_directories(root)) {
  const fs::path file = root / kLockName;
  fd_ = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (fd_ < 0) throw std::system_error(errno, std::generic_category(), file.string() + ": cannot open");
  if (::flock(fd_, LOCK_EX | LOCK_NB) != 0) {
    const int code = errno;
    const std::string pid = read_text(file);
    ::close(fd_);
    if (code != EWOULDBLOCK) throw std::system_error(code, std::generic_category(), file.string() + ": cannot lock");
    throw FileTrouble(root.string() + ": another umtet" + (pid.empty() ? "" : ", process " + pid + ",") +
                      " is working on this case; wait until it ends, or choose another folder with -o");
  }
  // The kernel releases the lock when the process ends, so a pid left by a killed run has no meaning.
  const std::string pid = std::to_string(::getpid());
  if (::ftruncate(fd_, 0) != 0 || ::pwrite(fd_, pid.data(), pid.size(), 0) != static_cast<ssize_t>(pid.size())) {
    const int code = errno;
    ::close(fd_);
    throw std::system_error(code, std::generic_category(), file.string() + ": cannot write");
  }
}

CaseLock::~CaseLock() {
  std::error_code ignored;
  if (created_ && std::distance(fs::directory_iterator(root_, ignored), {}) == 1) {
    fs::remove(root_ / kLockName, ignored);
    fs::remove(root_, ignored);
  } else if (::ftruncate(fd_, 0) != 0) {
    // If the pid in the lock file cannot be read, only a message suffers.
  }
  ::close(fd_);
}

}  // namespace umtet
