#pragma once

#include "body/body.h"
#include "body/fidelity/mesh_measures.h"
#include "mesh/second_order/quadratic_tets.h"
#include "mesh/second_order/second_order_certificate.h"
#include "mesh/universal_mesh.h"

namespace umtet {

/// The final mesh of a result with curved edges (MeshOptions::order = 2), its mid-sides where a file will hold them.
/// \pre result.status == UmStatus::Success, and round_to_file(result) \throw Cancelled
SecondOrder curved_mesh(const Domain& domain, const UmResult& result, double h, const ClosestPointParams& params,
                        const Context& context = {});

/// What is true of it, with what had to be done for the Jacobians. \throw Cancelled
SecondOrderReport measure_second_order(const Domain& domain, const UmResult& result, const SecondOrder& second,
                                       double h, const Context& context = {});

}  // namespace umtet
