// make_documents FOLDER: the man page and the completions of bash, zsh and fish, from what `umtet --help` is made of.

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include "pipeline/case/version.h"
#include "pipeline/cli/command_line.h"

namespace umtet {
namespace {

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t k = 0; (k = text.find(from, k)) != std::string::npos; k += to.size())
    text.replace(k, from.size(), to);
  return text;
}

/// Text in a man page: every - is the one that can be copied, and no line starts a request.
std::string roff(std::string text) {
  text = replaced(replaced(std::move(text), "\\", "\\e"), "-", "\\-");
  for (const char* request : {".", "'"}) {
    if (text.starts_with(request)) text.insert(0, "\\&");
    text = replaced(std::move(text), std::string("\n") + request, std::string("\n\\&") + request);
  }
  return text;
}

bool same(const OptionHelp& a, const OptionHelp& b) { return a.flags == b.flags && a.help == b.help; }

bool in_every_command(const ProgramHelp& program, const OptionHelp& option) {
  return std::all_of(program.commands.begin(), program.commands.end(), [&](const CommandHelp& command) {
    return std::any_of(command.options.begin(), command.options.end(),
                       [&](const OptionHelp& o) { return same(o, option); });
  });
}

std::string man_entry(const OptionHelp& option) {
  std::string names;
  for (const std::string& flag : option.flags) names += (names.empty() ? "" : ", ") + roff(flag);
  std::string entry = fmt::format(".TP\n.B {}\n{}", names, roff(option.help));
  if (!option.choices.empty() && option.help.find('{') == std::string::npos) {
    entry += fmt::format(" {{{}}}", fmt::join(option.choices, ","));
  }
  return entry + "\n";
}

std::string man_page(const ProgramHelp& program) {
  const std::string title = program.help.substr(program.help.find(": ") + 2);
  std::string page = fmt::format(
      ".TH UMTET 1 \"\" \"umtet {}\" \"User Commands\"\n.SH NAME\numtet \\- {}\n"
      ".SH SYNOPSIS\n.B umtet\n.I COMMAND\n[options]\n.SH COMMANDS\n",
      kVersion, roff(title));
  for (const CommandHelp& command : program.commands) {
    page += fmt::format(".SS umtet {}\n{}.\n", command.name, roff(command.help));
    for (const OptionHelp& option : command.options) {
      if (!in_every_command(program, option)) page += man_entry(option);
    }
  }
  page += ".SH OPTIONS OF ALL COMMANDS\n";
  for (const OptionHelp& option : program.commands.front().options) {
    if (in_every_command(program, option)) page += man_entry(option);
  }
  const std::size_t end = program.footer.find("\n\nExit codes: ");
  const std::string examples = program.footer.substr(program.footer.find('\n') + 1);
  page += ".SH EXAMPLES\n.nf\n" + roff(examples.substr(0, examples.find("\n\n"))) + "\n.fi\n";
  if (end != std::string::npos) page += ".SH EXIT STATUS\n" + roff(program.footer.substr(end + 14)) + "\n";
  return page;
}

/// Every word that may follow `command`.
std::string flags_of(const CommandHelp& command) {
  std::string words;
  for (const OptionHelp& option : command.options) {
    for (const std::string& flag : option.flags) {
      if (option.is_flag) words += (words.empty() ? "" : " ") + flag;
    }
  }
  return words;
}

std::string names_of(const ProgramHelp& program) {
  std::string names;
  for (const CommandHelp& command : program.commands) names += command.name + " ";
  return names;
}

std::string bash_completion(const ProgramHelp& program) {
  std::string values, flags;
  for (const CommandHelp& command : program.commands) {
    flags += fmt::format("    {}) words='{}' ;;\n", command.name, flags_of(command));
    for (const OptionHelp& option : command.options) {
      if (!option.is_flag || !option.takes_value) continue;
      for (const std::string& flag : option.flags) {
        values += fmt::format("    '{} {}') words='{}' ;;\n", command.name, flag, fmt::join(option.choices, " "));
      }
    }
  }
  return R"(# bash completion of umtet
_umtet() {
  local cur=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD-1]} command= word words=
  COMPREPLY=()
  for word in "${COMP_WORDS[@]:1:COMP_CWORD-1}"; do
    [[ $word == -* ]] || { command=$word; break; }
  done
  if [[ -z $command ]]; then
    COMPREPLY=($(compgen -W ')" +
         names_of(program) + R"(--help --version --json' -- "$cur"))
    return
  fi
  # After a flag its value: one of a few words, or (no words) a file or a number.
  case "$command $previous" in
)" + values +
         R"(    *)
    [[ $cur == -* ]] || return
    case $command in
)" + replaced(flags, "    ", "      ") +
         R"(    esac ;;
  esac
  [[ -z $words ]] || COMPREPLY=($(compgen -W "$words" -- "$cur"))
}
complete -o default -F _umtet umtet
)";
}

/// One line of the help, in single quotes.
std::string in_quotes(const std::string& text) { return replaced(text, "'", "'\\''"); }

std::string zsh_completion(const ProgramHelp& program) {
  std::string commands, cases;
  for (const CommandHelp& command : program.commands) {
    commands += fmt::format("    '{}:{}'\n", command.name, in_quotes(replaced(command.help, ":", "\\:")));
    cases += fmt::format("    {}) _arguments", command.name);
    for (const OptionHelp& option : command.options) {
      std::string help = option.help;
      for (const char* special : {"\\", "[", "]", ":"})
        help = replaced(std::move(help), special, std::string("\\") + special);
      for (const std::string& flag : option.flags) {
        if (!option.is_flag) continue;
        cases += fmt::format(" \\\n      '{}{}[{}]", flag, option.takes_value && flag.starts_with("--") ? "=" : "",
                             in_quotes(help));
        if (option.takes_value) {
          cases +=
              option.choices.empty() ? ":value:_files" : fmt::format(":value:({})", fmt::join(option.choices, " "));
        }
        cases += "'";
      }
    }
    cases += " \\\n      '*:file:_files' ;;\n";
  }
  return "#compdef umtet\n_umtet() {\n  local -a commands=(\n" + commands +
         "  )\n  if (( CURRENT == 2 )); then\n    _describe command commands\n    return\n  fi\n"
         "  local command=$words[2]\n  shift words\n  (( CURRENT-- ))\n  case $command in\n" +
         cases + "  esac\n}\n_umtet \"$@\"\n";
}

std::string fish_completion(const ProgramHelp& program) {
  std::string out = "# fish completion of umtet\n";
  for (const CommandHelp& command : program.commands) {
    out += fmt::format("complete -c umtet -n __fish_use_subcommand -f -a {} -d '{}'\n", command.name,
                       replaced(command.help, "'", "\\'"));
    for (const OptionHelp& option : command.options) {
      if (!option.is_flag) continue;
      out += fmt::format("complete -c umtet -n '__fish_seen_subcommand_from {}'", command.name);
      for (const std::string& flag : option.flags) {
        out += flag.starts_with("--") ? " -l " + flag.substr(2) : " -s " + flag.substr(1);
      }
      if (option.takes_value) {
        out += option.choices.empty() ? " -r" : fmt::format(" -x -a '{}'", fmt::join(option.choices, " "));
      }
      out += fmt::format(" -d '{}'\n", replaced(option.help, "'", "\\'"));
    }
  }
  return out;
}

bool write(const std::string& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  out.close();
  if (!out) std::cerr << file << ": cannot be written\n";
  return static_cast<bool>(out);
}

}  // namespace
}  // namespace umtet

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: make_documents FOLDER\n";
    return 2;
  }
  const umtet::ProgramHelp program = umtet::program_help();
  const std::string folder = std::string(argv[1]) + "/";
  const bool done = umtet::write(folder + "umtet.1", umtet::man_page(program)) &&
                    umtet::write(folder + "umtet.bash", umtet::bash_completion(program)) &&
                    umtet::write(folder + "_umtet", umtet::zsh_completion(program)) &&
                    umtet::write(folder + "umtet.fish", umtet::fish_completion(program));
  return done ? 0 : 7;
}
