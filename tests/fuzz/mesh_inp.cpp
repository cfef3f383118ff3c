#include "tests/fuzz/read_mesh.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const umtet::fuzz::InputFile file(".inp");
  return umtet::fuzz::read_mesh(file, data, size);
}
