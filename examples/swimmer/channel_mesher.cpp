#include "examples/swimmer/channel_mesher.h"

#include <fmt/format.h>

#include <cmath>
#include <exception>
#include <stdexcept>

#include "mesh/background/a15_box.h"
#include "mesh/certify/certificate.h"
#include "mesh/universal_mesh.h"
#include "pipeline/case/exit_code.h"

namespace umtet {
namespace {

const Box kChannel(Vec3(-6, -6, -14.58), Vec3(6, 6, 14.58));

TetMesh channel(double n_tets) {
  if (!(n_tets > 0)) throw std::invalid_argument(fmt::format("n_tets = {}: must be > 0", n_tets));
  const double cell = std::cbrt(static_cast<double>(a15().tets.size()) * kChannel.volume() / n_tets);
  return a15_box(kChannel, cell * a15().mean_edge);
}

std::string why(const UmResult& result) {
  const Vec3& x = result.evidence.where;
  return fmt::format("{}: {} at {:.4g}, {:.4g}, {:.4g}, {} in total", to_string(result.status), result.evidence.what,
                     x.x(), x.y(), x.z(), result.evidence.count);
}

}  // namespace

ChannelMesher::ChannelMesher(double n_tets) : background_(channel(n_tets)) {
  for (std::int64_t t = 0; t < background_.n_tets(); ++t) {
    Tet tet;
    for (int k = 0; k < 4; ++k) tet[k] = static_cast<int>(background_.tet(t)[k]);
    tets_.push_back(tet);
  }
  for (int i = 0; i < n_vertices(); ++i) {
    const Vec3 x = background_.position(i);
    if (x.head<2>().cwiseAbs().maxCoeff() == 6 || x.z() == kChannel.min().z()) no_slip_.push_back(i);
  }
}

FluidMesh ChannelMesher::mesh(ImplicitFunctionRef fluid) const {
  UmParams params;
  params.submesh.background_boundary = BackgroundBoundary::Wall;
  const UmResult made = universal_mesh(background_, fluid, params);
  if (made.status != UmStatus::Success) throw MeshingImpossible(why(made));
  const Submesh& omega_h = made.submesh;
  const TetMesh mesh{made.final, omega_h.mesh.C};
  const MeshCertificate certificate = certify({.mesh = &mesh,
                                               .h = background_.h(),
                                               .positive_faces = &omega_h.positive_faces,
                                               .psi = fluid,
                                               .wall_faces = &made.walls,
                                               .background_V = &omega_h.mesh.V});
  for (const std::string& reason : failures(certificate)) {
    // The share of the body's volume that flat faces miss is not a failure here: it depends on --tets, and the table of
    // a stroke contains it (volume_gap).
    if (!reason.starts_with("volume_gap")) throw CertificateFailed(reason);
  }

  FluidMesh result{{}, {}, {}, no_slip_, certificate.boundary.gap_over_volume.value_or(0)};
  for (int i = 0; i < n_vertices(); ++i) result.V.push_back(background_.position(i));
  for (std::size_t i = 0; i < mesh.V.size(); ++i) result.V[omega_h.background_vertex[i]] = mesh.V[i];
  result.tets.assign(omega_h.background_tet.begin(), omega_h.background_tet.end());
  for (const int i : omega_h.positive_vertices) {
    result.swimmer.push_back(static_cast<int>(omega_h.background_vertex[i]));
  }
  return result;
}

FluidMesh ChannelMesher::operator()(const Swimmer& swimmer) const {
  const auto said = [&](const std::exception& error) {
    return fmt::format("swimmer of t = {:.6g} at z0 = {:.6g}: {}; more --tets resolve more of its shape",
                       swimmer.time(), swimmer.position(), error.what());
  };
  try {
    return mesh(Complement(swimmer));
  } catch (const MeshingImpossible& error) {
    throw MeshingImpossible(said(error));
  } catch (const CertificateFailed& error) {
    throw CertificateFailed(said(error));
  }
}

}  // namespace umtet
