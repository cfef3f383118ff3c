#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "mesh/background/background_mesh.h"
#include "mesh/background/body_size.h"
#include "pipeline/case/parameters.h"
#include "pipeline/domain/domain.h"

namespace umtet {

/// The mesh file that mesh.background names, if it is no tiling.
std::optional<std::filesystem::path> background_file(const Parameters&);

/// \throw UsageError for mesh.box_walls with another background than a15, or mesh.complement without mesh.box_walls
void require_walls(const Parameters&);

/// What classifies the vertices in a mesh of these parameters: fast mode chooses in backgrounds that are a tiling and
/// have no walls.
ClassificationSource classification_source(const Parameters&);

/// What --background and --box-walls ask for: a lattice or a box of any edge length, or a mesh that has its own.
class BackgroundChoice {
 public:
  /// Reads the file, if it is one. Its coordinates are model coordinates.
  /// \throw UsageError when h or a number of tets is given for a file, or as require_walls(); MeshFileRefused,
  ///        std::system_error
  BackgroundChoice(const Parameters& parameters, const Domain& domain);

  /// That of the file.
  std::optional<double> own_h() const { return given_ ? std::optional(given_->h()) : std::nullopt; }
  /// About how many tets of it are taken.
  double expected_tets(const Domain& domain, double h) const;
  /// @param n_tets  that are wanted, or 0
  /// @param allowed  bytes
  /// \throw ResourceLimit
  BackgroundMesh make(const Domain& domain, double h, std::int64_t n_tets, double allowed) const;

 private:
  std::optional<BackgroundMesh> given_;
  const Tiling* tiling_;  ///< that the number of tets is estimated by, for a file too
  ClassificationSource source_;
  bool walls_;
};

}  // namespace umtet
