// One mesh of a known shape by this project's mesher on one thread, with its certificate, as a process to be timed
// beside other meshers; its numbers as one JSON document.
// peer_umtet SHAPE TETS fast|crawl|paper MESH.msh [SKIN]
// crawl: fast, with omega_h found from a point of the surface on; SKIN: the boundary, as SKIN.off and SKIN.msh, for
// other meshers

#include <oneapi/tbb/global_control.h>

#include <cstdio>
#include <cstring>
#include <ctime>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>

#include "mesh/certify/boundary_surface.h"
#include "mesh/certify/certificate.h"
#include "mesh/io/solver_files.h"
#include "mesh/sizes/body_size.h"
#include "mesh/universal_mesh.h"
#include "tests/support/bench_domains.h"

using namespace umtet;

namespace {

double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Not getrusage(): its peak begins with the size of the process that started this one.
double peak_MB() {
  std::ifstream status("/proc/self/status");
  for (std::string word; status >> word;) {
    double kB;
    if (word == "VmHWM:" && status >> kB) return kB / 1024;
  }
  return 0;
}

/// One entity per piece in SKIN.msh: Gmsh makes a volume of each.
void write_boundary_surface(const std::string& stem, const TetMesh& mesh, const std::vector<Triangle>& skin) {
  const SurfaceTopology topology = surface_topology(mesh.V, skin);
  std::vector<std::size_t> number(mesh.V.size());
  std::ofstream off(stem + ".off"), msh(stem + ".msh");
  off.precision(17);
  msh.precision(17);
  off << "OFF\n" << topology.vertices.size() << ' ' << skin.size() << " 0\n";
  msh << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n" << topology.vertices.size() << '\n';
  for (std::size_t k = 0; k < topology.vertices.size(); ++k) {
    const Vec3& x = mesh.V[static_cast<std::size_t>(topology.vertices[k])];
    number[static_cast<std::size_t>(topology.vertices[k])] = k;
    off << x.x() << ' ' << x.y() << ' ' << x.z() << '\n';
    msh << k + 1 << ' ' << x.x() << ' ' << x.y() << ' ' << x.z() << '\n';
  }
  msh << "$EndNodes\n$Elements\n" << skin.size() << '\n';
  for (std::size_t f = 0; f < skin.size(); ++f) {
    const int piece = topology.component[f] + 1;
    off << 3;
    msh << f + 1 << " 2 2 0 " << piece;
    for (const int i : skin[f]) {
      off << ' ' << number[static_cast<std::size_t>(i)];
      msh << ' ' << number[static_cast<std::size_t>(i)] + 1;
    }
    off << '\n';
    msh << '\n';
  }
  msh << "$EndElements\n";
  if (!off.flush() || !msh.flush()) throw std::runtime_error(stem + ": the skin could not be written");
}

int run(int argc, char** argv) {
  if (argc < 5 || argc > 6) throw std::invalid_argument("peer_umtet SHAPE TETS fast|crawl|paper MESH.msh [SKIN]");
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const testing::AnalyticDomain domain = testing::domain_by_name(argv[1]);
  UmParams params;
  params.mode = std::strcmp(argv[3], "paper") == 0 ? UmMode::Paper : UmMode::Fast;
  if (std::strcmp(argv[3], "crawl") == 0) params.submesh.search = SubmeshSearch::Crawl;
  const double peak_before = peak_MB(), start = cpu_seconds();
  const ClassificationSource source =
      params.mode == UmMode::Fast ? ClassificationSource::Chosen : ClassificationSource::Psi;
  const double h = h_for_tets(domain, domain.box, std::stod(argv[2]), source);
  UmResult result = universal_mesh(BackgroundMesh(a15(), domain.box, h), domain, params, {}, domain.boundary_seeds);
  const double meshed = cpu_seconds(), peak_meshed = peak_MB();
  if (result.status != UmStatus::Success) throw std::runtime_error(result.evidence.what);

  const TetMesh mesh{std::move(result.final), std::move(result.submesh.mesh.C)};
  CertificateInput input;
  input.mesh = &mesh;
  input.h = h;
  input.positive_faces = &result.submesh.positive_faces;
  input.psi = ImplicitFunctionRef(domain);
  const MeshCertificate certificate = certify(input);
  const double certified = cpu_seconds(), peak_certified = peak_MB();

  const std::vector<Triangle>& skin = result.submesh.positive_faces;  // the certificate compares it with the boundary
  write_msh41(argv[4], solver_mesh(mesh), MshEncoding::Binary);
  if (argc == 6) write_boundary_surface(argv[5], mesh, skin);
  const nlohmann::ordered_json numbers = {{"h", h},
                                          {"tets", mesh.C.size()},
                                          {"positive_faces", result.submesh.positive_faces.size()},
                                          {"volume", certificate.volume},
                                          {"least_Q", certificate.quality.min},
                                          {"genus", certificate.boundary.genus},
                                          {"pieces", certificate.boundary.components},
                                          {"failures", failures(certificate)},
                                          {"mesh_s", meshed - start},
                                          {"certificate_s", certified - meshed},
                                          {"write_s", cpu_seconds() - certified},
                                          {"mesh_MB", peak_meshed - peak_before},
                                          {"certified_MB", peak_certified - peak_before},
                                          {"all_MB", peak_MB()}};
  std::cout << numbers.dump() << '\n';
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::exception& e) {
    std::cerr << e.what() << '\n';
    return 1;
  }
}
