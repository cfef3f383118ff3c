#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipeline/case/progress.h"
#include "pipeline/cli/batch.h"
#include "pipeline/run/evolve.h"
#include "pipeline/run/run.h"

namespace umtet {

/// A call of the program, understood.
struct CommandLine {
  enum class Action { Text, Stages, Check, Export, Report, View, Diff, Inspect, Evolve, Batch };
  Action action = Action::Text;
  std::string text;     ///< Text: help or version, for stdout
  std::string command;  ///< "run", "reconstruct", "mesh", "inspect", "check", "export", "report", "view",
                        ///< "diff", "evolve", "batch"

  RunRequest request;    ///< Stages; Check: its output.* parameters; Export: these and its case_folder; Report and
                         ///< View: its case_folder
  EvolveRequest evolve;  ///< Evolve, but for its parameters: those of `request`
  BatchRequest batch;    ///< Batch, but for its parameters, formats, timeout and threads
  std::filesystem::path mesh;                    ///< Check
  std::filesystem::path cloud;                   ///< Inspect
  std::optional<std::filesystem::path> against;  ///< Check
  std::filesystem::path case_a, case_b;          ///< Diff
  std::vector<std::string> formats;              ///< Export, and Stages after which something is exported

  double timeout = 0;  ///< seconds; Stages and Evolve: for all, Batch: for every scan; 0: any
  bool json = false;
  ProgressMode progress = ProgressMode::Auto;
  Verbosity verbosity = Verbosity::Normal;
  int threads = 0;  ///< 0: as many as the machine has; Batch: shared by its jobs
};

/// What --help says, for documents that are made from it.
struct OptionHelp {
  std::vector<std::string> flags;  ///< "-o", "--h"; of an argument without a flag its name
  bool is_flag = true, takes_value = false;
  std::string help;
  std::vector<std::string> choices;  ///< of a value with a fixed vocabulary
};
struct CommandHelp {
  std::string name, help;
  std::vector<OptionHelp> options;
};
struct ProgramHelp {
  std::string help, footer;
  std::vector<CommandHelp> commands;
};
ProgramHelp program_help();

/// \throw UsageError, with the nearest flag or command where there is one; std::system_error for a --config that cannot
///        be read
CommandLine parse_command_line(int argc, const char* const* argv);

}  // namespace umtet
