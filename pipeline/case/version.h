#pragma once

namespace umtet {

/// Version of the program, part of every record: another version does its work again.
extern const char* const kVersion;

}  // namespace umtet
