#pragma once

#include <filesystem>
#include <optional>

#include "body/options.h"
#include "pipeline/case/json_values.h"
#include "pipeline/case/parameters.h"

namespace umtet {

/// What the parameters say to the library. Files and formulas of backgrounds and sizes are read when they are needed;
/// fits may take allowed_bytes().
/// The functions of the result throw UsageError for a formula or labels that are none, MeshFileRefused and
/// std::system_error.
BodyOptions body_options(const Parameters& parameters);

/// The mesh file that mesh.background names, if it is no tiling and not graded.
std::optional<std::filesystem::path> background_file(const Parameters& parameters);

/// As the functions of the same names for BodyOptions, which say more.
void require_walls(const Parameters& parameters);
void require_graded(const Parameters& parameters);
bool is_graded(const Parameters& parameters);

/// The parameters that say how fine the mesh will be, as records keep them of stages that made nothing finer.
Json wanted_mesh(const Parameters& parameters);

}  // namespace umtet
