#pragma once

#include "body/body.h"
#include "body/fidelity/mesh_measures.h"
#include "mesh/second_order/quadratic_tets.h"
#include "mesh/second_order/second_order_certificate.h"
#include "mesh/universal_mesh.h"

namespace umtet {

/// Returns the final mesh of a result with curved edges (MeshOptions::order = 2). Its mid-sides are rounded to the
/// values that a file stores.
/// \pre result.status == UmStatus::Success, and round_to_file(result) \throw Cancelled
SecondOrder curved_mesh(const Domain& domain, const UmResult& result, double h, const ClosestPointParams& params,
                        const Context& context = {});

/// Measures a mesh of second order. The report also contains the corrections that were made for positive Jacobians.
/// \throw Cancelled
SecondOrderReport measure_second_order(const Domain& domain, const UmResult& result, const SecondOrder& second,
                                       double h, const Context& context = {});

}  // namespace umtet
