#include "tests/fuzz/read_cloud.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const umtet::fuzz::InputFile file(".xyz");
  return umtet::fuzz::read_cloud(file, data, size, "z,-,x,y,label,nx,heat");
}
