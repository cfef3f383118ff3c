#include "distributed/io/shared_file.h"

#include <algorithm>
#include <cerrno>
#include <system_error>
#include <utility>

namespace umtet {
namespace {

// Maximum number of bytes per call, because MPI counts in int.
constexpr std::size_t kMostAtOnce = std::size_t{1} << 30;

int errno_of(int error) {
  int kind = MPI_ERR_OTHER;
  MPI_Error_class(error, &kind);
  switch (kind) {
    case MPI_ERR_NO_SPACE:
      return ENOSPC;
    case MPI_ERR_QUOTA:
      return EDQUOT;
    case MPI_ERR_ACCESS:
      return EACCES;
    case MPI_ERR_READ_ONLY:
      return EROFS;
    case MPI_ERR_NO_SUCH_FILE:
      return ENOENT;
    default:
      return EIO;
  }
}

}  // namespace

SharedFile::SharedFile(MPI_Comm comm, std::filesystem::path file) : comm_(comm), path_(std::move(file)) {
  note(MPI_File_open(comm_, path_.c_str(), MPI_MODE_CREATE | MPI_MODE_WRONLY, MPI_INFO_NULL, &file_));
}

SharedFile::~SharedFile() {
  if (file_ != MPI_FILE_NULL && !unwinding_) MPI_File_close(&file_);
}

void SharedFile::note(int error) {
  if (error != MPI_SUCCESS && error_ == 0) error_ = errno_of(error);
}

void SharedFile::write(std::uint64_t at, std::string_view text) {
  while (error_ == 0 && !text.empty()) {
    const std::string_view some = text.substr(0, kMostAtOnce);
    MPI_Status status;
    int n = 0;
    note(MPI_File_write_at(file_, static_cast<MPI_Offset>(at), some.data(), static_cast<int>(some.size()), MPI_BYTE,
                           &status));
    if (error_ != 0) return;
    MPI_Get_count(&status, MPI_BYTE, &n);
    // Not all implementations report a short write as an error.
    if (n != static_cast<int>(some.size())) error_ = ENOSPC;
    at += some.size();
    text.remove_prefix(some.size());
  }
}

void SharedFile::close(std::uint64_t size) {
  int first = error_;
  MPI_Allreduce(MPI_IN_PLACE, &first, 1, MPI_INT, MPI_MAX, comm_);
  if (file_ != MPI_FILE_NULL) {
    if (first == 0) note(MPI_File_set_size(file_, static_cast<MPI_Offset>(size)));
    if (first == 0) note(MPI_File_sync(file_));
    note(MPI_File_close(&file_));
    MPI_Allreduce(&error_, &first, 1, MPI_INT, MPI_MAX, comm_);
  }
  if (first != 0) throw KnownToAll(first, std::generic_category(), "cannot write " + path_.string());
}

}  // namespace umtet
