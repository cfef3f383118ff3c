#include <string>
#include <vector>

#include "mesh/fast/repair/repair.h"

namespace umtet {

std::vector<std::string> problems(const RepairParams& params) {
  std::vector<std::string> list;
  const auto add = [&](const char* name, const std::string& value, const char* range) {
    list.push_back(std::string(name) + " = " + value + ": must be " + range);
  };
  if (!(params.target > 0 && params.target < 1)) add("target", std::to_string(params.target), "in (0, 1)");
  if (params.reach < 1) add("reach", std::to_string(params.reach), ">= 1");
  if (!(params.lift >= 0)) add("lift", std::to_string(params.lift), ">= 0");
  if (params.target_step != 0 && !(params.target_step >= .001 && params.target_step <= params.target))
    add("target_step", std::to_string(params.target_step), "0, or at least .001 and at most target");
  if (params.max_tries < 0) add("max_tries", std::to_string(params.max_tries), ">= 0");
  for (const std::string& problem : problems(params.projection)) list.push_back("projection." + problem);
  for (const std::string& problem : problems(params.smoothing)) list.push_back("smoothing." + problem);
  return list;
}

}  // namespace umtet
