#pragma once

#ifdef __BMI2__
#include <immintrin.h>
#endif

#include <array>
#include <bit>
#include <cstdint>

#include "mesh/octree/linear_octree.h"

namespace umtet {

/// The possible tets of a leaf, their corners and adjacency, as tables of 48 bits [Labelle2007].
///
/// A tet lies on both sides of a face between two leaves, or on one side of a face without a leaf behind. The corners
/// of faces 2 a and 2 a + 1 of a leaf are numbered around axis a; edge e goes from corner e to corner e + 1 (modulo 4).
/// Slots 8 f .. 8 f + 7 belong to face f:
/// - Between leaves of one size, slots belong to the upper face of the lower leaf. Slot 8 f + 2 e is the tet of the two
///   centres and edge e. If the edge has a mid-point, this tet has the half at corner e, and slot 8 f + 2 e + 1 has the
///   other half. At the background boundary the slots are the same, with the centre of the face in place of the other
///   leaf's centre.
/// - Between two sizes, slots belong to the smaller leaf. The diagonal from the centre of the large face to its corner
///   divides the small face into two triangles. Slot 8 f + tri is the tet of the small centre and triangle tri, slot 8
///   f + 2 + tri the tet of the large centre.
///
/// Other faces have no slots.
namespace tet_slots {

inline constexpr int kPerFace = 8, kCount = 48;
inline constexpr std::uint64_t kFace = 0xff;
inline constexpr std::uint64_t kOdd = 0xaaaaaaaaaaaa;        ///< second halves of edges
inline constexpr std::uint64_t kLargeSide = 0x0c0c0c0c0c0c;  ///< between two sizes: slots with the large centre

/// The slot bits of a set of faces.
std::uint64_t of_faces(unsigned faces);

/// Positions in half widths: corner i of a face, mid-point of its edge e, its centre.
const CubeCode& corner(int face, int i);
const CubeCode& mid_point(int face, int e);
const CubeCode& centre(int face);

/// An edge of a face, seen from the other face that contains it.
struct Edge {
  int face = 0, edge = 0;
  bool reversed = false;  ///< it runs in the opposite direction there
};
const Edge& on_other_face(int face, int e);

/// The corner of a face, in a leaf at `octant` of its parent, that is the centre of the parent's face.
int parent_centre(int face, int octant);

/// Slots of a leaf's tets that have the vertex at a code (not the leaf's centre) as a corner.
std::uint64_t at(const OctreeCell& leaf, int code_index);

/// Positions in a leaf, as bits by code_index(), of the corners of some of its tets; centres of leaves are excluded.
std::uint32_t places(const OctreeCell& leaf, std::uint64_t slots);

/// Number of set bits below a slot.
inline int rank(std::uint64_t slots, int slot) { return std::popcount(slots & ((std::uint64_t{1} << slot) - 1)); }
/// The slot with this rank.
inline int select(std::uint64_t slots, int rank) {
#ifdef __BMI2__
  return std::countr_zero(_pdep_u64(std::uint64_t{1} << rank, slots));
#else
  for (; rank > 0; --rank) slots &= slots - 1;
  return std::countr_zero(slots);
#endif
}

}  // namespace tet_slots
}  // namespace umtet
