#include "pipeline/case/option_words.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "pipeline/case/parameters.h"

namespace umtet {
namespace {

const ParamField& field_of(const Option& option) {
  const std::string key = key_of(option);
  const auto& fields = params_fields();
  return *std::find_if(fields.begin(), fields.end(), [&](const ParamField& f) { return f.key == key; });
}

std::string with_value(const std::string& name, const char* separator, const std::string& value) {
  return value.empty() ? name : name + separator + value;
}

}  // namespace

std::string key_of(const Option& option) {
  // Options whose name or section differs from the parameter's.
  static const std::array<std::pair<std::string_view, const char*>, 9> kOthers = {
      {{"columns", keys::cloud::columns},
       {"viewpoints", keys::cloud::orient_from},
       {"triangles.spacing", keys::cloud::sample_spacing},
       {"detail", keys::reconstruct::detail},
       {"sizes", keys::mesh::size},
       {"label_sizes", keys::mesh::size_at},
       {"box", keys::mesh::box},
       {"verdict.accept", keys::output::accept},
       {"max_memory", keys::output::max_memory}}};
  const std::string_view name = option.name;
  std::string key(name);
  if (name.starts_with("scan.")) key = "cloud." + key.substr(std::string_view("scan.").size());
  if (name.starts_with("fit.")) key = "reconstruct." + key.substr(std::string_view("fit.").size());
  for (const auto& [other, its_key] : kOthers)
    if (name == other) key = its_key;
  const auto& fields = params_fields();
  if (std::none_of(fields.begin(), fields.end(), [&](const ParamField& f) { return f.key == key; }))
    throw std::out_of_range("no parameter is the option " + std::string(name));
  return key;
}

std::string as_flag(const Setting& setting) {
  const ParamField& field = field_of(setting.option);
  if (!field.flag.empty()) return with_value(field.flag, " ", setting.value);
  return "--set " + with_value(field.key, "=", setting.value);
}

std::string as_key(const Setting& setting) { return with_value(key_of(setting.option), "=", setting.value); }

std::string as_keyword(const Setting& setting) {
  const std::string key = key_of(setting.option);
  return with_value(key.substr(key.find('.') + 1), "=", setting.value);
}

}  // namespace umtet
