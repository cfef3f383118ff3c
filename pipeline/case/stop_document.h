#pragma once

namespace umtet {

/// A process that ends at once, by a second signal or because a step does not ask (interrupt.h), writes the document of
/// this failure to stdout before, as --json promises.
/// @param command  in the document; no quotes, and lives until the next call. Null: no document, because the program
///                 writes its own
void answer_stops_in_json(const char* command);

}  // namespace umtet
