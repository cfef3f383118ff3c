#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "body/fidelity/verdict.h"
#include "mesh/io/file_regions.h"
#include "mesh/regions/region_certificate.h"
#include "pipeline/case/case_folder.h"
#include "pipeline/case/parameters.h"
#include "pipeline/case/record.h"
#include "pipeline/case/version.h"

// The contents of certificate.json, of the record of 3-mesh and of the answers of `umtet check`. Lengths are in model
// units unless a name says otherwise; certificate_json.h writes and reads them.
namespace umtet {

/// The stage that causes a mesh to fail, and a remedy.
struct Blame {
  std::string stage;   ///< "input", "normals", "labels", "level set", "h", "max_tets", "mesh"
  std::string number;  ///< the measurement that shows the cause, in words
  std::string remedy;  ///< suggested remedy, with its flag
};

/// Times of all stages that made the mesh.
struct CertificateRun {
  /// Seconds of each section of the parameters, in the order of the stages.
  std::vector<std::pair<std::string, double>> seconds;
  std::optional<double> points_per_s;  ///< points per second of the fit; none for a formula
  std::optional<double> tets_per_s;    ///< tets per second of the mesher
  double peak_memory_MB = 0;
  int threads = 0;
  std::string host, date;  ///< host and date of the mesh
  std::string checksum;    ///< seal of the certificate
};

/// The contents of certificate.json: measurements of a mesh, and the verdict. (MeshCertificate of
/// mesh/certify/certificate.h contains the measurements of the tets alone.)
struct Certificate {
  std::string version = kVersion;    ///< version of the program that made the certificate
  std::optional<std::string> units;  ///< unit of lengths, for the reader
  MeshMeasures measured;
  std::optional<std::int64_t> n_tets_asked;
  Verdict verdict;
  std::optional<Blame> blame;         ///< none if the verdict is pass
  std::optional<CertificateRun> run;  ///< none for a mesh that was never in a case
};

/// The regions of a mesh from a file.
struct RegionCheck {
  FileRegions file;               ///< the marks of the tets
  RegionCertificate certificate;  ///< by region; not compared with sheets
};

/// Measurements and verdict of a mesh from a file: a Certificate without the parts that need more than the mesh.
struct MeshCheck {
  std::string file;                  ///< path as given by the user
  std::optional<std::string> units;  ///< unit of lengths, for the reader
  MeshCertificate mesh;
  std::optional<SecondOrderReport> second_order;  ///< set for tets with 10 nodes
  std::optional<RegionCheck> regions;             ///< set for tets of several regions, without a case
  std::optional<SupportReport> support;           ///< set if the case has samples
  bool is_valid = true;
  std::optional<DefectReport> defects;  ///< defects; none without a case to compare with
  Verdict verdict;
};

/// Returns output.units; none if it is empty.
std::optional<std::string> units_of(const Parameters& parameters);

/// Returns the measurements with their gates and verdict, without `run`.
Certificate verdict_on(MeshMeasures measured, const Parameters& parameters);

/// Returns the sealed certificate with times. It depends only on the records and the parameters, so it can be made
/// again at any time.
/// \pre the stage 3-mesh is done \throw ArtefactDamaged  a value is missing in a record
Certificate certificate(const CasePaths& paths, const StageRecord& mesh, const Parameters& parameters);

}  // namespace umtet
