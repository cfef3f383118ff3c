#pragma once

#ifdef __BMI2__
#include <immintrin.h>
#endif

#include <array>
#include <bit>
#include <cstdint>

namespace umtet {

/// Integer coordinates in the root cube of an octree, which has width 2^kRootBits for any depth of the tree. A leaf of
/// level l has width 2^(kRootBits - l). Leaves of the last level have width 2, so that their centres are grid points,
/// too.
using GridPoint = std::array<std::int32_t, 3>;

inline constexpr int kMaxOctreeLevel = 17;
inline constexpr int kRootBits = kMaxOctreeLevel + 1;
inline constexpr std::int32_t kRootWidth = 1 << kRootBits;

inline constexpr std::uint64_t kEveryThirdBit = 0x1249249249249249;

/// Moves bit i of a coordinate to bit 3 i.
inline std::uint64_t spread_bits(std::uint64_t x) {
#ifdef __BMI2__
  return _pdep_u64(x, kEveryThirdBit);
#else
  x = (x | x << 32) & 0x001f00000000ffff;
  x = (x | x << 16) & 0x001f0000ff0000ff;
  x = (x | x << 8) & 0x100f00f00f00f00f;
  x = (x | x << 4) & 0x10c30c30c30c30c3;
  return (x | x << 2) & kEveryThirdBit;
#endif
}

/// Inverse of spread_bits(): moves bit 3 i to bit i.
inline std::int32_t collected_bits(std::uint64_t x) {
#ifdef __BMI2__
  return static_cast<std::int32_t>(_pext_u64(x, kEveryThirdBit));
#else
  x &= kEveryThirdBit;
  x = (x | x >> 2) & 0x10c30c30c30c30c3;
  x = (x | x >> 4) & 0x100f00f00f00f00f;
  x = (x | x >> 8) & 0x001f0000ff0000ff;
  x = (x | x >> 16) & 0x001f00000000ffff;
  return static_cast<std::int32_t>((x | x >> 32) & 0x1fffff);
#endif
}

/// Morton key: the interleaved bits of x, y and z, x lowest. A cube of the octree is an interval of keys. Its lower
/// corner has the least key, and its centre is the corner of its last child.
inline std::uint64_t morton_key(const GridPoint& p) {
  return spread_bits(static_cast<std::uint64_t>(p[0])) | spread_bits(static_cast<std::uint64_t>(p[1])) << 1 |
         spread_bits(static_cast<std::uint64_t>(p[2])) << 2;
}
inline GridPoint grid_point(std::uint64_t key) {
  return {collected_bits(key), collected_bits(key >> 1), collected_bits(key >> 2)};
}

/// True for a point of the closed root cube.
inline bool is_in_root(const GridPoint& p) {
  for (const std::int32_t x : p) {
    if (x < 0 || x > kRootWidth) return false;
  }
  return true;
}

/// Position in a key of half the width of a cube of this level: three bits, one per axis.
inline int half_width_shift(int level) { return 3 * (kRootBits - 1 - level); }
inline std::int32_t width(int level) { return kRootWidth >> level; }

/// Identifies a cube by the key of its centre, which no cube of another level has. The lowest set bit gives the level.
inline std::uint64_t cube_key(std::uint64_t corner, int level) {
  return corner | std::uint64_t{7} << half_width_shift(level);
}
inline int cube_level(std::uint64_t cube) { return kRootBits - 1 - std::countr_zero(cube) / 3; }
inline std::uint64_t cube_corner(std::uint64_t cube) { return cube & ~(std::uint64_t{7} << std::countr_zero(cube)); }

}  // namespace umtet
