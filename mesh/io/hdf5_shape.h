#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <variant>
#include <vector>

#include "mesh/io/solver_mesh.h"

// Layout of the files of write_hdf5() and write_xdmf(), for processes that write a part of the arrays each.
namespace umtet {

/// Name, value type and size of an array in an HDF5 file.
struct Hdf5Array {
  std::string name;
  std::variant<double, int, std::int64_t, std::uint8_t> type;  ///< type of its values
  std::size_t rows, columns = 0;                               ///< 0: a one-dimensional array
};

/// Creates an HDF5 file with contiguous space for these arrays, without values. With the values written, the file
/// equals the one that HDF5 would write.
/// @return the begin of each array in bytes
/// \throw std::runtime_error for arrays that HDF5 cannot write
std::vector<std::uint64_t> make_hdf5(const std::filesystem::path& path, const std::vector<Hdf5Array>& arrays);

/// Contents of an HDF5 file of tets with standard data.
struct XdmfShape {
  std::size_t n_nodes = 0, n_tets = 0, n_faces = 0;
  std::vector<MeshPart> patches;

  /// True if node numbers have 64 bits, false if they have 32.
  bool has_wide_ids() const { return n_nodes > static_cast<std::size_t>(std::numeric_limits<int>::max()); }
  /// Names of the 0/1 arrays of nodes: one for the whole boundary, and one per patch if there are several.
  std::vector<std::string> node_sets() const {
    std::vector<std::string> names = {kWholeBoundary};
    for (const MeshPart& patch : patches)
      if (patches.size() > 1) names.push_back(patch.name);
    return names;
  }
};

/// write_xdmf() and write_boundary_xdmf() (solver_files.h) for an HDF5 file of this shape.
void write_xdmf(const std::filesystem::path& path, const XdmfShape& shape, const std::string& hdf5);
void write_boundary_xdmf(const std::filesystem::path& path, const XdmfShape& shape, const std::string& hdf5);

}  // namespace umtet
