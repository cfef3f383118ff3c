#pragma once

#include <mpi.h>

#include <cstdint>
#include <filesystem>
#include <string_view>
#include <system_error>

#include "distributed/exchange/unwinding.h"

namespace umtet {

/// Error of a file that all ranks throw together.
struct KnownToAll : std::system_error {
  using std::system_error::system_error;
};

/// A file that all ranks write, each at its own positions. Errors of a rank are reported to all at the end.
class SharedFile {
 public:
  /// Collective.
  SharedFile(MPI_Comm comm, std::filesystem::path file);
  ~SharedFile();  ///< collective, unless an exception is propagating
  SharedFile(const SharedFile&) = delete;
  SharedFile& operator=(const SharedFile&) = delete;

  /// Writes text at a position. Not collective. Nothing is written after an error.
  void write(std::uint64_t at, std::string_view text);
  /// Closes the file with this length. Collective. \throw KnownToAll naming the file
  void close(std::uint64_t size);

 private:
  void note(int error);

  MPI_Comm comm_;
  std::filesystem::path path_;
  MPI_File file_ = MPI_FILE_NULL;
  int error_ = 0;  ///< errno of the first error; 0: none
  const Unwinding unwinding_;
};

}  // namespace umtet
