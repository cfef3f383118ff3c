#pragma once

#ifdef __BMI2__
#include <immintrin.h>
#endif

#include <array>
#include <bit>
#include <cstdint>

#include "mesh/octree/linear_octree.h"

namespace umtet {

/// The tets of a leaf: which there can be, their corners and who contains what, as tables of 48 bits [Labelle2007].
///
/// A tet lies on both sides of a face between two leaves, or on one side of a face that no leaf is behind. The corners
/// of face 2 a and 2 a + 1 of a leaf are counted around axis a, edge e runs from corner e to corner e + 1 (modulo 4).
/// Slots 8 f .. 8 f + 7 are for face f:
/// - Between leaves of one size, for the upper face of the lower leaf; and for a face at the background boundary, with
/// the
///   centre of the face for the other leaf's: 8 f + 2 e, the two centres and edge e; if the edge has a mid-point, that
///   tet has the half at corner e, and 8 f + 2 e + 1 the other.
/// - Of the smaller leaf, between two sizes: the diagonal from the centre of the large face to its corner divides the
///   small face. 8 f + tri, the small centre and triangle tri; 8 f + 2 + tri, the large centre.
/// The other faces have none.
namespace tet_slots {

inline constexpr int kPerFace = 8, kCount = 48;
inline constexpr std::uint64_t kFace = 0xff;
inline constexpr std::uint64_t kOdd = 0xaaaaaaaaaaaa;        ///< second halves of edges
inline constexpr std::uint64_t kLargeSide = 0x0c0c0c0c0c0c;  ///< between two sizes: those with the large centre

/// The bits of the faces in a set of faces.
std::uint64_t of_faces(unsigned faces);

/// Corner i of a face in half widths; mid-point of its edge e; its centre.
const CubeCode& corner(int face, int i);
const CubeCode& mid_point(int face, int e);
const CubeCode& centre(int face);

/// The same edge on the other face that it is on.
struct Edge {
  int face = 0, edge = 0;
  bool reversed = false;  ///< runs the other way there
};
const Edge& on_other_face(int face, int e);

/// Which corner of a face, in a leaf at `octant` of its parent, is the centre of the parent's face.
int parent_centre(int face, int octant);

/// Those of a leaf's tets that have the vertex at a code (not its centre) as a corner.
std::uint64_t at(const OctreeCell& leaf, int code_index);

/// The places of a leaf, bits by code_index(), where corners of some of its tets are; centres of leaves are not
/// counted.
std::uint32_t places(const OctreeCell& leaf, std::uint64_t slots);

/// Number of bits below a bit of a set.
inline int rank(std::uint64_t slots, int slot) { return std::popcount(slots & ((std::uint64_t{1} << slot) - 1)); }
/// The bit that has this rank.
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
