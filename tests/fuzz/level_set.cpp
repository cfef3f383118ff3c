#include <cstdlib>

#include "reconstruct/io/level_set_io.h"
#include "tests/fuzz/input_file.h"

/// A level set with values, or a refusal.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const umtet::fuzz::InputFile file(".vti");
  try {
    const umtet::LevelSet psi = umtet::read_level_set(file.write(data, size));
    const umtet::Lattice& lattice = psi.coarsest().lattice;
    const umtet::Vec3 middle = lattice.origin + lattice.h * (lattice.n.array() - 1).matrix().cast<double>() / 2;
    (void)psi.value(middle);
  } catch (const umtet::LevelSetRefused&) {
  }
  return 0;
}
