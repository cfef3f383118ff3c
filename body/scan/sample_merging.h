#pragma once

#include "body/scan/cloud_preparation.h"

namespace umtet {

/// Merges samples in cells (merged_samples.h) and calls prepare_cloud() for the result. It merges only if cells contain
/// at least two samples on average and there are at least 100,000 cells. Because it merges before the search for
/// neighbours and normals, their cost is proportional to the number of cells.
///
/// The size of a cell is largest_cell(). If more than 1 % of the cells contain two sheets, or 1 % of the samples face
/// another sheet within 3.5 cells, the size is cell_where_thin(), and samples near sheets that are still closer are not
/// merged. Without normals, two sheets in a cell cannot be distinguished. Cells then are smaller, with eight samples on
/// average, and no sample of a thin body is merged.
/// \throw as prepare_cloud()
PreparedCloud prepare_merged(CloudFile file, const std::string& name, const BodyOptions& options);

}  // namespace umtet
