#pragma once

namespace umtet {

/// A process that ends at once, by a second signal, because a step does not ask (interrupt.h) or for want of memory,
/// writes the document of this failure to stdout before, as --json promises.
/// @param command  in the document; no quotes, and lives until the program ends or the next call
void answer_stops_in_json(const char* command);

/// Before the program writes its own answer to stdout and stderr: from here on no signal writes or ends it, except that
/// a reader who does not read has 5 s after one. Does not return where a signal or another thread is answering already.
/// \pre called once, in the thread that called install_signal_handlers()
void take_last_word();

/// The answer is written: signals are no longer heard while the process ends.
void say_no_more();

}  // namespace umtet
