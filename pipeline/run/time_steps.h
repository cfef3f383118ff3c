#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace umtet {

/// One instant of a moving domain.
struct TimeStep {
  double t;
  std::filesystem::path cloud;  ///< path of the cloud; empty: there is a formula
};

/// Returns the requested instants of `umtet evolve`, ascending.
/// @param times  "FROM:STEP:TO", both ends included; numbers are rounded to 12 digits, so that 0:0.1:4.5 contains 0.3
///   and not its neighbour. If `clouds` is given it may be empty: the instants are then 0, 1, 2, ...
/// @param skip  some of the times, separated by commas; may be empty
/// @param clouds  a text file with one path of a cloud per line, relative to the folder of the file; empty lines and
///   lines that begin with # are ignored. Empty: no clouds. The clouds themselves are not read.
/// \throw UsageError  the text does not have this form, more than 100000 instants, a time to skip does not exist, the
///   numbers of clouds and times differ; std::system_error  the list cannot be read
std::vector<TimeStep> time_steps(const std::string& times, const std::string& skip,
                                 const std::filesystem::path& clouds);

/// Returns the paths of a list in the form above.
/// \throw UsageError  the list names no cloud, or a cloud that does not exist; std::system_error  the list cannot be
///                    read
std::vector<std::filesystem::path> listed_clouds(const std::filesystem::path& list);

/// Returns the shortest decimal number for t.
std::string time_text(double t);

}  // namespace umtet
