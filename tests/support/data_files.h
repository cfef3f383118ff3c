#pragma once

// Where clouds lie: those of the repository, and larger ones that may be on the machine.

#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>

namespace umtet::test {

/// A cloud that is committed under data/clouds.
inline std::filesystem::path committed_cloud(const std::string& name) {
  return std::filesystem::path(UMTET_SOURCE_DIR) / "data" / "clouds" / name;
}

/// A cloud of the folder of real scans that developers have beside the checkout (UMTET_SHARED); tests skip without it.
inline std::optional<std::filesystem::path> real_cloud(const std::string& name) {
  const char* folder = std::getenv("UMTET_SHARED");
  const std::filesystem::path file =
      (folder ? std::filesystem::path(folder) : std::filesystem::path(UMTET_SOURCE_DIR) / ".." / "shared") / "data" /
      name;
  std::error_code ignored;
  if (!std::filesystem::exists(file, ignored)) return std::nullopt;
  return file;
}

/// The paper's own duck where it is present, ours otherwise.
inline std::filesystem::path duck_cloud() { return real_cloud("duck.ply").value_or(committed_cloud("duck.ply")); }

}  // namespace umtet::test
