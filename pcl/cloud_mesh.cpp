#include "pcl/umtet/cloud_mesh.h"

#include <fmt/format.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <exception>
#include <filesystem>

#include "body/scan/given_cloud.h"
#include "pipeline/case/exit_code.h"
#include "pipeline/case/option_words.h"
#include "pipeline/memory/jobs.h"
#include "pipeline/memory/mesh_object.h"
#include "pipeline/reports/certificate_json.h"
#include "reconstruct/solve/solve_error.h"

namespace umtet {
namespace {

std::vector<Vec3> vectors(const Coordinates& x) {
  std::vector<Vec3> out;
  out.reserve(x.size());
  for (const std::array<double, 3>& a : x) out.emplace_back(a[0], a[1], a[2]);
  return out;
}

Coordinates arrays(const std::vector<Vec3>& x, const Vec3& shift = Vec3::Zero()) {
  Coordinates out;
  out.reserve(x.size());
  for (const Vec3& v : x) out.push_back({v[0] + shift[0], v[1] + shift[1], v[2] + shift[2]});
  return out;
}

Parameters parameters_of(const CloudMeshOptions& options) {
  Parameters parameters;
  for (const auto& [key, text] : options.set) parameters.set(key, text, ParamSource::Set, "set");
  if (options.h != 0) parameters.set(keys::mesh::h, fmt::format("{}", options.h), ParamSource::Flag, "h");
  if (has_own_psi(parameters.mesh())) {
    throw UsageError("mesh.implicit and mesh.level_set are psi themselves: they go without a cloud");
  }
  return parameters;
}

Watch watch_of(const CloudMeshOptions& options) {
  return [&options](const char* step, double fraction) {
    if (step && options.progress && !options.progress(step, fraction)) throw Cancelled();
  };
}

CloudFile file_of(const ScannedCloud& cloud) {
  CloudFile file = given_cloud(
      {.points = vectors(cloud.points), .normals = vectors(cloud.normals), .origins = vectors(cloud.viewpoints)});
  file.report.n_points_dropped = cloud.n_not_finite;
  return file;
}

Coordinates boundary_normals(Domain& domain, const MeshAttempt& best) {
  domain.limit_detail(best.h);
  std::vector<Vec3> normals;
  for (const int i : best.result.submesh.positive_vertices) {
    Vec3 gradient;
    domain.psi().value(best.result.final[static_cast<std::size_t>(i)], gradient);
    normals.push_back(gradient.normalized());
  }
  return arrays(normals);
}

CloudMesh mesh_of(CloudFile file, const Parameters& parameters, const Watch& watch) {
  Reconstruction fitted = reconstruct(std::move(file), parameters, watch);
  Domain domain = domain_of(fitted, parse_box(parameters.mesh().box));
  MeshAttempt best = make_mesh(domain, parameters, watch);
  CloudMesh mesh;
  mesh.boundary_normals = boundary_normals(domain, best);
  const auto made = std::make_shared<const MeshObject>(mesh_object(std::move(domain), std::move(best), parameters));
  const Certificate& certificate = *made->certificate;
  mesh.points = arrays(made->result.final, made->domain.shift);
  mesh.tets = made->result.submesh.mesh.C;
  mesh.boundary = made->result.submesh.positive_faces;
  mesh.boundary_vertices = made->result.submesh.positive_vertices;
  mesh.samples = {arrays(fitted.cloud.points), arrays(fitted.cloud.normals), {}, 0};
  mesh.h = made->h;
  mesh.min_quality = certificate.measured.mesh.quality.min;
  mesh.is_valid = certificate.measured.is_valid;
  mesh.fits_psi = certificate.verdict.fits_psi;
  mesh.fits_input = certificate.verdict.fits_input;
  mesh.passes = certificate.verdict.passes();
  mesh.certificate = to_json(certificate).dump(2);
  for (const Message& notice : fitted.notices) mesh.notices.push_back(text_of(notice, as_key));
  for (const Message& notice : made->domain.notices) mesh.notices.push_back(text_of(notice, as_key));
  mesh.made = made;
  return mesh;
}

[[noreturn]] void fail(const std::exception& e, const Json& evidence) {
  throw CloudMeshError(e.what(), evidence.dump());
}

[[noreturn]] void fail(const ExplainedError& e, const Json& evidence) {
  throw CloudMeshError(text_of(e.message, as_key), evidence.dump());
}

/// The exception at hand as one that crosses the border: the types of the pipeline are not known there.
[[noreturn]] void throw_for_caller() {
  try {
    throw;
  } catch (const MeshingFailed& e) {
    fail(e, e.evidence);
  } catch (const MeshingImpossible& e) {
    fail(e, {{"status", "MeshingImpossible"}});
  } catch (const CloudRefused& e) {
    fail(e, {{"status", "CloudRefused"}});
  } catch (const SolveError& e) {
    fail(e, {{"status", "SolveError"}});
  } catch (const SolveTooLarge& e) {
    fail(e, {{"status", "SolveTooLarge"}});
  } catch (const ResourceLimit& e) {
    fail(e, {{"status", "ResourceLimit"}});
  } catch (const Cancelled& e) {
    fail(e, {{"status", "Cancelled"}});
  } catch (const UsageError& e) {
    throw std::invalid_argument(text_of(e.message, as_key));
  }
}

}  // namespace

CloudMesh mesh_cloud(const ScannedCloud& cloud, const CloudMeshOptions& options) try {
  const Parameters parameters = parameters_of(options);
  const Watch watch = watch_of(options);
  tbb::task_arena arena(options.threads > 0 ? options.threads : tbb::task_arena::automatic);
  return arena.execute([&] { return mesh_of(file_of(cloud), parameters, watch); });
} catch (...) {
  throw_for_caller();
}

void CloudMesh::save(const std::string& file) const { made->save(file); }

}  // namespace umtet
