#pragma once

#include <exception>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "body/errors.h"

namespace umtet {

/// What the program returns; the numbers are part of its contract.
enum class ExitCode {
  Success = 0,
  Bug = 1,
  Usage = 2,
  InputRefused = 3,
  ReconstructionFailed = 4,
  MeshingImpossible = 5,  ///< not possible at this h
  GateFailed = 6,         ///< made, but a gate or the certificate failed
  FileTrouble = 7,
  ArtefactCorrupt = 8,
  ResourceLimit = 9,
  Interrupted = 130,  ///< SIGINT; 143 for SIGTERM
  Terminated = 143,
};

/// A mesh was made, but its certificate says no; what() has the first reason.
struct CertificateFailed : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// A file of the case is not what its record says, or not of its format.
struct ArtefactDamaged : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// A file or folder cannot be used; what() is a sentence with the remedy. Where the system's own words say more it is a
/// std::system_error.
struct FileTrouble : std::runtime_error {
  using std::runtime_error::runtime_error;
};
/// A signal asked to stop and the case has been left resumable.
struct Interrupted : std::runtime_error {
  explicit Interrupted(int signal);
  int signal;
};

struct Failure {
  ExitCode code;
  std::string message;                                                 ///< one or a few lines, without a final newline
  nlohmann::ordered_json evidence = nlohmann::ordered_json::object();  ///< what else a program may want to know
};

/// The one place where exceptions become exit codes. What is not one of the types above or of the libraries' is a bug:
/// in particular std::invalid_argument, because parameters and input are checked before they reach the libraries.
/// \pre error is not null
Failure failure_of(const std::exception_ptr& error);

}  // namespace umtet
