#include "pipeline/domain/body_options.h"

#include <fmt/format.h>

#include <memory>
#include <stdexcept>
#include <utility>

#include "body/errors.h"
#include "body/option_names.h"
#include "body/sizing/background_choice.h"
#include "body/sizing/graded_sizes.h"
#include "mesh/expression/expression.h"
#include "mesh/io/size_file.h"
#include "mesh/io/tet_mesh_io.h"
#include "pipeline/case/label_names.h"
#include "pipeline/case/memory.h"
#include "reconstruct/io/viewpoint_file.h"

namespace umtet {
namespace fs = std::filesystem;
namespace {

BackgroundMesh read_background(const fs::path& file, const Vec3& shift) {
  TetMesh mesh = read_tet_mesh(file).mesh;
  for (Vec3& x : mesh.V) x -= shift;
  try {
    return BackgroundMesh(std::move(mesh));
  } catch (const std::invalid_argument& e) {
    throw MeshFileRefused(file, "as a background mesh", e.what());
  }
}

/// @param size  mesh.size
GivenSizes given_sizes(const std::string& size) {
  GivenSizes given{.name = size};
  if (is_size_file(size)) {
    given.sources = read_sizes(size);
    return given;
  }
  try {
    const auto formula = std::make_shared<const Expression>(size);
    given.function = [formula](const Vec3& x) { return formula->value(x); };
  } catch (const ExpressionError& e) {
    throw UsageError({option::sizes, std::string(" is neither a .vtu, .csv, .xyz or .txt file nor a formula of x, y "
                                                 "and z: ") +
                                         e.what()});
  }
  return given;
}

}  // namespace

BodyOptions body_options(const Parameters& parameters) {
  BodyOptions options{.scan = parameters.cloud(), .fit = parameters.reconstruct(), .mesh = parameters.mesh()};
  if (parameters.reconstruct().keep_open) options.fit.close = Closing::None;
  options.background = [file = fs::path(parameters.mesh().background)](const Vec3& shift) {
    return read_background(file, shift);
  };
  if (const std::string& size = parameters.mesh().size; !size.empty()) {
    options.sizes = [size] { return given_sizes(size); };
  }
  if (const std::string& sizes = parameters.mesh().size_at; !sizes.empty()) {
    options.label_sizes = [sizes, names = parameters.output().label_names] {
      return LabelSizes{parse_label_sizes(sizes, parse_label_names(names)), sizes};
    };
  }
  if (const std::string& file = parameters.cloud().orient_from; !file.empty()) {
    options.viewpoints = [file] { return read_viewpoints(file); };
  }
  options.grade_is_given = parameters.source(keys::mesh::grade) >= ParamSource::Set;
  options.max_turn_is_given = parameters.source(keys::mesh::max_turn) >= ParamSource::Set;
  options.max_memory = allowed_bytes(parameters);
  return options;
}

std::optional<fs::path> background_file(const Parameters& parameters) {
  if (!has_own_background(body_options(parameters))) return std::nullopt;
  return parameters.mesh().background;
}

void require_graded(const Parameters& parameters) { require_graded(body_options(parameters)); }

void require_walls(const Parameters& parameters) { require_walls(body_options(parameters)); }

bool is_graded(const Parameters& parameters) { return is_graded(body_options(parameters)); }

Json wanted_mesh(const Parameters& parameters) {
  const MeshParameters& mesh = parameters.mesh();
  return {{"h", mesh.h},
          {"tets", mesh.tets},
          {"max_tets", mesh.max_tets},
          {"max_deviation", mesh.max_deviation},
          {"background", mesh.background},
          {"size", mesh.size},
          {"size_at", mesh.size_at}};
}

}  // namespace umtet
