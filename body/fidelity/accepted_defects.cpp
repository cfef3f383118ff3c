#include "body/fidelity/accepted_defects.h"

#include <algorithm>
#include <charconv>
#include <sstream>

#include "body/errors.h"
#include "body/fidelity/input_judgement.h"
#include "body/fidelity/mesh_defect.h"
#include "body/option_names.h"
#include "common/formatted.h"

namespace umtet {
namespace {

std::vector<std::string> kinds() {
  std::vector<std::string> words;
  for (int k = 0; k <= static_cast<int>(DefectKind::Missed); ++k)
    words.emplace_back(to_string(static_cast<DefectKind>(k)));
  for (int k = 0; k <= static_cast<int>(InputDefectKind::Voxels); ++k) {
    const std::string word = to_string(static_cast<InputDefectKind>(k));
    if (std::find(words.begin(), words.end(), word) == words.end()) words.push_back(word);
  }
  return words;
}

}  // namespace

std::vector<AcceptedDefects> parse_accepted_defects(const std::string& text) {
  const std::vector<std::string> known = kinds();
  std::vector<AcceptedDefects> accepted;
  std::istringstream words(text);
  for (std::string word; std::getline(words, word, ',');) {
    const std::size_t colon = word.find(':');
    AcceptedDefects of_kind{word.substr(0, colon), std::nullopt};
    if (std::find(known.begin(), known.end(), of_kind.kind) == known.end()) {
      throw UsageError({option::accept, formatted(": '%s' is no kind of defect; the kinds are %s", of_kind.kind.c_str(),
                                                  joined(known, ", ").c_str())});
    }
    if (colon != std::string::npos) {
      double most = 0;
      const char *begin = word.data() + colon + 1, *end = word.data() + word.size();
      const auto [rest, error] = std::from_chars(begin, end, most);
      if (error != std::errc() || rest != end || !(most >= 0)) {
        throw UsageError({option::accept, formatted(": '%s' after '%s:' is not a number",
                                                    word.substr(colon + 1).c_str(), of_kind.kind.c_str())});
      }
      of_kind.most = most;
    }
    accepted.push_back(of_kind);
  }
  return accepted;
}

bool is_accepted(const std::vector<AcceptedDefects>& accepted, const std::string& kind, double amount) {
  return std::any_of(accepted.begin(), accepted.end(),
                     [&](const AcceptedDefects& a) { return a.kind == kind && (!a.most || amount <= *a.most); });
}

}  // namespace umtet
