#pragma once

#include <mpi.h>

#include <cstddef>
#include <cstring>
#include <vector>

#include "distributed/unwinding.h"

namespace umtet {

/// What a rank has sent.
struct Traffic {
  std::size_t exchanges = 0;   ///< neighbourhood collectives
  std::size_t reductions = 0;  ///< collectives over all ranks
  std::size_t messages = 0;    ///< to one neighbour each, that are not empty
  std::size_t bytes = 0;       ///< in these
};

/// The ranks next to this one, by MPI's neighbourhood collectives, and reductions over all ranks. Every call is
/// collective over the ranks of the communicator, from the thread that has initialised MPI.
class Neighbourhood {
 public:
  using Bytes = std::vector<std::byte>;

  /// @param ranks  ascending, without this one; each of them names this one, too
  Neighbourhood(MPI_Comm comm, std::vector<int> ranks);
  ~Neighbourhood();  ///< collective, unless something is thrown
  Neighbourhood(const Neighbourhood&) = delete;
  Neighbourhood& operator=(const Neighbourhood&) = delete;

  const std::vector<int>& ranks() const { return ranks_; }
  /// The number of a rank among ranks(). \pre it is there
  std::size_t number(int rank) const;
  /// Messages of any length, one for each neighbour, in the order of ranks(). \throw std::length_error above 2 GB
  std::vector<Bytes> exchange(const std::vector<Bytes>& out);
  /// The same where both sides know how long messages are.
  /// @param in  of the lengths that come
  void exchange(const std::vector<Bytes>& out, std::vector<Bytes>& in);
  std::size_t sum(std::size_t n);
  std::size_t max(std::size_t n);

  const Traffic& traffic() const { return traffic_; }

 private:
  MPI_Comm comm_;
  MPI_Comm graph_;
  std::vector<int> ranks_;
  Traffic traffic_;
  const Unwinding unwinding_;
};

/// Appends the bytes of a value that has no pointers.
template <class T>
void put(Neighbourhood::Bytes& bytes, const T& value) {
  const auto* first = reinterpret_cast<const std::byte*>(&value);
  bytes.insert(bytes.end(), first, first + sizeof(T));
}

/// The value at `at`, which goes on behind it.
template <class T>
T take(const Neighbourhood::Bytes& bytes, std::size_t& at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  at += sizeof(T);
  return value;
}

}  // namespace umtet
