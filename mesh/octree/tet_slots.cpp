#include "mesh/octree/tet_slots.h"

namespace umtet::tet_slots {
namespace {

constexpr std::array<std::array<int, 2>, 4> kAround = {{{0, 0}, {2, 0}, {2, 2}, {0, 2}}};

struct Tables {
  std::array<std::uint64_t, 64> of_faces{};
  std::array<std::array<CubeCode, 4>, 6> corner{}, mid_point{};
  std::array<CubeCode, 6> centre{};
  std::array<std::array<Edge, 4>, 6> other{};
  std::array<std::array<int, 8>, 6> parent_centre{};
  // By code: bits of the first half where the code is the beginning of the edge; of the first and of the second half
  // where it is the end; of both where it is the mid-point; of all where it is the centre of the face.
  std::array<std::uint64_t, 27> begins{}, ends_whole{}, ends_half{}, always{};
  std::array<std::array<std::uint64_t, 27>, 8> between_sizes{};  ///< by octant and code
  // By slot, bits by code: the beginning and the end of the edge, or of its half; by octant and slot, three corners.
  std::array<std::uint32_t, kCount> whole{}, half{};
  std::array<std::array<std::uint32_t, kCount>, 8> triangle{};

  constexpr Tables();
};

constexpr std::uint32_t place(const CubeCode& code) { return std::uint32_t{1} << code_index(code); }

constexpr std::uint64_t bit(int face, int slot) { return std::uint64_t{1} << (kPerFace * face + slot); }

constexpr Tables::Tables() {
  for (unsigned faces = 0; faces < 64; ++faces) {
    for (int f = 0; f < 6; ++f) {
      if (faces >> f & 1) of_faces[faces] |= kFace << (kPerFace * f);
    }
  }
  for (int f = 0; f < 6; ++f) {
    const int a = f / 2, u = (a + 1) % 3, v = (a + 2) % 3;
    for (int i = 0; i < 4; ++i) {
      corner[f][i][a] = 2 * (f % 2);
      corner[f][i][u] = kAround[i][0];
      corner[f][i][v] = kAround[i][1];
    }
    for (int e = 0; e < 4; ++e) {
      for (int b = 0; b < 3; ++b) mid_point[f][e][b] = (corner[f][e][b] + corner[f][(e + 1) % 4][b]) / 2;
    }
    centre[f] = {1, 1, 1};
    centre[f][a] = 2 * (f % 2);
    for (int octant = 0; octant < 8; ++octant) {
      for (int i = 0; i < 4; ++i) {
        if ((corner[f][i][u] == 0) == ((octant >> u & 1) == 1) && (corner[f][i][v] == 0) == ((octant >> v & 1) == 1)) {
          parent_centre[f][octant] = i;
        }
      }
    }
  }
  for (int f = 0; f < 6; ++f) {
    for (int e = 0; e < 4; ++e) {
      for (int g = 0; g < 6; ++g) {
        for (int d = 0; d < 4; ++d) {
          if (g != f && mid_point[g][d] == mid_point[f][e]) other[f][e] = {g, d, corner[g][d] != corner[f][e]};
        }
      }
      const std::uint32_t middle = place(mid_point[f][e]);
      whole[kPerFace * f + 2 * e] = place(corner[f][e]) | place(corner[f][(e + 1) % 4]);
      half[kPerFace * f + 2 * e] = place(corner[f][e]) | middle;
      half[kPerFace * f + 2 * e + 1] = middle | place(corner[f][(e + 1) % 4]);
      begins[code_index(corner[f][e])] |= bit(f, 2 * e);
      ends_whole[code_index(corner[f][(e + 1) % 4])] |= bit(f, 2 * e);
      ends_half[code_index(corner[f][(e + 1) % 4])] |= bit(f, 2 * e + 1);
      always[code_index(mid_point[f][e])] |= bit(f, 2 * e) | bit(f, 2 * e + 1);
    }
    always[code_index(centre[f])] |= kFace << (kPerFace * f);
    for (int octant = 0; octant < 8; ++octant) {
      const int i = parent_centre[f][octant];
      const std::uint64_t first = bit(f, 0) | bit(f, 2), second = bit(f, 1) | bit(f, 3);
      for (int tri = 0; tri < 2; ++tri) {
        for (int side = 0; side < 2; ++side) {
          triangle[octant][kPerFace * f + 2 * side + tri] =
              place(corner[f][i]) | place(corner[f][(i + 1 + tri) % 4]) | place(corner[f][(i + 2 + tri) % 4]);
        }
      }
      between_sizes[octant][code_index(corner[f][i])] |= first | second;
      between_sizes[octant][code_index(corner[f][(i + 1) % 4])] |= first;
      between_sizes[octant][code_index(corner[f][(i + 2) % 4])] |= first | second;
      between_sizes[octant][code_index(corner[f][(i + 3) % 4])] |= second;
    }
  }
}

constexpr Tables kTables;

}  // namespace

std::uint64_t of_faces(unsigned faces) { return kTables.of_faces[faces]; }
const CubeCode& corner(int face, int i) { return kTables.corner[face][i]; }
const CubeCode& mid_point(int face, int e) { return kTables.mid_point[face][e]; }
const CubeCode& centre(int face) { return kTables.centre[face]; }
const Edge& on_other_face(int face, int e) { return kTables.other[face][e]; }
int parent_centre(int face, int octant) { return kTables.parent_centre[face][octant]; }

std::uint64_t at(const OctreeCell& leaf, int code) {
  const std::uint64_t between = of_faces(leaf.coarse);
  const std::uint64_t edges = kTables.begins[code] | kTables.ends_half[code] | kTables.always[code] |
                              (kTables.ends_whole[code] & ~(leaf.slots >> 1));
  return leaf.slots & ((edges & ~between) | (kTables.between_sizes[leaf.octant][code] & between));
}

std::uint32_t places(const OctreeCell& leaf, std::uint64_t slots) {
  const std::uint64_t between = of_faces(leaf.coarse);
  const std::uint64_t halves = (leaf.slots & kOdd) | (leaf.slots & kOdd) >> 1;
  std::uint32_t found = 0;
  for (; slots != 0; slots &= slots - 1) {
    const auto slot = static_cast<std::size_t>(std::countr_zero(slots));
    found |= between >> slot & 1  ? kTables.triangle[leaf.octant][slot]
             : halves >> slot & 1 ? kTables.half[slot]
                                  : kTables.whole[slot];
  }
  return found;
}

}  // namespace umtet::tet_slots
