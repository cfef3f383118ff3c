#pragma once

#include "pipeline/stages/cloud_preparation.h"

namespace umtet {

/// prepare_cloud() of the samples merged in cells (merged_samples.h), where at least four share a cell in the mean and
/// 100,000 cells are left: before neighbours and normals, so that all of it costs as much as there are cells.
///
/// Cells are those of largest_cell() where the file has normals, by which two sheets in a cell are told apart. Without
/// them, or where more than 1 % of the cells have two sheets or 1 % of the samples face another one within 3.5 cells,
/// smaller ones, that leave an eighth of the samples; and where that holds for these, too, samples stay what they are.
/// \throw as prepare_cloud()
PreparedCloud prepare_merged(CloudFile file, const std::filesystem::path& source, const Parameters& parameters);

}  // namespace umtet
