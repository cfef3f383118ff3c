#pragma once

namespace umtet {

/// Makes a process that ends at once write the document of its failure to stdout first, as --json promises. A
/// process ends at once after a second signal, if a step does not check for signals (interrupt.h), or if memory
/// runs out.
/// @param command  written into the document; contains no quotes, and lives until the program ends or the next call
void answer_stops_in_json(const char* command);

/// Call it before the program writes its answer to stdout and stderr. Afterwards no signal writes an answer or ends
/// the program; but after a signal, a reader that does not read delays the end by at most 5 s. Does not return if a
/// signal or another thread is already answering.
/// \pre called once, in the thread that called install_signal_handlers()
void take_last_word();

/// Call it after the answer has been written: signals are ignored while the process ends.
void say_no_more();

}  // namespace umtet
