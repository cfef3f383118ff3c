#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace umtet {

/// One instant of a domain that moves.
struct TimeStep {
  double t;
  std::filesystem::path cloud;  ///< empty: there is a formula
};

/// The instants that `umtet evolve` is asked for, ascending.
/// @param times  "FROM:STEP:TO", both ends included; numbers of at most 12 digits, so that 0:0.1:4.5 contains 0.3 and
/// not
///               its neighbour. With clouds it may be empty: 0, 1, 2, ...
/// @param skip   some of them, with commas between; may be empty
/// @param clouds  a text file with the path of a cloud a line, relative to the folder it is in; empty lines and those
///               that begin with # are none. Empty: no clouds. The files themselves are not looked at.
/// \throw UsageError  not of this form, more than 100000 instants, a time to skip that is not there, not as many clouds
/// as
///        times; std::system_error when the list cannot be read
std::vector<TimeStep> time_steps(const std::string& times, const std::string& skip,
                                 const std::filesystem::path& clouds);

/// The paths of a list as above.
/// \throw UsageError when it names none, or none that is there; std::system_error when it cannot be read
std::vector<std::filesystem::path> listed_clouds(const std::filesystem::path& list);

/// The shortest decimal number for t.
std::string time_text(double t);

}  // namespace umtet
