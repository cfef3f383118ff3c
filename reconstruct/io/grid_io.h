#pragma once

#include <filesystem>
#include <stdexcept>

#include "reconstruct/level_set/grid.h"

namespace umtet {

/// A file that is no grid that can be read. what() names the file, the place in it and what is wrong there.
struct GridRefused : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Reads a grid of one number a node, by what the file begins with:
///
///   VTK ImageData (.vti)     ascii, base64, appended; plain or compressed by zlib; the first array of points
///   VTK structured points    (.vtk, legacy) ascii or binary; the first array of points
///   NRRD                     raw, gzip or ascii, attached data
///   NIfTI-1                  a single file; sform, else qform, else the voxel sizes
///
/// each of them as it is or compressed by gzip. A cell array of a VTK file is one of voxels: its nodes are their
/// middles.
/// @param max_nodes  more are refused before memory is taken
/// \throw GridRefused  also where problems(grid) has something
/// \throw std::system_error  cannot be opened or read
Grid read_grid(const std::filesystem::path& file, double max_nodes = 1e9);

/// True for a regular file that begins as one of these, plain or compressed. \throw std::system_error  cannot be opened
/// or read
bool is_grid_file(const std::filesystem::path& file);

/// What its head is enough for: format and number of nodes. \throw as read_grid()
void check_grid_head(const std::filesystem::path& file, double max_nodes = 1e9);

}  // namespace umtet
