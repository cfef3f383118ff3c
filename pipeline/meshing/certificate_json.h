#pragma once

#include <string>

#include "pipeline/case/case_folder.h"
#include "pipeline/case/parameters.h"
#include "pipeline/case/record.h"

namespace umtet {

/// What measure() returned with its gates and verdict: certificate.json but for its `run` block and its seal.
Json verdict_on(const Json& measured, const Parameters& parameters);

/// certificate.json: the measurements in the record of 3-mesh, the gates of output.*, the verdict with every reason,
/// and a `run` block with times. A function of the records and the parameters alone, so it can be made again at any
/// time. \pre the stage 3-mesh is done
Json certificate(const CasePaths& paths, const StageRecord& mesh, const Parameters& parameters);

/// Adds `gates`, `verdict` and the reason of a broken gate to what measure() returned.
void judge(Json& measured, const Parameters& parameters);

/// A few aligned lines for people: verdict, counts, quality, boundary, domain, cloud, time.
/// Takes a certificate, or the shorter document of a checked mesh.
std::string summary(const Json& certificate);

}  // namespace umtet
