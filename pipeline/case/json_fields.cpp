#include "pipeline/case/json_fields.h"

#include <algorithm>

#include "pipeline/case/exit_code.h"

namespace umtet {

std::size_t JsonFields::word_at(const char* name, std::size_t at, const char* const* words, std::size_t n) {
  if (!read_) {
    (*written_)[name] = words[at];
    return at;
  }
  const auto word = read_->at(name).get<std::string>();
  at = static_cast<std::size_t>(std::find(words, words + n, word) - words);
  if (at == n) throw ArtefactDamaged("'" + word + "' is not a value of '" + name + "'");
  return at;
}

}  // namespace umtet
