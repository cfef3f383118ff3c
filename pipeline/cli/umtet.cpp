// The program that runs in a single process.

#include "pipeline/case/interrupt.h"
#include "pipeline/cli/program.h"

int main(int argc, char** argv) {
  umtet::keep_freed_memory();
  umtet::install_signal_handlers();
  return umtet::run_program(argc, argv);
}
