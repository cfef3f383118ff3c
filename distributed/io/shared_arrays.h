#pragma once

#include <mpi.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "distributed/io/shared_file.h"
#include "mesh/io/vtu_shape.h"

namespace umtet {

/// Arrays of a .vtu file that all ranks write piece by piece, in the order of an IdOrder. Three bytes are encoded as
/// four characters, and the remainder of a piece is passed to the next one.
class SharedArrays {
 public:
  /// @param arrays  must outlive the object
  SharedArrays(MPI_Comm comm, SharedFile& file, std::vector<const VtuShape::Array*> arrays);

  /// Sets this rank's piece of an array in the current round. @param first  position of its first byte in the array
  template <class T>
  void put(std::size_t array, std::size_t first, const std::vector<T>& values) {
    Piece& piece = pieces_[array];
    piece.first = first;
    piece.bytes.resize(values.size() * sizeof(T));
    if (!values.empty()) std::memcpy(piece.bytes.data(), values.data(), piece.bytes.size());
  }
  /// Writes and ends the round. Collective.
  void write();

 private:
  static constexpr std::size_t kTail = 2;  ///< maximum remainder of groups of three bytes

  struct Piece {
    std::size_t first = 0;
    std::vector<unsigned char> bytes;
  };
  void write(const VtuShape::Array& array, const Piece& piece, const unsigned char* before);

  MPI_Comm comm_;
  SharedFile& file_;
  std::vector<const VtuShape::Array*> arrays_;
  std::vector<Piece> pieces_;
  std::vector<unsigned char> before_;  ///< on rank 0: the remainder of the last rank in the previous round
};

}  // namespace umtet
