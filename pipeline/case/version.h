#pragma once

namespace umtet {

/// Version of the program, stored in every record: another version repeats its stages.
extern const char* const kVersion;

}  // namespace umtet
