#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

#include "examples/swimmer/swim.h"

namespace umtet {

/// A row of the table: the motion and further values.
struct SwimRow {
  SwimStep step;
  double min_quality;  ///< mean ratio of the worst tet of the fluid
  std::size_t n_tets;  ///< number of tets of the fluid
  double volume_gap;   ///< FluidMesh::volume_gap
  double seconds;      ///< seconds since the previous row, including meshing and files
};

/// Returns the minimum mean ratio of the fluid's tets. @param background  all tets, which FluidMesh::tets refers to
double min_quality(const FluidMesh& fluid, std::span<const Tet> background);

/// The files of one run in a folder. Each is complete at any time, and rewritten from all rows so far:
/// swimmer.csv, swimmer.svg (z0' and z0 over t), swimmer.pvd (the fields by time), fields/NNN.vtu.
class SwimFiles {
 public:
  /// Creates the folders. \throw std::system_error  names the file that failed; all functions below throw it, too
  explicit SwimFiles(std::filesystem::path folder);

  /// Writes fields/NNN.vtu: the fluid's mesh with components of u^phi and u^z, p^phi, p^z and ids of the background.
  /// The flow of a free swimmer is u^phi + z0' u^z, eq. (20).
  void write_fields(std::size_t row, const FluidMesh& fluid, std::span<const Tet> background,
                    const ForceFreeMotion& motion) const;
  /// @param fields  whether fields were written for all rows: then swimmer.pvd lists them
  void write_tables(std::span<const SwimRow> rows, bool fields) const;

 private:
  std::filesystem::path field_file(std::size_t row) const;

  std::filesystem::path folder_;
};

}  // namespace umtet
