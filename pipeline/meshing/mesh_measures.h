#pragma once

#include <optional>
#include <string>

#include "mesh/universal_mesh.h"
#include "pipeline/domain/domain.h"
#include "pipeline/domain/too_thin.h"
#include "pipeline/domain/zero_set_choice.h"
#include "pipeline/reports/certificate_report.h"

namespace umtet {

/// What is true of the corners of a mesh, and what is wrong with it; not whether thin places are lost, nor how far off
/// psi = 0 it may be: ask below. \throw Cancelled
MeshMeasures measure(const Domain& domain, const UmResult& result, const ZeroSetChoice& pieces, double h,
                     const Context& context = {});

/// The distance asked for with mesh.max_deviation is a promise: a mesh that breaks it gets a reason.
/// @param asked  model units; 0: any will do
std::optional<std::string> deviation_reason(double asked, const MeshCertificate& mesh);

/// Body or gap that is thin for h may be missing from the mesh as a whole, without a trace in topology or normals: that
/// gets a reason too. \throw Cancelled
std::optional<std::string> lost_reason(const Domain& domain, const UmResult& result, const ThinPlaces& thin,
                                       const Context& context = {});

}  // namespace umtet
