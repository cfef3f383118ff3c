#pragma once

#include <unistd.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

namespace umtet::fuzz {

/// The one file of a fuzz target: readers take paths. Gone when the process ends in order; after a crash it holds the
/// input.
class InputFile {
 public:
  explicit InputFile(const std::string& extension) : path_(folder() / (std::to_string(::getpid()) + extension)) {}
  ~InputFile() {
    std::error_code ignored;
    std::filesystem::remove(path_, ignored);
  }
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  const std::filesystem::path& write(const std::uint8_t* data, std::size_t size) const {
    std::ofstream(path_, std::ios::binary)
        .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
    return path_;
  }

 private:
  /// In memory where the system has such a place.
  static std::filesystem::path folder() {
    const std::filesystem::path memory = "/dev/shm";
    return std::filesystem::exists(memory) ? memory : std::filesystem::temp_directory_path();
  }

  std::filesystem::path path_;
};

/// The law a target states. std::abort() is what libFuzzer and replay.cpp see.
inline void require(bool law) {
  if (!law) std::abort();
}

}  // namespace umtet::fuzz
