#include <algorithm>
#include <array>
#include <vector>

#include "mesh/background/tiling.h"
#include "mesh/background/tilings/periodic_tiling.h"

// An acute triangulation of the cube with 246 vertices and 1201 tets. This project's own: the combinatorics come from
// completing vertex links from a pattern of 14 triangles on each face, under the symmetry Td of the regular tet; the 36
// free coordinates were optimised for quality with all dihedral angles below 87.3 degrees. (The mesh of 277 vertices in
// [VanderZee2010] is another one.) Interior edges have 5 or 6 tets. Verified by
// tests/mesh/background/tiling_test.cpp.

namespace umtet {
namespace {

using ExactTet = std::array<Vec3, 4>;

// One point of each orbit of Td, relative to the centre of the cube of side 1.
constexpr std::array<std::array<double, 3>, 23> kPoints = {{
    {.5, .5, .5},                  //
    {.5, .5, -.5},                 //
    {.5, .5, .007808},             //
    {.5, .120146, .120146},        //
    {.5, .178096, -.178096},       //
    {.272756, .272756, .116905},   // 5
    {.304387, .304387, -.17105},   //
    {.316453, .202923, -.030357},  //
    {.32153, .054451, -.054451},   //
    {.257269, .086395, .086395},   //
    {.269806, .139618, -.139618},  // 10
    {.149135, .149135, .149135},   //
    {.185969, .185969, -.185969},  //
    {.178775, .178775, .028513},   //
    {.195863, .195863, -.079956},  //
    {.153259, .068201, .068201},   // 15
    {.16235, .104877, -.104877},   //
    {.212529, .099464, -.031929},  //
    {.212433, 0, 0},               //
    {.122489, .122489, -.022867},  //
    {.138399, .032851, -.032851},  // 20
    {.042636, .042636, .042636},   //
    {.072147, .072147, -.072147},  //
}};

// A point of the cube: the image of a point above under an operation of Td. Operation 4 p + s puts coordinate
// kPermutations[p][k] in place k and then changes signs by kSigns[s].
struct Image {
  int point, operation;
};
constexpr std::array<std::array<int, 3>, 6> kPermutations = {
    {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}};
constexpr std::array<std::array<double, 3>, 4> kSigns = {{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}};

// One tet of each orbit.
constexpr std::array<std::array<Image, 4>, 74> kTets = {{
    {{{0, 0}, {2, 0}, {3, 0}, {5, 0}}},      {{{0, 0}, {3, 0}, {5, 0}, {5, 4}}},
    {{{0, 0}, {5, 0}, {5, 4}, {5, 16}}},     {{{1, 0}, {2, 0}, {4, 0}, {6, 0}}},
    {{{1, 0}, {4, 0}, {6, 0}, {6, 5}}},      {{{1, 0}, {6, 0}, {6, 5}, {6, 18}}},
    {{{2, 0}, {3, 0}, {4, 0}, {7, 0}}},      {{{2, 0}, {3, 0}, {5, 0}, {7, 0}}},
    {{{2, 0}, {4, 0}, {6, 0}, {7, 0}}},      {{{2, 0}, {5, 0}, {7, 0}, {7, 8}}},
    {{{2, 0}, {6, 0}, {7, 0}, {7, 8}}},      {{{3, 0}, {3, 1}, {4, 0}, {8, 0}}},
    {{{3, 0}, {3, 1}, {8, 0}, {8, 1}}},      {{{3, 0}, {4, 0}, {7, 0}, {8, 0}}},
    {{{3, 0}, {5, 0}, {5, 4}, {9, 0}}},      {{{3, 0}, {5, 0}, {7, 0}, {9, 0}}},
    {{{3, 0}, {7, 0}, {8, 0}, {9, 0}}},      {{{3, 0}, {8, 0}, {8, 1}, {9, 0}}},
    {{{4, 0}, {6, 0}, {6, 5}, {10, 0}}},     {{{4, 0}, {6, 0}, {7, 0}, {10, 0}}},
    {{{4, 0}, {7, 0}, {8, 0}, {10, 0}}},     {{{5, 0}, {5, 4}, {5, 16}, {11, 0}}},
    {{{5, 0}, {5, 4}, {9, 0}, {11, 0}}},     {{{5, 0}, {7, 0}, {7, 8}, {13, 0}}},
    {{{5, 0}, {7, 0}, {9, 0}, {13, 0}}},     {{{5, 0}, {9, 0}, {11, 0}, {13, 0}}},
    {{{6, 0}, {6, 5}, {6, 18}, {12, 0}}},    {{{6, 0}, {6, 5}, {10, 0}, {12, 0}}},
    {{{6, 0}, {7, 0}, {7, 8}, {14, 0}}},     {{{6, 0}, {7, 0}, {10, 0}, {14, 0}}},
    {{{6, 0}, {10, 0}, {12, 0}, {14, 0}}},   {{{7, 0}, {7, 8}, {13, 0}, {14, 0}}},
    {{{7, 0}, {8, 0}, {9, 0}, {17, 0}}},     {{{7, 0}, {8, 0}, {10, 0}, {17, 0}}},
    {{{7, 0}, {9, 0}, {13, 0}, {17, 0}}},    {{{7, 0}, {10, 0}, {14, 0}, {17, 0}}},
    {{{7, 0}, {13, 0}, {14, 0}, {17, 0}}},   {{{8, 0}, {8, 1}, {9, 0}, {18, 0}}},
    {{{8, 0}, {9, 0}, {17, 0}, {18, 0}}},    {{{8, 0}, {10, 0}, {17, 0}, {17, 5}}},
    {{{8, 0}, {17, 0}, {17, 5}, {18, 0}}},   {{{9, 0}, {11, 0}, {13, 0}, {15, 0}}},
    {{{9, 0}, {13, 0}, {15, 0}, {17, 0}}},   {{{9, 0}, {15, 0}, {17, 0}, {18, 0}}},
    {{{10, 0}, {12, 0}, {14, 0}, {16, 0}}},  {{{10, 0}, {14, 0}, {16, 0}, {17, 0}}},
    {{{10, 0}, {16, 0}, {17, 0}, {17, 5}}},  {{{11, 0}, {13, 0}, {15, 0}, {15, 8}}},
    {{{11, 0}, {15, 0}, {15, 8}, {15, 12}}}, {{{12, 0}, {14, 0}, {16, 0}, {16, 8}}},
    {{{12, 0}, {16, 0}, {16, 8}, {16, 13}}}, {{{13, 0}, {14, 0}, {17, 0}, {19, 0}}},
    {{{13, 0}, {15, 0}, {15, 8}, {19, 0}}},  {{{13, 0}, {15, 0}, {17, 0}, {19, 0}}},
    {{{14, 0}, {16, 0}, {16, 8}, {19, 0}}},  {{{14, 0}, {16, 0}, {17, 0}, {19, 0}}},
    {{{15, 0}, {15, 8}, {15, 12}, {21, 0}}}, {{{15, 0}, {15, 8}, {19, 0}, {21, 0}}},
    {{{15, 0}, {17, 0}, {18, 0}, {20, 0}}},  {{{15, 0}, {17, 0}, {19, 0}, {20, 0}}},
    {{{15, 0}, {18, 0}, {20, 0}, {20, 1}}},  {{{15, 0}, {19, 0}, {20, 0}, {21, 0}}},
    {{{15, 0}, {20, 0}, {20, 1}, {21, 0}}},  {{{16, 0}, {16, 8}, {16, 13}, {22, 0}}},
    {{{16, 0}, {16, 8}, {19, 0}, {22, 0}}},  {{{16, 0}, {17, 0}, {17, 5}, {20, 0}}},
    {{{16, 0}, {17, 0}, {19, 0}, {20, 0}}},  {{{16, 0}, {19, 0}, {20, 0}, {22, 0}}},
    {{{17, 0}, {17, 5}, {18, 0}, {20, 0}}},  {{{19, 0}, {20, 0}, {21, 0}, {22, 0}}},
    {{{20, 0}, {20, 1}, {21, 0}, {21, 1}}},  {{{20, 0}, {21, 0}, {21, 1}, {22, 0}}},
    {{{21, 0}, {21, 1}, {21, 2}, {21, 3}}},  {{{21, 0}, {21, 1}, {21, 2}, {22, 0}}},
}};

Vec3 apply(int operation, const Vec3& x) {
  Vec3 y;
  for (int k = 0; k < 3; ++k) y[k] = kSigns[operation % 4][k] * x[kPermutations[operation / 4][k]];
  return y;
}

/// The tets of a cube, relative to its centre; those on a mirror several times.
std::vector<ExactTet> cube() {
  std::vector<ExactTet> all;
  for (const auto& tet : kTets) {
    for (int operation = 0; operation < 24; ++operation) {
      ExactTet image;
      for (int k = 0; k < 4; ++k) {
        const auto& p = kPoints[tet[k].point];
        image[k] = apply(operation, apply(tet[k].operation, Vec3(p[0], p[1], p[2])));
      }
      all.push_back(image);
    }
  }
  return all;
}

}  // namespace

const Tiling& acute_cube() {
  static const Tiling tiling = [] {
    const std::vector<ExactTet> one = cube();
    std::vector<ExactTet> block;
    for (int c = 0; c < 8; ++c) {
      const int i = c & 1, j = c >> 1 & 1, k = c >> 2;
      // Opposite faces carry the same pattern turned by 90 degrees, so every other cube is turned.
      const bool turned = (i + j + k) % 2 != 0;
      for (ExactTet tet : one) {
        for (Vec3& p : tet) p = Vec3(i + .5, j + .5, k + .5) + (turned ? Vec3(-p.y(), p.x(), p.z()) : p);
        block.push_back(tet);
      }
    }
    Tiling made = periodic_tiling("cube", block, Vec3::Constant(2), Vec3::Ones());
    made.excess_layer = .09;  // less than in the others: small tets sit around the centres of the cubes
    return made;
  }();
  return tiling;
}

}  // namespace umtet
