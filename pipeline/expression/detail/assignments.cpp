#include "pipeline/expression/detail/assignments.h"

#include <cctype>
#include <unordered_map>

namespace umtet {
namespace {

/// Visits the names v0, v1, ... in a text: calls f(text before, name) for each, and f(rest, "") at the end.
template <class F>
void for_each_name(const std::string& text, F&& f) {
  std::size_t from = 0;
  for (std::size_t k = text.find('v'); k != std::string::npos; k = text.find('v', k)) {
    std::size_t end = k + 1;
    while (end < text.size() && std::isdigit(static_cast<unsigned char>(text[end]))) ++end;
    f(text.substr(from, k - from), text.substr(k, end - k));
    from = k = end;
  }
  f(text.substr(from), "");
}

}  // namespace

void inline_single_uses(Assignments& all) {
  constexpr std::size_t kMaxLength = 1500;  // ten results form one text, and muParser refuses 20000 characters
  std::unordered_map<std::string, int> uses;
  const auto count = [&](const std::string& text) {
    std::string last;
    for_each_name(text, [&](const std::string& before, const std::string& name) {
      if (before.starts_with('^')) uses[last] += 2;
      ++uses[last = name];
    });
  };
  for (const auto& [name, text] : all.texts) count(text);
  for (const std::string& text : all.results) count(text);

  std::unordered_map<std::string, std::string> single;  // texts that are used once and not yet inlined
  const auto expand = [&](std::string& text) {
    std::string longer;
    for_each_name(text, [&](const std::string& before, const std::string& name) {
      longer += before;
      const auto place = single.find(name);
      if (place == single.end() || longer.size() + place->second.size() > kMaxLength) {
        longer += name;
      } else {
        longer += "(" + place->second + ")";
        single.erase(place);
      }
    });
    text = std::move(longer);
  };
  for (auto& [name, text] : all.texts) {
    expand(text);
    if (uses[name] == 1) single.emplace(name, text);
  }
  for (std::string& text : all.results) expand(text);
  std::erase_if(all.texts, [&](const auto& a) { return uses[a.first] == 1 && !single.contains(a.first); });
}

}  // namespace umtet
