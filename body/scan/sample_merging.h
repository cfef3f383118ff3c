#pragma once

#include "body/scan/cloud_preparation.h"

namespace umtet {

/// prepare_cloud() of the samples merged in cells (merged_samples.h), where at least two share a cell in the mean and
/// 100,000 cells are left: before neighbours and normals, so that all of it costs as much as there are cells.
///
/// Cells are those of largest_cell(). Where more than 1 % of them have two sheets or 1 % of the samples face another
/// one within 3.5 cells, they are those of cell_where_thin(), and samples stay what they are near the sheets that are
/// still closer. Without normals, by which two sheets in a cell are told apart, cells are smaller, eight samples in the
/// mean, and all samples of a thin body stay.
/// \throw as prepare_cloud()
PreparedCloud prepare_merged(CloudFile file, const std::string& name, const BodyOptions& options);

}  // namespace umtet
