#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "distributed/io/shared_file.h"
#include "mesh/io/vtu_shape.h"

namespace umtet {

/// Arrays of a .vtu file that all ranks write piece by piece, in the order of an IdOrder.
class SharedArrays {
 public:
  /// @param arrays  arrays of the file; they must outlive the object
  SharedArrays(SharedFile& file, std::vector<const VtuShape::Array*> arrays);

  /// Sets this rank's piece of an array in the current round. @param first  position of its first byte in the array
  template <class T>
  void put(std::size_t array, std::size_t first, const std::vector<T>& values) {
    Piece& piece = pieces_[array];
    piece.first = first;
    piece.bytes.resize(values.size() * sizeof(T));
    if (!values.empty()) std::memcpy(piece.bytes.data(), values.data(), piece.bytes.size());
  }
  /// Writes the pieces of this rank and ends the round. Not collective.
  void write();

 private:
  struct Piece {
    std::size_t first = 0;
    std::string bytes;
  };

  SharedFile& file_;
  std::vector<const VtuShape::Array*> arrays_;
  std::vector<Piece> pieces_;
};

}  // namespace umtet
