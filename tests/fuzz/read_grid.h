#pragma once

#include <cstdlib>

#include "reconstruct/io/grid_io.h"
#include "tests/fuzz/input_file.h"

namespace umtet::fuzz {

/// A grid that a level set can be fitted to, no larger than its file can be unpacked to, or a refusal.
inline int read_grid(const InputFile& file, const std::uint8_t* data, std::size_t size) {
  try {
    const Grid grid = umtet::read_grid(file.write(data, size), 1e6);
    require(problems(grid).empty());
    require(grid.values.size() <= 1032 * size);
  } catch (const GridRefused&) {
  }
  return 0;
}

}  // namespace umtet::fuzz
