#include "pipeline/memory/without_flags.h"

#include <algorithm>

namespace umtet {

std::string without_flags(std::string message, const std::function<std::string(const ParamField&)>& name) {
  for (std::size_t at = 0; (at = message.find("--", at)) != std::string::npos;) {
    const std::size_t end = message.find_first_not_of("abcdefghijklmnopqrstuvwxyz-", at);
    const std::string flag = message.substr(at, end - at);
    const auto& fields = params_fields();
    const auto field = std::find_if(fields.begin(), fields.end(), [&](const ParamField& f) { return f.flag == flag; });
    if (field != fields.end()) message.replace(at, flag.size(), name(*field));
    at += 2;
  }
  return message;
}

}  // namespace umtet
