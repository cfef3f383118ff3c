#pragma once

#include <filesystem>
#include <stdexcept>

#include "reconstruct/level_set/level_set.h"

namespace umtet {

/// Error for a file that is not a complete level set. what() contains the file and the reason.
struct LevelSetRefused : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Writes level_set.vti, a VTK ImageData file that opens in ParaView. The point data `psi_a` contain the coefficients,
/// which are close to psi at the nodes. The field data `lattice` (origin, h, counts) and `prior` (kind, gamma, support,
/// epsilon) contain all other data for evaluating psi. All are doubles, so that values read back are bit-equal.
/// @param shown_at  added to the image's origin for viewers (a cloud far from the origin is fitted near the origin)
/// \throw std::runtime_error with the path, if the file was not written completely
void write_level_set(const std::filesystem::path& file, const LevelSet& psi, const Vec3& shown_at = Vec3::Zero());

/// Reads such a file.
/// \throw LevelSetRefused if it is not a level set, or damaged
/// \throw std::runtime_error if it cannot be opened
LevelSet read_level_set(const std::filesystem::path& file);

}  // namespace umtet
