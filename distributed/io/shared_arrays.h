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

/// Arrays of a .vtu that all ranks write piece by piece, in the order of an IdOrder. Three bytes are four characters:
/// what is left of a piece goes to the next one.
class SharedArrays {
 public:
  /// @param arrays  stay where they are
  SharedArrays(MPI_Comm comm, SharedFile& file, std::vector<const VtuShape::Array*> arrays);

  /// This rank's piece of one array in the round at hand. @param first  byte of the array that it begins with
  template <class T>
  void put(std::size_t array, std::size_t first, const std::vector<T>& values) {
    Piece& piece = pieces_[array];
    piece.first = first;
    piece.bytes.resize(values.size() * sizeof(T));
    if (!values.empty()) std::memcpy(piece.bytes.data(), values.data(), piece.bytes.size());
  }
  /// Ends the round: writes. Collective.
  void write();

 private:
  static constexpr std::size_t kTail = 2;  ///< bytes that may be left of groups of three

  struct Piece {
    std::size_t first = 0;
    std::vector<unsigned char> bytes;
  };
  void write(const VtuShape::Array& array, const Piece& piece, const unsigned char* before);

  MPI_Comm comm_;
  SharedFile& file_;
  std::vector<const VtuShape::Array*> arrays_;
  std::vector<Piece> pieces_;
  std::vector<unsigned char> before_;  ///< of rank 0: what the last rank had left in the round before
};

}  // namespace umtet
