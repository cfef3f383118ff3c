#include "pipeline/meshing/sample_fields.h"

#include "body/pieces/zero_set_choice.h"
#include "common/polled_loops.h"
#include "pipeline/case/interrupt.h"
#include "reconstruct/cloud/transfer/field_transfer.h"

namespace umtet {
namespace {

/// Stores one value for each of `vertices` in an array of n values.
template <class Value>
void put(const std::vector<Value>& values, const std::vector<int>& vertices, std::size_t n, const Value& none,
         FieldValues& any) {
  if (!std::holds_alternative<std::vector<Value>>(any)) any = std::vector<Value>();
  auto& all = std::get<std::vector<Value>>(any);
  all.resize(n, none);
  for (std::size_t k = 0; k < vertices.size(); ++k) all[vertices[k]] = values[k];
}

}  // namespace

bool is_of_scan(std::string_view name) { return name.starts_with(kScanPrefix); }

void set_sample_fields(const Domain& domain, const std::vector<Vec3>& V, const std::vector<int>& vertices,
                       std::map<std::string, FieldValues>& point_data) {
  const OrientedPointCloud& cloud = domain.cloud;
  const double reach = support_radius(domain);
  if ((cloud.fields.empty() && cloud.colours.empty()) || !(reach > 0)) return;
  std::vector<Vec3> places(vertices.size()), normals(vertices.size());
  const ImplicitFunctionRef psi = domain.body();  // even if the fluid is meshed: samples face out of the body
  polled_parallel_for(vertices.size(), kValuesPerPoll, until_interrupted(), [&](std::size_t k) {
    places[k] = V[vertices[k]];
    psi.value(places[k], normals[k]);
  });
  const SurfaceFields found = fields_at(cloud, places, normals, reach, until_interrupted());
  const auto array = [&](const std::string& name) -> FieldValues& {
    return point_data[std::string(kScanPrefix) + name];
  };
  for (const SampleField& field : found.fields) put(field.values, vertices, V.size(), kNoSample, array(field.name));
  if (!found.colours.empty()) {
    put<Vec3>(found.colours, vertices, V.size(), Vec3::Constant(kNoSample), point_data[kScanColours]);
  }
}

}  // namespace umtet
