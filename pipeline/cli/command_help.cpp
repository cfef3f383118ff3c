#include <sstream>

#include "pipeline/cli/command_line.h"
#include "pipeline/cli/detail/command_parser.h"

namespace umtet {
namespace {

OptionHelp help_of(const CLI::Option& option) {
  OptionHelp help;
  for (const std::string& name : option.get_snames()) help.flags.push_back("-" + name);
  for (const std::string& name : option.get_lnames()) help.flags.push_back("--" + name);
  help.is_flag = !help.flags.empty();
  if (!help.is_flag) help.flags.push_back(option.get_name());
  help.takes_value = option.get_items_expected_max() > 0;
  help.help = option.get_description();
  const std::string type = option.get_type_name();  // TEXT:{one,two} after CLI::IsMember
  if (const std::size_t brace = type.find('{'); brace != std::string::npos) {
    std::istringstream words(type.substr(brace + 1, type.find('}') - brace - 1));
    for (std::string word; std::getline(words, word, ',');) help.choices.push_back(word);
  }
  for (const ParamField& f : params_fields()) {
    if (!f.flag.empty() && f.flag == help.flags.back()) help.choices = f.choices;
  }
  return help;
}

}  // namespace

ProgramHelp program_help() {
  const CommandParser parser;
  const CLI::App& table = parser.app();
  ProgramHelp program{table.get_description(), table.get_footer(), {}};
  for (const CLI::App* app : table.get_subcommands({})) {
    CommandHelp& command = program.commands.emplace_back();
    command.name = app->get_name();
    command.help = app->get_description();
    for (const CLI::Option* option : app->get_options()) command.options.push_back(help_of(*option));
  }
  return program;
}

}  // namespace umtet
