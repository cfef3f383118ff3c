#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "pipeline/case/json_values.h"
#include "pipeline/case/parameters.h"
#include "pipeline/case/progress.h"
#include "pipeline/output/run_prediction.h"

namespace umtet {

/// The body of a formula.
struct FormulaInspection {
  std::string formula;
  std::size_t n_pieces = 0;  ///< pieces of its boundary, counted at the edge length of the prediction
  double area = 0;           ///< area of its boundary on the same grid, model units
  /// The sharp edges, traced at that edge length; empty for a smooth body.
  struct Edges {
    std::size_t n_curves = 0, n_corners = 0;
    std::size_t n_patches = 0;  ///< smooth parts of the formula that bound the body
    std::size_t n_faults = 0;   ///< places where curves break off
    double length = 0;          ///< length of all curves, model units
    double min_angle_deg = 0, max_angle_deg = 0;
  };
  std::optional<Edges> edges;
  RunPrediction prediction;  ///< for `umtet mesh` with the same parameters
};

/// Inspects the formula mesh.implicit in mesh.box. Changes and writes nothing.
/// \throw ExpressionError, UsageError, MeshingImpossible, Interrupted
FormulaInspection inspect_formula(const Parameters& parameters, Progress& progress);

/// Returns the answer of `umtet inspect --json`.
Json to_json(const FormulaInspection& inspection);

/// Returns the inspection as text.
std::string inspection_text(const FormulaInspection& inspection);

}  // namespace umtet
