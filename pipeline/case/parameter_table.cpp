#include "mesh/universal_mesh.h"
#include "pipeline/case/detail/param_field.h"
#include "pipeline/case/parameters.h"
#include "reconstruct/solve/fit_ssd.h"

namespace umtet {
namespace {

using detail::kAboveZero;

#ifdef UMTET_WITH_GSL
constexpr MaxMinSearch kDefaultMaxMin = MaxMinSearch::Exact;
#else
constexpr MaxMinSearch kDefaultMaxMin = MaxMinSearch::Golden;
#endif

constexpr double kHuge = 1e100;
constexpr std::int64_t kManyTets = 2'000'000;  // about a minute and 1 GB

/// The row of one field of a section.
/// @param row  has what the line of the parameter says
template <auto section, auto field>
ParamField row_of(const char* key, ParamField row) {
  row.key = key;
  row.get = [](const ParamField& self, const ParameterValues& values) -> ParamValue {
    const auto& value = values.*section.*field;
    if constexpr (std::is_enum_v<std::remove_cvref_t<decltype(value)>>) {
      return self.choices.at(static_cast<std::size_t>(value));
    } else {
      return value;
    }
  };
  row.put = [](const ParamField& self, const ParamValue& from, ParameterValues& values) {
    auto& value = values.*section.*field;
    using T = std::remove_cvref_t<decltype(value)>;
    if constexpr (std::is_enum_v<T>) {
      std::size_t k = 0;
      while (self.choices.at(k) != std::get<std::string>(from)) ++k;
      value = static_cast<T>(k);
    } else {
      value = std::get<T>(from);
    }
  };
  row.preset = row.get(row, ParameterValues());
  return row;
}

std::vector<ParamField> make_fields() {
  using V = ParameterValues;
  std::vector<ParamField> rows;
#define UMTET_CLOUD(type, name, preset, ...) \
  rows.push_back(row_of<&V::cloud, &CloudParameters::name>(keys::cloud::name, ParamField{__VA_ARGS__}));
#define UMTET_RECONSTRUCT(type, name, preset, ...) \
  rows.push_back(                                  \
      row_of<&V::reconstruct, &ReconstructParameters::name>(keys::reconstruct::name, ParamField{__VA_ARGS__}));
#define UMTET_MESH(type, name, preset, ...) \
  rows.push_back(row_of<&V::mesh, &MeshParameters::name>(keys::mesh::name, ParamField{__VA_ARGS__}));
#define UMTET_OUTPUT(type, name, preset, ...) \
  rows.push_back(row_of<&V::output, &OutputParameters::name>(keys::output::name, ParamField{__VA_ARGS__}));
#include "pipeline/case/parameters.def"
  return rows;
}

}  // namespace

ParameterValues::ParameterValues() {
  const SsdParams ssd;
  const UmParams um;
#define UMTET_PARAMETER(section, type, name, preset, ...) section.name = preset;
#include "pipeline/case/parameters.def"
}

const std::vector<ParamField>& params_fields() {
  static const std::vector<ParamField> fields = make_fields();
  return fields;
}

}  // namespace umtet
