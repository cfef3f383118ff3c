#pragma once

#include "pipeline/reports/certificate_report.h"
#include "pipeline/stages/stages.h"

namespace umtet {

/// Writes CASE/report.html: the certificate, the mesh to turn and cut, curves, times and parameters in one file that
/// needs no network. It names the certificate it was made from.
/// @param parameters   those that the stages were made with
/// @param certificate  as in certificate.json. \pre the stages it is about are done
/// @param handover     what there is in memory of mesh and domain is not read
/// \throw ArtefactDamaged, Interrupted, std::system_error
void write_report(const CasePaths& paths, const Parameters& parameters, const Certificate& certificate,
                  const Handover& handover = {});

/// True when CASE/report.html was made from this certificate and shows the patches of these parameters.
bool report_is_of(const CasePaths& paths, const Certificate& certificate, const Parameters& parameters);

/// `umtet report`: write_report() of a case as it is on disk.
/// \throw UsageError when there is no certificate; ArtefactDamaged, Interrupted, std::system_error
void report_case(const CasePaths& paths);

}  // namespace umtet
