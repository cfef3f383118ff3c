#pragma once

#include <filesystem>

#include "mesh/certify/quadratic_tets.h"
#include "mesh/certify/second_order_certificate.h"
#include "mesh/io/tet_mesh_io.h"
#include "mesh/universal_mesh.h"
#include "body/body.h"
#include "pipeline/reports/certificate_report.h"

namespace umtet {

/// The final mesh of a result with curved edges (mesh.order = 2), its mid-sides where a file will hold them.
/// \pre result.status == UmStatus::Success, and round_to_file(result) \throw Cancelled
SecondOrder curved_mesh(const Domain& domain, const UmResult& result, double h, const ClosestPointParams& params,
                        const Context& context = {});

/// What is true of it, with what had to be done for the Jacobians. \throw Cancelled
SecondOrderReport measure_second_order(const Domain& domain, const UmResult& result, const SecondOrder& second,
                                       double h, const Context& context = {});

/// As write_mesh() of the final mesh, with tets of 10 nodes; mid-sides have no vertex of the background (-1).
/// @param corners  final_content() of the result
/// \throw Cancelled, std::system_error naming the file
void write_second_order(const std::filesystem::path& file, const Domain& domain, const UmResult& result,
                        const MeshFile& corners, const SecondOrder& second);

}  // namespace umtet
