#pragma once

namespace umtet {

class PartMesher;

/// The processes that are one call of the program, of which this one speaks.
struct RanksOfProgram {
  PartMesher* mesher = nullptr;  ///< by which they make a mesh; null: there is no MPI
  int n = 1, n_here = 1;         ///< of all, and of those on this machine, which share its processors
};

/// Parses the call, runs it, prints data on stdout and the rest on stderr. @return the exit code
int run_program(int argc, char** argv, const RanksOfProgram& ranks = {});

/// Arrays of some megabytes come and go in every stage. Freed memory is kept for the next one: if it were given back to
/// the system, the kernel would have to clear every page anew.
void keep_freed_memory();

}  // namespace umtet
