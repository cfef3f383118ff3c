#pragma once

#include <exception>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "body/errors.h"

namespace umtet {

/// Exit codes of the program; the numbers are a documented interface.
enum class ExitCode {
  Success = 0,
  Bug = 1,
  Usage = 2,
  InputRefused = 3,
  ReconstructionFailed = 4,
  MeshingImpossible = 5,  ///< not possible at this h
  GateFailed = 6,         ///< a mesh was made, but a gate or the certificate failed
  FileTrouble = 7,
  ArtefactCorrupt = 8,
  ResourceLimit = 9,
  Interrupted = 130,  ///< SIGINT; 143 for SIGTERM
  Terminated = 143,
};

/// A mesh was made, but its certificate fails; what() contains the first reason.
struct CertificateFailed : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// A file of the case does not match its record, or is not in its format.
struct ArtefactDamaged : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// A file or folder cannot be used; what() is a sentence with the remedy. If the message of the system contains more,
/// std::system_error is thrown instead.
struct FileTrouble : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// A signal requested the end of the program, and the case can be resumed.
struct Interrupted : std::runtime_error {
  explicit Interrupted(int signal);
  int signal;
};

struct Failure {
  ExitCode code;
  std::string message;  ///< one or several lines, without a final newline
  nlohmann::ordered_json evidence = nlohmann::ordered_json::object();  ///< further data for programs
};

/// Converts exceptions to exit codes; no other function does. Messages name options by their flags (option_words.h). An
/// exception that is neither one of the types above nor a type of the libraries is a bug. This includes
/// std::invalid_argument, because parameters and input are checked before they reach the libraries.
/// \pre error is not null
Failure failure_of(const std::exception_ptr& error);

}  // namespace umtet
