#pragma once

#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "pipeline/case/progress.h"
#include "pipeline/cli/batch.h"
#include "pipeline/run/evolve.h"
#include "pipeline/run/regions.h"
#include "pipeline/run/run.h"

namespace umtet {

// The requests of a call, one struct per command.

struct TextAnswer {
  std::string text;  ///< help or version, to be printed on stdout
};

/// umtet run, reconstruct, mesh.
struct RunCommand {
  RunRequest request;                ///< but for its threads
  std::vector<std::string> formats;  ///< export formats of the mesh
};

struct EvolveCommand {
  EvolveRequest request;  ///< but for its threads
};

struct RegionsCommand {
  RegionsRequest request;
  std::vector<std::string> formats;  ///< written to FOLDER/4-export
};

struct BatchCommand {
  BatchRequest request;  ///< but for its threads and its timeout
};

struct InspectCommand {
  std::filesystem::path cloud;  ///< empty: mesh.implicit
  Parameters parameters;        ///< parameters of the predicted run
};

struct CheckCommand {
  std::filesystem::path mesh;
  std::optional<std::filesystem::path> against;  ///< case to compare with
  Parameters parameters;                         ///< output.* only
};

struct ExportCommand {
  std::filesystem::path case_folder;
  std::vector<std::string> formats;
  Parameters parameters;                  ///< parameters of the case, and output.* of the call
  bool fresh = false;                     ///< do not take output.* from the case
  std::vector<std::string> changed = {};  ///< differences() from the parameters of the case
};

struct ReportCommand {
  std::filesystem::path case_folder;
};

struct ViewCommand {
  std::filesystem::path case_folder;
};

struct DiffCommand {
  std::filesystem::path case_a, case_b;
  std::filesystem::path page;  ///< the picture; empty: diff.html in case_b
};

using Command = std::variant<TextAnswer, RunCommand, EvolveCommand, RegionsCommand, BatchCommand, InspectCommand,
                             CheckCommand, ExportCommand, ReportCommand, ViewCommand, DiffCommand>;

/// Options of all commands.
struct CommonOptions {
  double timeout = 0;  ///< maximum seconds of the command, or of each scan of a batch; 0: no limit
  bool json = false;   ///< answer with one document
  ProgressMode progress = ProgressMode::Auto;
  Verbosity verbosity = Verbosity::Normal;
  int threads = 0;  ///< 0: all processors of the machine; the jobs of a batch share them
};

/// A parsed call of the program.
struct CommandLine {
  std::string name;  ///< "run", "reconstruct", ..., "batch"; empty for a TextAnswer
  Command command;
  CommonOptions options;
};

/// The contents of --help, for documents that are generated from it.
struct OptionHelp {
  std::vector<std::string> flags;  ///< "-o", "--h"; the name of an argument without a flag
  bool is_flag = true, takes_value = false;
  std::string help;
  std::vector<std::string> choices;  ///< choices of a value with a fixed vocabulary
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

/// Parses the words of a call. \throw UsageError, with the nearest flag or command if there is one;
/// std::system_error if a --config file cannot be read
CommandLine parse_command_line(int argc, const char* const* argv);

}  // namespace umtet
