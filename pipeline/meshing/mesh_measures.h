#pragma once

#include "mesh/certify/certificate.h"
#include "mesh/universal_mesh.h"
#include "pipeline/case/record.h"
#include "pipeline/meshing/domain.h"
#include "pipeline/meshing/too_thin.h"
#include "pipeline/meshing/zero_set_choice.h"

namespace umtet {

/// The fields of the certificate that are measured, in its order: n_points ... resolution, then `reasons`, the list of
/// what is wrong with the mesh. Fields that this input does not have are null. \throw Cancelled
Json measure(const Domain& domain, const UmResult& result, const ZeroSetChoice& pieces, double h,
             const Context& context = {});

/// The distance asked for with mesh.max_deviation is a promise: a mesh that breaks it gets a reason. 0: any will do.
void check_deviation(double asked, Json& measured);

/// Body or gap that is thin for h may be missing from the mesh as a whole, without a trace in topology or normals: that
/// gets a reason too. Puts the thin places into `resolution`. \throw Cancelled
void check_lost(const Domain& domain, const UmResult& result, const ThinPlaces& thin, Json& measured,
                const Context& context = {});

/// Of a measured mesh: right but for the size of its faces (kMostGap). It is kept to be looked at, thin places or not,
/// and the certificate says no.
bool is_only_coarse(const Json& measured);

/// The blocks `quality` and `boundary` and the counts before them.
Json to_json(const MeshCertificate& certificate);

}  // namespace umtet
