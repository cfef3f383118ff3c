#include "pipeline/stages/given_normals.h"

#include <fmt/format.h>

#include "pipeline/case/record.h"
#include "pipeline/reports/stage_reports.h"

namespace umtet {
namespace {

// Share of normals that agree with their neighbours: noise and sharp edges alone do not bring it below this.
constexpr double kLeastAgreed = .9;

}  // namespace

std::string doubt_about_given_normals(const CasePaths& paths) {
  const StageState state = inspect_stage(paths, Stage::Cloud, Json::object(), std::nullopt);
  if (!state.record) return "";
  const NormalsReport normals = cloud_report(*state.record).normals;
  const double agreed = normals.consistency;
  if (!normals.given || agreed >= kLeastAgreed) return "";
  return fmt::format(
      "\n  as given, {:.1f} % of the normals agree with their neighbours, as where two sides of a body are nearer to "
      "each other than its samples: no level set tells such sides apart, more samples do",
      100 * agreed);
}

}  // namespace umtet
