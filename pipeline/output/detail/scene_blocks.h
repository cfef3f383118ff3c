#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "common/vec3.h"

// Arrays of a report in base64, little-endian.
namespace umtet::detail {

/// A face and the vertex of its tet behind it; a triangle without a tet repeats a corner.
using FacedTet = std::array<int, 4>;

/// Returns a value in 255ths of a range.
std::uint8_t in_steps(double value, double least, double most);
/// Returns a value in 254ths of a range; 255 for NaN.
std::uint8_t in_known_steps(double value, double least, double most);

std::string byte_block(const std::vector<std::uint8_t>& bytes);
/// 3 x uint16 per point, in 65535ths of the box; points outside are moved to its walls.
std::string position_block(const std::vector<Vec3>& points, const Vec3& box_min, const Vec3& box_size);
/// 3 bytes per direction: each component from -1 to 1 in 254ths.
std::string direction_block(const std::vector<Vec3>& directions);
/// Indices of 2 or 4 bytes.
std::string index_block(const std::vector<FacedTet>& list, int index_bytes);
/// Returns the bytes of an index for this number of vertices: 2 or 4.
int index_bytes_for(std::size_t n_vertices);

/// Reduces triangles (the first three ids) to at most `most`: the corners in a cell of a grid move to one of them, and
/// faces that vanish are dropped; the cells grow until few enough are left. A closed surface stays closed.
/// @return the indices of the faces that are kept; `faces` contains only these, with their new corners
std::vector<std::size_t> coarsen_faces(const std::vector<Vec3>& V, const Vec3& box_min, std::size_t most,
                                       std::vector<FacedTet>& faces);

}  // namespace umtet::detail
