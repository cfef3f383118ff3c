#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "body/fidelity/verdict.h"
#include "pipeline/case/case_folder.h"
#include "pipeline/case/parameters.h"
#include "pipeline/case/record.h"
#include "pipeline/case/version.h"

// What certificate.json, the record of 3-mesh and the answers of `umtet check` say about a mesh. Lengths in model units
// unless a name says otherwise; certificate_json.h writes and reads them.
namespace umtet {

/// The stage to blame for a mesh that fails, and what helps.
struct Blame {
  std::string stage;   ///< "input", "normals", "labels", "level set", "h", "max_tets", "mesh"
  std::string number;  ///< what was measured there, in words
  std::string remedy;  ///< what to try, with its flag
};

/// Times of all stages that made a mesh.
struct CertificateRun {
  std::vector<std::pair<std::string, double>> seconds;  ///< by section of the parameters, in the order of the stages
  std::optional<double> points_per_s;                   ///< of the fit; none for a formula
  std::optional<double> tets_per_s;                     ///< of the mesher
  double peak_memory_MB = 0;
  int threads = 0;
  std::string host, date;  ///< of the mesh
  std::string checksum;    ///< seal of the certificate
};

/// certificate.json: what is true of a mesh, and whether that will do. (What is measured of the tets alone is
/// MeshCertificate of mesh/certify/certificate.h.)
struct Certificate {
  std::string version = kVersion;    ///< of the program that made it
  std::optional<std::string> units;  ///< of lengths, for the reader
  MeshMeasures measured;
  std::optional<std::int64_t> n_tets_asked;
  Verdict verdict;
  std::optional<Blame> blame;         ///< none where it passes
  std::optional<CertificateRun> run;  ///< none for a mesh that never was in a case
};

/// What is true of a mesh from a file: a Certificate without the parts that a mesh alone does not have.
struct MeshCheck {
  std::string file;                  ///< as the user gave it
  std::optional<std::string> units;  ///< of lengths, for the reader
  MeshCertificate mesh;
  std::optional<SecondOrderReport> second_order;  ///< of tets with 10 nodes
  std::optional<SupportReport> support;           ///< by the samples of a case
  bool is_valid = true;
  std::optional<PlaceReport> places;  ///< none without a case to compare with
  Verdict verdict;
};

/// output.units; none where none were given.
std::optional<std::string> units_of(const Parameters& parameters);

/// What was measured with its gates and verdict; without `run`.
Certificate verdict_on(MeshMeasures measured, const Parameters& parameters);

/// Sealed, with times. A function of the records and the parameters alone, so it can be made again at any time.
/// \pre the stage 3-mesh is done \throw ArtefactDamaged  a record lacks something
Certificate certificate(const CasePaths& paths, const StageRecord& mesh, const Parameters& parameters);

}  // namespace umtet
