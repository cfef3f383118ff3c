#pragma once

#include "reconstruct/io/detail/cloud_source.h"

namespace umtet::detail {

/// What the beginning of a file is enough for: its header and, of binary files, counts against the size of the file; of
/// XYZ the rows that are there. Headers are shorter than this beginning.
/// \throw CloudRefused  as the reader would
void check_ply_head(const CloudSource& head);
void check_pcd_head(const CloudSource& head);
void check_xyz_head(const CloudSource& head);

/// Whether it is a table of numbers, whatever the extension of the file says.
bool is_xyz(const CloudSource& head);

/// Whether the points are stored as numbers one after the other, so that a block of them can be read at a time.
bool is_in_blocks_ply(const CloudSource& head);
bool is_in_blocks_pcd(const CloudSource& head);

/// One reader per format. They check the shape of the file; what the numbers are is checked by read_point_cloud.
/// \throw CloudRefused
CloudFile read_ply(const CloudSource& source);
CloudFile read_pcd(const CloudSource& source);
CloudFile read_xyz(const CloudSource& source);

}  // namespace umtet::detail
