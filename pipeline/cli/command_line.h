#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "pipeline/case/progress.h"
#include "pipeline/cli/batch.h"
#include "pipeline/run/evolve.h"
#include "pipeline/run/run.h"

namespace umtet {

// What a call of the program may ask for, a struct for each command.

struct TextAnswer {
  std::string text;  ///< help or version, for stdout
};

/// umtet run, reconstruct, mesh.
struct RunCommand {
  RunRequest request;                ///< but for its threads
  std::vector<std::string> formats;  ///< exported from the mesh
};

struct EvolveCommand {
  EvolveRequest request;  ///< but for its threads
};

struct BatchCommand {
  BatchRequest request;  ///< but for its threads and its timeout
};

struct InspectCommand {
  std::filesystem::path cloud;
  Parameters parameters;  ///< of the run that is predicted
};

struct CheckCommand {
  std::filesystem::path mesh;
  std::optional<std::filesystem::path> against;  ///< a case
  Parameters parameters;                         ///< output.*
};

struct ExportCommand {
  std::filesystem::path case_folder;
  std::vector<std::string> formats;
  Parameters parameters;                  ///< of the case, and those of output.* that the call gives
  bool fresh = false;                     ///< those of output.* are not taken from the case
  std::vector<std::string> changed = {};  ///< against those of the case: differences()
};

struct ReportCommand {
  std::filesystem::path case_folder;
};

struct ViewCommand {
  std::filesystem::path case_folder;
};

struct DiffCommand {
  std::filesystem::path case_a, case_b;
};

using Command = std::variant<TextAnswer, RunCommand, EvolveCommand, BatchCommand, InspectCommand, CheckCommand,
                             ExportCommand, ReportCommand, ViewCommand, DiffCommand>;

/// What every command takes.
struct CommonOptions {
  double timeout = 0;  ///< seconds that the command may take, of a batch every scan; 0: any
  bool json = false;   ///< answer by one document
  ProgressMode progress = ProgressMode::Auto;
  Verbosity verbosity = Verbosity::Normal;
  int threads = 0;  ///< 0: as many as the machine has; the jobs of a batch share them
};

/// A call of the program, understood.
struct CommandLine {
  std::string name;  ///< "run", "reconstruct", ..., "batch"; empty for a TextAnswer
  Command command;
  CommonOptions options;
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
