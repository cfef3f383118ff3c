#pragma once

#include <mpi.h>

#include <cstdint>
#include <filesystem>
#include <string_view>
#include <system_error>

#include "distributed/unwinding.h"

namespace umtet {

/// Trouble with a file that all ranks throw together.
struct KnownToAll : std::system_error {
  using std::system_error::system_error;
};

/// A file that all ranks write, each where it says. What goes wrong on one is known to all at the end.
class SharedFile {
 public:
  /// Collective.
  SharedFile(MPI_Comm comm, std::filesystem::path file);
  ~SharedFile();  ///< collective, unless something is thrown
  SharedFile(const SharedFile&) = delete;
  SharedFile& operator=(const SharedFile&) = delete;

  /// Not collective. Nothing is written any more once something went wrong.
  void write(std::uint64_t at, std::string_view text);
  /// Collective. The file is then this long. \throw KnownToAll naming the file
  void close(std::uint64_t size);

 private:
  void note(int error);

  MPI_Comm comm_;
  std::filesystem::path path_;
  MPI_File file_ = MPI_FILE_NULL;
  int error_ = 0;  ///< of errno
  const Unwinding unwinding_;
};

}  // namespace umtet
