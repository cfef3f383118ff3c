#pragma once

#include <filesystem>
#include <optional>

#include "body/options.h"
#include "pipeline/case/json_values.h"
#include "pipeline/case/parameters.h"

namespace umtet {

/// Converts parameters to options of the library. Files and formulas of backgrounds and sizes are read when the library
/// calls the functions of the result; fits may use allowed_bytes().
/// The functions of the result throw UsageError for an invalid formula or invalid labels, MeshFileRefused and
/// std::system_error.
BodyOptions body_options(const Parameters& parameters);

/// Returns the mesh file that mesh.background names; nothing if it is a tiling or graded.
std::optional<std::filesystem::path> background_file(const Parameters& parameters);

/// Equivalent to the functions of the same names for BodyOptions, which are documented there.
void require_walls(const Parameters& parameters);
void require_graded(const Parameters& parameters);
bool is_graded(const Parameters& parameters);

/// Returns the parameters that determine the resolution of the mesh. Stages store them in their records if they left
/// out detail that this mesh cannot show.
Json wanted_mesh(const Parameters& parameters);

}  // namespace umtet
