#include "distributed/program/same_call.h"

#include <vector>

#include "distributed/exchange/collect.h"
#include "pipeline/case/version.h"

namespace umtet {
namespace {

std::string first_difference(const Json& first, const Json& mine, int rank) {
  const auto says = [](const Json& json, const std::string& name) {
    return json.contains(name) ? json.at(name).dump() : "not there";
  };
  for (const Json* from : {&first, &mine}) {
    for (const auto& [name, value] : from->items()) {
      const std::string here = says(mine, name), there = says(first, name);
      if (here == there) continue;
      return "processes were called for different meshes: " + name + " is " + there + " on rank 0 and " + here +
             " on rank " + std::to_string(rank);
    }
  }
  return "";
}

}  // namespace

std::string difference_of_calls(MPI_Comm comm, const Json& mine) {
  Json own = mine;
  own["umtet"] = kVersion;
  const std::string text = own.dump();
  std::vector<char> first(text.begin(), text.end());
  broadcast(comm, first);
  std::string complaint;
  if (const std::string there(first.begin(), first.end()); there != text)
    complaint = first_difference(Json::parse(there), own, rank_in(comm));
  // The first rank that differs sends its sentence.
  int n_ranks = 1;
  MPI_Comm_size(comm, &n_ranks);
  int least = complaint.empty() ? n_ranks : rank_in(comm);
  MPI_Allreduce(MPI_IN_PLACE, &least, 1, MPI_INT, MPI_MIN, comm);
  if (least == n_ranks) return "";
  int length = static_cast<int>(complaint.size());
  MPI_Bcast(&length, 1, MPI_INT, least, comm);
  complaint.resize(static_cast<std::size_t>(length));
  MPI_Bcast(complaint.data(), length, MPI_CHAR, least, comm);
  return complaint;
}

}  // namespace umtet
