#pragma once

#include "reconstruct/io/detail/cloud_source.h"

namespace umtet::detail {

/// Check the beginning of a file: its header and, for binary files, its counts against the size of the file; for XYZ
/// the rows it contains. Headers are shorter than this beginning.
/// \throw CloudRefused under the conditions of the reader
void check_ply_head(const CloudSource& head);
void check_pcd_head(const CloudSource& head);
void check_xyz_head(const CloudSource& head);

/// True if the file is a table of numbers, whatever its extension.
bool is_xyz(const CloudSource& head);

/// True if the points are stored as consecutive numbers, so that they can be read in blocks.
bool is_in_blocks_ply(const CloudSource& head);
bool is_in_blocks_pcd(const CloudSource& head);

/// One reader per format. Readers check the structure of the file; read_point_cloud() checks the values.
/// \throw CloudRefused
CloudFile read_ply(const CloudSource& source);
CloudFile read_pcd(const CloudSource& source);
CloudFile read_xyz(const CloudSource& source);

}  // namespace umtet::detail
