#include "pipeline/exit_code.h"

#include <csignal>
#include <filesystem>
#include <new>
#include <stdexcept>
#include <string>
#include <system_error>

#include "mesh/tet_mesh_io.h"
#include "pipeline/expression.h"
#include "reconstruct/fit_ssd.h"
#include "reconstruct/point_cloud_io.h"

namespace umtet {
namespace {

constexpr const char* kPleaseReport =
    "\n  this is a bug of umtet: please report it with the command and the case folder (or the input, if there is "
    "none)";

}  // namespace

Interrupted::Interrupted(int signal)
    : std::runtime_error(signal == SIGTERM ? "terminated; the case can be resumed with the same command"
                                           : "interrupted; the case can be resumed with the same command"),
      signal(signal) {}

Failure failure_of(const std::exception_ptr& error) {
  try {
    std::rethrow_exception(error);
  } catch (const Interrupted& e) {
    return {e.signal == SIGTERM ? ExitCode::Terminated : ExitCode::Interrupted, e.what()};
  } catch (const UsageError& e) {
    return {ExitCode::Usage, e.what()};
  } catch (const ExpressionError& e) {
    return {ExitCode::Usage, e.what()};
  } catch (const CloudRefused& e) {
    return {ExitCode::InputRefused, e.what()};
  } catch (const MeshFileRefused& e) {
    return {ExitCode::InputRefused, e.what()};
  } catch (const SolveError& e) {
    return {ExitCode::ReconstructionFailed, e.what()};
  } catch (const MeshingImpossible& e) {
    return {ExitCode::MeshingImpossible, e.what()};
  } catch (const ArtefactDamaged& e) {
    return {ExitCode::ArtefactCorrupt, e.what()};
  } catch (const ResourceLimit& e) {
    return {ExitCode::ResourceLimit, e.what()};
  } catch (const std::bad_alloc&) {
    return {ExitCode::ResourceLimit, "out of memory"};
  } catch (const std::system_error& e) {  // std::filesystem::filesystem_error is one
    return {ExitCode::FileTrouble, e.what()};
  } catch (const std::length_error& e) {  // a lattice, grid or mesh of more parts than there are numbers for
    return {ExitCode::ResourceLimit, e.what()};
  } catch (const std::exception& e) {  // also std::invalid_argument: what a user can get wrong is checked before
    return {ExitCode::Bug, std::string("internal error: ") + e.what() + kPleaseReport};
  } catch (...) {
    return {ExitCode::Bug, std::string("internal error of an unknown kind") + kPleaseReport};
  }
}

}  // namespace umtet
