#pragma once

#include "pipeline/reports/certificate_report.h"
#include "pipeline/stages/stages.h"

namespace umtet {

/// Writes CASE/report.html: the certificate, an interactive view of the mesh, curves, times and parameters in one file
/// that needs no network. It names the certificate from which it was made.
/// @param parameters   parameters with which the stages were made
/// @param certificate  content of certificate.json
/// \pre its stages are done
/// @param handover     mesh and domain in memory are not read again
/// \throw ArtefactDamaged, Interrupted, std::system_error
void write_report(const CasePaths& paths, const Parameters& parameters, const Certificate& certificate,
                  const Handover& handover = {});

/// Returns whether CASE/report.html was made from this certificate and shows the patches of these parameters.
bool report_is_of(const CasePaths& paths, const Certificate& certificate, const Parameters& parameters);

/// Writes the report of a case without a certificate: the stages that are done, the remains of a mesh that could not be
/// made, and the stage to blame. \throw ArtefactDamaged, Interrupted, std::system_error
void write_unfinished_report(const CasePaths& paths, const Parameters& parameters);

/// `umtet report`: calls write_report() for a case on disk, or write_unfinished_report().
/// \throw UsageError  the folder contains no stage of a case; ArtefactDamaged, Interrupted, std::system_error
void report_case(const CasePaths& paths);

}  // namespace umtet
