#include "pipeline/cli/help_format.h"

#include <algorithm>
#include <array>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace umtet {
namespace {

struct FlagGroup {
  const char* name;
  std::vector<std::string_view> flags;  ///< in the order of the help text
};

const std::vector<FlagGroup>& flag_groups() {
  static const std::vector<FlagGroup> groups = {
      {"Input",
       {"--implicit",    "--clouds",         "--level-set", "--t",           "--skip",    "--against",   "--normals",
        "--orient-from", "--flip",           "--keep-all",  "--box",         "--columns", "--as-points", "--touching",
        "--features",    "--sample-spacing", "--part",      "--part-smooth", "--level",   "--above",     "--complement",
        "--box-walls",   "--no-outside",     "--least",     "--periodic"}},
      {"Level set", {"--close", "--keep-open", "--edges", "--feature-angle", "--spacing", "--detail", "--smooth"}},
      {"Size",
       {"--h", "--tets", "--max-tets", "--background", "--size", "--size-at", "--h-min", "--h-max", "--grade",
        "--grade-inside", "--max-deviation", "--max-turn"}},
      {"Output",
       {"-o", "--export", "--format", "--no-report", "--units", "--order", "--label-names", "--patch-angle",
        "--patch-planar", "--label-min-area"}},
      {"Stages",
       {"--from", "--until", "--force", "--fresh", "--set", "--config", "--threads", "--timeout", "--max-memory",
        "--jobs", "--resume", "--collect", "--seed"}},
      {"Verdict", {"--min-quality", "--target-quality", "--accept", "--strict", "--effort"}},
      {"Paper", {"--mode", "--keep-iterates", "--weights", "--solver"}},
      {"Program", {"-q", "-v", "--progress", "--json", "-h", "--version"}}};
  return groups;
}

bool is_named(const CLI::Option& option, std::string_view flag) {
  const auto has = [&](const std::vector<std::string>& names, std::size_t dashes) {
    return std::any_of(names.begin(), names.end(), [&](const std::string& n) { return n == flag.substr(dashes); });
  };
  return flag.starts_with("--") ? has(option.get_lnames(), 2) : has(option.get_snames(), 1);
}

constexpr std::size_t kColumns = 100, kNames = 26;

std::string wrapped(const std::string& text, std::size_t indent) {
  std::istringstream words(text);
  std::string out;
  std::size_t at = indent;
  for (std::string word; words >> word;) {
    if (at > indent && at + 1 + word.size() > kColumns) {
      out += "\n" + std::string(indent, ' ');
      at = indent;
    }
    if (at > indent) out += ' ', ++at;
    out += word;
    at += word.size();
  }
  return out;
}

class GroupedHelp : public CLI::Formatter {
 public:
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override {
    if (mode == CLI::AppFormatMode::Sub) return make_expanded(app);
    return make_description(app) + make_usage(app, std::move(name)) + make_positionals(app) + flags_of(*app) +
           make_subcommands(app, mode) + '\n' + make_footer(app);
  }
  std::string make_option(const CLI::Option* option, bool is_positional) const override {
    std::string names = "  " + make_option_name(option, is_positional) + make_option_opts(option);
    names += names.size() + 2 > kNames ? "\n" + std::string(kNames, ' ') : std::string(kNames - names.size(), ' ');
    return names + wrapped(make_option_desc(option), kNames) + "\n";
  }

 private:
  std::string flags_of(const CLI::App& app) const {
    std::string out;
    for (const FlagGroup& group : flag_groups()) {
      std::string lines;
      for (const std::string_view flag : group.flags) {
        for (const CLI::Option* option : app.get_options())
          if (option->nonpositional() && is_named(*option, flag)) lines += make_option(option, false);
      }
      if (!lines.empty()) out += std::string("\n") + group.name + ":\n" + lines;
    }
    return out;
  }
};

}  // namespace

void group_flags(CLI::App& program) {
  const auto formatter = std::make_shared<GroupedHelp>();
  program.formatter(formatter);
  for (CLI::App* command : program.get_subcommands({})) {
    command->formatter(formatter);
    for (const CLI::Option* option : command->get_options()) {
      const bool is_grouped = std::any_of(flag_groups().begin(), flag_groups().end(), [&](const FlagGroup& group) {
        return std::any_of(group.flags.begin(), group.flags.end(),
                           [&](std::string_view f) { return is_named(*option, f); });
      });
      if (option->nonpositional() && !is_grouped)
        throw std::logic_error(option->get_name() + " has no group in the help of umtet " + command->get_name());
    }
  }
}

}  // namespace umtet
