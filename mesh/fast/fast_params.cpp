#include "mesh/fast/fast_params.h"

namespace umtet {

std::vector<std::string> problems(const FastParams& params) {
  std::vector<std::string> list;
  if (params.layers < 1) list.push_back("layers = " + std::to_string(params.layers) + ": must be >= 1");
  const auto add = [&](const char* name, const std::vector<std::string>& more) {
    for (const std::string& problem : more) list.push_back(std::string(name) + "." + problem);
  };
  if (!(params.update_margin >= 0)) {
    list.push_back("update_margin = " + std::to_string(params.update_margin) + ": must be >= 0");
  }
  add("classification", problems(params.classification));
  add("projection", problems(params.projection));
  add("smoothing", problems(params.smoothing));
  add("repair", problems(params.repair));
  return list;
}

}  // namespace umtet
