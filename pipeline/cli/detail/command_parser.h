#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <string>
#include <vector>

#include "pipeline/cli/command_line.h"

// Commands and flags of the program: what CLI11 reads of them, what is said of them, and what a call asks for.
namespace umtet {

/// Where CLI11 leaves what it read, as text; the table of parameters knows the types.
struct CommandInputs {
  std::string input, output, config, from, until, against, clouds, times, skip, other_case;
  std::vector<std::string> assignments, formats;
  std::map<std::string, std::string> values;  ///< by key
  std::map<std::string, bool> switches;       ///< by key
  int jobs = 1;
  bool fresh = false, force = false, resume = false, collect = false, no_report = false, quiet = false, verbose = false;
};

/// Makes a command of what was read.
/// @param app  the one that was called: tells which flags were given
/// \throw UsageError; std::system_error for a --config or case.toml that cannot be read
using CommandMaker = Command (*)(const CLI::App& app, const CommandInputs& in);
Command make_run(const CLI::App& app, const CommandInputs& in);
Command make_reconstruct(const CLI::App& app, const CommandInputs& in);
Command make_mesh(const CLI::App& app, const CommandInputs& in);
Command make_evolve(const CLI::App& app, const CommandInputs& in);
Command make_batch(const CLI::App& app, const CommandInputs& in);
Command make_inspect(const CLI::App& app, const CommandInputs& in);
Command make_check(const CLI::App& app, const CommandInputs& in);
Command make_export(const CLI::App& app, const CommandInputs& in);
Command make_report(const CLI::App& app, const CommandInputs& in);
Command make_view(const CLI::App& app, const CommandInputs& in);
Command make_diff(const CLI::App& app, const CommandInputs& in);

/// The table of all commands. CLI11 writes into its members: it stays where it is.
class CommandParser {
 public:
  CommandParser();
  CommandParser(const CommandParser&) = delete;
  CommandParser& operator=(const CommandParser&) = delete;
  CommandLine parse(int argc, const char* const* argv);  ///< once. \throw as parse_command_line()
  const CLI::App& app() const { return app_; }

 private:
  CLI::App& add_command(const char* name, CommandMaker make, const char* description);
  CLI::Option& add_formats(CLI::App& command, const char* flag);
  void add_parameter_sources(CLI::App& command);
  void add_stage_flags(CLI::App& command);
  void add_fresh(CLI::App& command, const char* help);
  void add_timeout(CLI::App& command, const char* help);
  void add_batch();
  void add_value(CLI::App& command, const ParamField& field);
  void add_parameter_flags(CLI::App& command, const std::vector<std::string>& sections,
                           const std::vector<std::string>& except = {});
  void check_command(int argc, const char* const* argv) const;
  [[noreturn]] void refuse(const CLI::ParseError& e, int argc, const char* const* argv) const;

  CLI::App app_{"umtet: from an oriented point cloud to a certified tetrahedral mesh", "umtet"};
  CommandInputs in_;
  CommandLine result_;
};

}  // namespace umtet
