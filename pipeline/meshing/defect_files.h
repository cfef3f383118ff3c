#pragma once

#include <filesystem>
#include <vector>

#include "body/fidelity/mesh_defect.h"
#include "body/scan/cloud_preparation.h"
#include "body/sizing/too_thin.h"

namespace umtet {

/// Writes one point per defect, with `kind` (the number of its DefectKind), `off_over_h`, `size_over_h`,
/// `feature_over_h` (0: none), `small` (0/1) and `n`, atomically. \throw std::system_error  names the file
void write_defects(const std::filesystem::path& file, const std::vector<MeshDefect>& defects);

/// The file in 1-cloud of the samples that the preparation marked; it exists only if there are any.
inline constexpr const char* kMarkedFile = "marked.vtp";
/// Writes one point per mark, with `mark`, the number of its SampleMark, atomically.
/// \throw std::system_error  names the file
void write_marked(const std::filesystem::path& file, const std::vector<MarkedSample>& marked);
/// Reads this file. \throw ArtefactDamaged, std::system_error
std::vector<MarkedSample> read_marked(const std::filesystem::path& file);

/// Writes the points with `thickness`, `h_needed`, `place` and `gap` (0/1), in model coordinates, atomically.
/// \throw std::system_error  names the file
void write_thin_places(const std::filesystem::path& file, const ThinPlaces&, const Vec3& shift);

}  // namespace umtet
