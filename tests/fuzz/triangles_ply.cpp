#include "tests/fuzz/read_triangles.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const umtet::fuzz::InputFile file(".ply");
  return umtet::fuzz::read_triangle_file(file, data, size);
}
