#include "tests/fuzz/read_grid.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const umtet::fuzz::InputFile file(".vtk");
  return umtet::fuzz::read_grid(file, data, size);
}
