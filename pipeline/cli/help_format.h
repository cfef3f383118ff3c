#pragma once

#include <CLI/CLI.hpp>

namespace umtet {

/// Divides the flags of every command into groups, the most used first: input, level set, size, output, stages,
/// verdict, paper, program. Flags of no group are an error of the table. Help texts are wrapped at 100 columns. \throw
/// std::logic_error  names a flag that the table does not contain
void group_flags(CLI::App& program);

}  // namespace umtet
