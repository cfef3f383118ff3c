#include "distributed/program/rank_command.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include "distributed/exchange/collect.h"
#include "distributed/program/freed_memory.h"

namespace umtet {
namespace {

/// Broadcasts bytes from rank 0.
void pass_on(MPI_Comm comm, Heard& heard) {
  give_back_freed_memory();  // memory of the former work
  // Rank 0 may work alone for minutes. The other ranks sleep, so that it can use their processors.
  MPI_Request request;
  MPI_Ibcast(&heard.command, sizeof heard.command, MPI_BYTE, 0, comm, &request);
  int has_come = 0;
  while (MPI_Test(&request, &has_come, MPI_STATUS_IGNORE) == MPI_SUCCESS && !has_come) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  std::string& file = heard.attached.file;
  std::vector<char> characters(file.begin(), file.end());
  broadcast(comm, characters);
  file.assign(characters.begin(), characters.end());
  broadcast(comm, heard.attached.seeds);
}

}  // namespace

void RankCommand::set_places(const RoundedPlaces& places) {
  h = places.h;
  std::copy_n(places.shift.data(), 3, shift);
  rounding = places.rounding;
}

void RankCommand::set_box(const Box& b) {
  std::copy_n(b.min().data(), 3, box[0]);
  std::copy_n(b.max().data(), 3, box[1]);
}

void say(MPI_Comm comm, const RankCommand& command, const Attached& attached) {
  Heard said{command, attached};
  pass_on(comm, said);
}

Heard hear(MPI_Comm comm) {
  Heard heard;
  pass_on(comm, heard);
  return heard;
}

}  // namespace umtet
