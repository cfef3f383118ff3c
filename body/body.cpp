#include "body/body.h"

#include <algorithm>
#include <utility>

#include "pipeline/case/exit_code.h"
#include "body/fitted_domain.h"
#include "pipeline/domain/handover.h"
#include "body/label_volume.h"
#include "body/sizing/wanted_detail.h"
#include "body/scan/input_facts.h"
#include "pipeline/reports/stage_reports.h"
#include "reconstruct/io/level_set_io.h"
#include "reconstruct/io/point_cloud_io.h"
#include "reconstruct/io/triangle_mesh_io.h"

namespace umtet {

// Here the two libraries meet: neither includes the other.
static_assert(JointlyEvaluated<LevelSet>);
static_assert(JointlyEvaluated<LevelSetApart>);
static_assert(JointlyEvaluated<GridLevelSet>);
static_assert(JointlyEvaluated<Domain>);
static_assert(JointlyEvaluated<Expression>);

namespace {

/// The file of a case has the same bits.
LevelSet level_set_of(const std::filesystem::path& file) {
  try {
    return read_level_set(file);
  } catch (const LevelSetRefused& e) {  // the file is ours: what is wrong with it is damage
    throw ArtefactDamaged(e.what());
  }
}

/// psi and a constant, which is in the span of max-ent functions: they sum to one.
LevelSet raised(const LevelSet& psi, double by) {
  LevelSetLevel coarsest = psi.coarsest();
  for (double& c : coarsest.coefficients) c += by;
  std::vector<LevelSetBand> bands;
  for (int level = 1; level < psi.n_levels(); ++level) bands.push_back(psi.band(level));
  return {psi.prior(), std::move(coarsest), std::move(bands)};
}

/// Of the mesh that the case has.
double level_shift_of(const CasePaths& paths) {
  const StageState state = inspect_stage(paths, Stage::Mesh, Json::object(), std::nullopt);
  return state.record ? mesh_report(*state.record).measured.domain.level_shift : 0;
}

bool is_of_triangles(const CasePaths& paths, const StageRecord& cloud) {
  const std::vector<RecordedFile>& outputs = cloud.outputs;
  const std::string name = paths.triangles().filename().string();
  return std::any_of(outputs.begin(), outputs.end(), [&](const RecordedFile& f) { return f.name == name; });
}

}  // namespace

Domain formula_domain(const Parameters& parameters, std::optional<double> t) {
  const std::optional<Box> box = parse_box(parameters.mesh().box);
  if (!box) throw UsageError("--implicit needs --box x0,y0,z0,x1,y1,z1");
  Domain domain;
  domain.formula.emplace(parameters.mesh().implicit, t);
  domain.box = *box;
  domain.diagonal = box->diagonal().norm();
  domain.complement = parameters.mesh().complement;
  return domain;
}

void Domain::limit_detail(double h) {
  if (!fitted) return;
  level_set = fitted->band_limited(kLeastSpacing * h);
  if (level_shift != 0) level_set = raised(*level_set, -level_shift);
}

void Domain::shift_level(double by, double h) {
  level_shift = by;
  limit_detail(h);
}

const BodySize& Domain::size() const {
  // Of triangles these are exact, and thinner than any grid if need be.
  if (triangles && triangles->body.is_closed && !complement && !size_)
    size_.emplace(box, BodySize{triangles->body.volume, triangles->body.area});
  if (triangles && triangles->body.is_closed && !complement) return size_->second;
  const bool known = size_ && size_->first.min() == box.min() && size_->first.max() == box.max();
  if (known) return size_->second;
  // Thin parts of a segmentation fall between the places of an estimate.
  const auto measured = [&](ImplicitFunctionRef psi) {
    return labels && !complement ? BodySize{labels->report.volume_of_psi, labels->area}
                                 : body_size(psi, box, steepest());
  };
  size_.emplace(box, with_psi_apart(measured));
  return size_->second;
}

double Domain::evaluate(const Vec3& x, Vec3* gradient, Mat3* hessian) const {
  const ImplicitFunctionRef f = body();
  Vec3 g;
  Mat3 H;
  const double sign = complement ? -1 : 1;
  const double value = hessian ? f.value(x, g, H) : gradient ? f.value(x, g) : f.value(x);
  if (gradient) *gradient = sign * g;
  if (hessian) *hessian = sign * H;
  return sign * value;
}

void Domain::values(std::span<const Vec3> x, double* out) const {
  body().values(x, out);
  for (std::size_t i = 0; complement && i < x.size(); ++i) out[i] = -out[i];
}

ImplicitFunctionRef Domain::psi() const { return complement ? ImplicitFunctionRef(*this) : body(); }

Domain load_domain(const CasePaths& paths, const Parameters& parameters, Handover* handover) {
  if (!parameters.mesh().level_set.empty()) return grid_domain(parameters);
  if (!parameters.mesh().implicit.empty()) return formula_domain(parameters);
  const StageState state = inspect_stage(paths, Stage::LevelSet, parameters.section("reconstruct"), std::nullopt);
  if (!state.record) throw ArtefactDamaged(state.reason);
  Domain domain;
  try {
    LevelSet psi = handover && handover->psi ? std::move(*std::exchange(handover->psi, std::nullopt))
                                             : level_set_of(paths.level_set());
    OrientedPointCloud cloud = handover && handover->cloud ? std::move(*std::exchange(handover->cloud, std::nullopt))
                                                           : read_point_cloud(paths.cloud()).cloud;
    const LevelSetReport report = level_set_report(*state.record);
    domain = fitted_domain(std::move(psi), std::move(cloud), report, parse_box(parameters.mesh().box));
    const StageState cloud_state = inspect_stage(paths, Stage::Cloud, Json::object(), std::nullopt);
    if (cloud_state.record) domain.facts = input_facts(cloud_report(*cloud_state.record), report);
    domain.fitted = FittedLevelSet(*domain.level_set, [file = paths.level_set()] { return level_set_of(file); });
    if (handover && handover->triangles) {
      domain.triangles = given_triangles(std::move(*std::exchange(handover->triangles, std::nullopt)), domain.shift);
    } else if (cloud_state.record && is_of_triangles(paths, *cloud_state.record)) {
      domain.triangles = given_triangles(read_triangles(paths.triangles()).mesh, domain.shift);
    }
    if (domain.triangles) domain.level_shift = level_shift_of(paths);
  } catch (const CloudRefused& e) {  // all files are ours: what is wrong with them is damage
    throw ArtefactDamaged(e.what());
  }
  domain.complement = parameters.mesh().complement;
  return domain;
}

}  // namespace umtet
