#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <string>
#include <vector>

#include "pipeline/cli/command_line.h"

// Commands and flags of the program: their help, their parsing by CLI11, and their conversion to requests.
namespace umtet {

/// The values that CLI11 has read, as text; the table of parameters knows their types.
struct CommandInputs {
  std::string input, output, config, from, until, against, clouds, times, skip, other_case;
  std::vector<std::string> assignments, formats, bodies;
  std::map<std::string, std::string> values;  ///< values of parameters by key
  std::map<std::string, bool> switches;       ///< values of switches by key
  int jobs = 1;
  bool fresh = false, force = false, resume = false, collect = false, no_report = false, no_outside = false,
       least = false, periodic = false, quiet = false, verbose = false;
};

/// Makes a command from the values that were read.
/// @param app  the subcommand of the call: tells which flags were given
/// \throw UsageError; std::system_error for a --config or case.toml that cannot be read
using CommandMaker = Command (*)(const CLI::App& app, const CommandInputs& in);
Command make_run(const CLI::App& app, const CommandInputs& in);
Command make_reconstruct(const CLI::App& app, const CommandInputs& in);
Command make_mesh(const CLI::App& app, const CommandInputs& in);
Command make_evolve(const CLI::App& app, const CommandInputs& in);
Command make_regions(const CLI::App& app, const CommandInputs& in);
Command make_batch(const CLI::App& app, const CommandInputs& in);
Command make_inspect(const CLI::App& app, const CommandInputs& in);
Command make_check(const CLI::App& app, const CommandInputs& in);
Command make_export(const CLI::App& app, const CommandInputs& in);
Command make_report(const CLI::App& app, const CommandInputs& in);
Command make_view(const CLI::App& app, const CommandInputs& in);
Command make_diff(const CLI::App& app, const CommandInputs& in);

/// The table of all commands. It cannot be copied because CLI11 holds pointers to its members.
class CommandParser {
 public:
  CommandParser();
  CommandParser(const CommandParser&) = delete;
  CommandParser& operator=(const CommandParser&) = delete;
  /// Call it once. \throw the exceptions of parse_command_line()
  CommandLine parse(int argc, const char* const* argv);
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

  CLI::App app_{"umtet: certified tetrahedral meshes from oriented point clouds", "umtet"};
  CommandInputs in_;
  CommandLine result_;
};

}  // namespace umtet
