#include "pipeline/case/exit_code.h"

#include <csignal>
#include <filesystem>
#include <new>
#include <stdexcept>
#include <string>
#include <system_error>

#include "common/context.h"
#include "mesh/io/tet_mesh_io.h"
#include "pipeline/case/interrupt.h"
#include "pipeline/case/option_words.h"
#include "pipeline/case/thin_place_json.h"
#include "mesh/expression/expression.h"
#include "reconstruct/io/grid_io.h"
#include "reconstruct/io/point_cloud_io.h"
#include "reconstruct/solve/fit_ssd.h"

namespace umtet {
namespace {

constexpr const char* kPleaseReport =
    "\n  this is a bug of umtet: please report it with the command and the case folder (or the input, if there is "
    "none)";

/// Returns what a user can do about a system error; empty if the system's message is sufficient.
const char* remedy(const std::error_code& code) {
  if (code == std::errc::no_such_file_or_directory) return "; check the path";
  if (code == std::errc::permission_denied || code == std::errc::operation_not_permitted) {
    return "; check the permissions, or choose another place";
  }
  if (code == std::errc::read_only_file_system) return "; choose another place";
  if (code == std::errc::no_space_on_device) return "; make room on the disk and repeat the command";
  if (code == std::errc::file_too_large) return "; raise the limit on file sizes (ulimit -f) and repeat the command";
  if (code == std::errc::not_a_directory || code == std::errc::file_exists) return "; a part of this path is a file";
  if (code == std::errc::is_a_directory) return "; a file is needed here";
  return "";
}

std::string message(const std::filesystem::filesystem_error& e) {
  const std::string place = e.path1().empty() ? std::string("a file") : e.path1().string();
  return place + ": " + e.code().message() + remedy(e.code());
}

/// The message in the words of the command line.
std::string said(const ExplainedError& e) { return text_of(e.message, as_flag); }

}  // namespace

Interrupted::Interrupted(int signal)
    : std::runtime_error(std::string(signal == SIGALRM   ? "out of time"
                                     : signal == SIGTERM ? "terminated"
                                                         : "interrupted") +
                         " in " + work_at_hand() + "; the case can be resumed with the same command"),
      signal(signal) {}

Failure failure_of(const std::exception_ptr& error) {
  try {
    std::rethrow_exception(error);
  } catch (const Interrupted& e) {
    return {e.signal == SIGALRM   ? ExitCode::ResourceLimit
            : e.signal == SIGTERM ? ExitCode::Terminated
                                  : ExitCode::Interrupted,
            e.what()};
  } catch (const Cancelled&) {  // by until_interrupted()
    return failure_of(std::make_exception_ptr(Interrupted(interrupt_signal())));
  } catch (const UsageError& e) {
    return {ExitCode::Usage, said(e)};
  } catch (const ExpressionError& e) {
    return {ExitCode::Usage, e.what()};
  } catch (const CloudRefused& e) {
    return {ExitCode::InputRefused, said(e)};
  } catch (const GridRefused& e) {
    return {ExitCode::InputRefused, said(e)};
  } catch (const MeshFileRefused& e) {
    return {ExitCode::InputRefused, e.what()};
  } catch (const SolveError& e) {
    return {ExitCode::ReconstructionFailed, e.what()};
  } catch (const TooThin& e) {
    const TooThin::Evidence& thin = e.evidence;
    return {ExitCode::MeshingImpossible,
            said(e),
            {{"too_thin", to_json(thin.places, thin.h)}, {"h_enough", json_of(thin.h_enough)}}};
  } catch (const MeshingImpossible& e) {
    return {ExitCode::MeshingImpossible, said(e)};
  } catch (const CertificateFailed& e) {
    return {ExitCode::GateFailed, e.what()};
  } catch (const ArtefactDamaged& e) {
    return {ExitCode::ArtefactCorrupt, e.what()};
  } catch (const ResourceLimit& e) {
    return {ExitCode::ResourceLimit, said(e)};
  } catch (const std::bad_alloc&) {
    return {ExitCode::ResourceLimit, std::string("out of memory in ") + work_at_hand()};
  } catch (const FileTrouble& e) {
    return {ExitCode::FileTrouble, e.what()};
  } catch (const std::filesystem::filesystem_error& e) {
    return {ExitCode::FileTrouble, message(e)};
  } catch (const std::system_error& e) {
    return {ExitCode::FileTrouble, e.what() + std::string(remedy(e.code()))};
  } catch (const std::length_error& e) {  // a lattice, grid or mesh with more elements than indices can count
    return {ExitCode::ResourceLimit, e.what()};
  } catch (const std::exception& e) {  // including std::invalid_argument: user errors are checked before
    return {ExitCode::Bug, std::string("internal error: ") + e.what() + kPleaseReport};
  } catch (...) {
    return {ExitCode::Bug, std::string("internal error of unknown type") + kPleaseReport};
  }
}

}  // namespace umtet
