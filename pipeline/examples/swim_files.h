#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

#include "pipeline/examples/swim.h"

namespace umtet {

/// What the table has beside the motion.
struct SwimRow {
  SwimStep step;
  double min_quality;  ///< mean ratio of the worst tet of the fluid
  std::size_t n_tets;  ///< of the fluid
  double volume_gap;   ///< FluidMesh::volume_gap
  double seconds;      ///< since the row before, meshing and files included
};

/// The worst mean ratio of the fluid's tets. @param background all tets, FluidMesh::tets are numbers of them
double min_quality(const FluidMesh& fluid, std::span<const Tet> background);

/// One run's files in a folder, each whole at any time, and made anew from all rows so far:
/// swimmer.csv, swimmer.svg (z0' and z0 over t), swimmer.pvd (the fields by time), fields/NNN.vtu.
class SwimFiles {
 public:
  /// Makes the folders. \throw std::system_error naming what failed, as do all below
  explicit SwimFiles(std::filesystem::path folder);

  /// fields/NNN.vtu: the fluid's mesh with components of u^phi and u^z, p^phi, p^z and ids of the background.
  /// The flow of a free swimmer is u^phi + z0' u^z, eq. (20).
  void write_fields(std::size_t row, const FluidMesh& fluid, std::span<const Tet> background,
                    const ForceFreeMotion& motion) const;
  /// @param fields  were written for all rows: swimmer.pvd lists them
  void write_tables(std::span<const SwimRow> rows, bool fields) const;

 private:
  std::filesystem::path field_file(std::size_t row) const;

  std::filesystem::path folder_;
};

}  // namespace umtet
