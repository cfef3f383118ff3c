#pragma once

#include <filesystem>

#include "common/message.h"
#include "reconstruct/io/input_file.h"
#include "reconstruct/level_set/grid.h"

namespace umtet {

/// Error for a file that is not a readable grid. what() contains the file, the location in it and the reason.
struct GridRefused : ExplainedError {
  using ExplainedError::ExplainedError;
};

/// Reads a grid of one number per node. The first bytes of the file determine the format:
///
///   VTK ImageData (.vti)     ascii, base64, appended; plain or compressed by zlib; the first array of points
///   VTK structured points    (.vtk, legacy) ascii or binary; the first array of points
///   NRRD                     raw, gzip or ascii, attached data
///   NIfTI-1                  a single file; sform, else qform, else the voxel sizes
///
/// all of them uncompressed or compressed by gzip. A cell array of a VTK file is an array of voxels, whose centres
/// become nodes.
/// @param max_nodes  larger grids are rejected before memory is allocated
/// \throw GridRefused for an invalid file, and if problems(grid) is not empty
/// \throw std::system_error if the file cannot be opened or read
Grid read_grid(const std::filesystem::path& file, double max_nodes = 1e9);

/// True for a regular file that begins like one of these formats, uncompressed or compressed. \throw std::system_error
/// if it cannot be read
bool is_grid_file(const InputFile& file);

/// Checks the head of a file: format and number of nodes. \throw as read_grid()
void check_grid_head(const std::filesystem::path& file, double max_nodes = 1e9);

}  // namespace umtet
