#pragma once

#include <string>

#include "common/message.h"

// The names that users of the program, of Python and of PCL see for options in messages of the libraries.
namespace umtet {

/// The key of the parameter that is this option: "cloud.keep_all" for "scan.keep_all". A key of the program, such as
/// keys::mesh::level, is its own.
/// \throw std::out_of_range  there is no such parameter
std::string key_of(const Option& option);

/// As the command line takes it: "--keep-all", "--h 0.3", "--set cloud.merge=false".
std::string as_flag(const Setting& setting);
/// As --set and PCL take it: "cloud.keep_all", "mesh.h=0.3".
std::string as_key(const Setting& setting);
/// As a keyword argument of Python: "keep_all", "h=0.3".
std::string as_keyword(const Setting& setting);

}  // namespace umtet
