#include "distributed/io/shared_arrays.h"

#include <algorithm>
#include <utility>

namespace umtet {

SharedArrays::SharedArrays(MPI_Comm comm, SharedFile& file, std::vector<const VtuShape::Array*> arrays)
    : comm_(comm),
      file_(file),
      arrays_(std::move(arrays)),
      pieces_(arrays_.size()),
      before_(kTail * arrays_.size(), 0) {}

void SharedArrays::write() {
  int rank = 0, n_ranks = 1;
  MPI_Comm_rank(comm_, &rank);
  MPI_Comm_size(comm_, &n_ranks);
  std::vector<unsigned char> left(before_.size(), 0), before(before_.size());
  for (std::size_t a = 0; a < pieces_.size(); ++a) {
    // A piece that is shorter is the last one.
    const auto& bytes = pieces_[a].bytes;
    if (bytes.size() >= kTail) std::copy_n(bytes.end() - kTail, kTail, left.begin() + static_cast<int>(kTail * a));
  }
  MPI_Sendrecv(left.data(), static_cast<int>(left.size()), MPI_BYTE, (rank + 1) % n_ranks, 0, before.data(),
               static_cast<int>(before.size()), MPI_BYTE, (rank + n_ranks - 1) % n_ranks, 0, comm_, MPI_STATUS_IGNORE);
  if (rank == 0) before.swap(before_);
  for (std::size_t a = 0; a < pieces_.size(); ++a) write(*arrays_[a], pieces_[a], before.data() + kTail * a);
}

void SharedArrays::write(const VtuShape::Array& array, const Piece& piece, const unsigned char* before) {
  if (piece.bytes.empty()) return;
  std::vector<unsigned char> bytes;
  std::size_t first = 0;  // of what is encoded, the header before the values
  if (piece.first == 0) {
    const std::uint64_t n = array.n_bytes;
    bytes.resize(sizeof n);
    std::memcpy(bytes.data(), &n, sizeof n);
  } else {
    const std::size_t at = 8 + piece.first;
    first = at / 3 * 3;
    bytes.assign(before + kTail - (at - first), before + kTail);
  }
  bytes.insert(bytes.end(), piece.bytes.begin(), piece.bytes.end());
  const bool is_last = piece.first + piece.bytes.size() == array.n_bytes;
  const std::size_t n = is_last ? bytes.size() : bytes.size() / 3 * 3;
  file_.write(array.begin + first / 3 * 4, base64(bytes.data(), n));
}

}  // namespace umtet
