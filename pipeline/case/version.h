#pragma once

namespace umtet {

/// Version of the program, part of every record: another version does its work again.
inline constexpr const char* kVersion = UMTET_VERSION;

}  // namespace umtet
