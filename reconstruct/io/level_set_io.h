#pragma once

#include <filesystem>
#include <stdexcept>

#include "reconstruct/level_set/level_set.h"

namespace umtet {

/// A file that is no complete level set. what() names the file and what is wrong with it.
struct LevelSetRefused : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Writes the artefact level_set.vti: VTK ImageData that opens in ParaView. The point data `psi_a` holds the
/// coefficients, close to psi itself at the nodes; the field data `lattice` (origin, h, counts) and `prior` (kind,
/// gamma, support, epsilon) hold what is needed to evaluate psi, as doubles, so that values read back are bit-equal.
/// @param shown_at  added to the image's origin for viewers (a cloud far from the origin is fitted near it)
/// \throw std::runtime_error  with the path: not written completely
void write_level_set(const std::filesystem::path& file, const LevelSet& psi, const Vec3& shown_at = Vec3::Zero());

/// \throw LevelSetRefused  not a level set, or damaged
/// \throw std::runtime_error  cannot be opened
LevelSet read_level_set(const std::filesystem::path& file);

}  // namespace umtet
