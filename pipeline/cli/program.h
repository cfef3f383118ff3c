#pragma once

namespace umtet {

class PartMesher;

/// The processes that execute one call of the program together, and their view from this process.
struct RanksOfProgram {
  PartMesher* mesher = nullptr;  ///< makes meshes in all processes; null: there is no MPI
  int n = 1, n_here = 1;         ///< number of all processes, and of those on this machine, which share its processors
};

/// Parses and runs the call. Prints data on stdout and everything else on stderr. @return the exit code
int run_program(int argc, char** argv, const RanksOfProgram& ranks = {});

/// Keeps freed memory for the next allocation. Every stage allocates and frees arrays of some megabytes; if they
/// were returned to the system, the kernel would have to clear every page again.
void keep_freed_memory();

}  // namespace umtet
