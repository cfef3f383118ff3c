#pragma once

#include <mpi.h>

#include <cstddef>
#include <cstring>
#include <vector>

#include "distributed/exchange/unwinding.h"

namespace umtet {

/// Communication statistics of a rank.
struct Traffic {
  std::size_t exchanges = 0;   ///< neighbourhood collectives
  std::size_t reductions = 0;  ///< collectives over all ranks
  std::size_t messages = 0;    ///< non-empty messages, to one neighbour each
  std::size_t bytes = 0;       ///< in these messages
};

/// Exchange with neighbouring ranks by MPI's neighbourhood collectives, and reductions over all ranks. Every call is
/// collective over the communicator, and made from the thread that initialised MPI.
class Neighbourhood {
 public:
  using Bytes = std::vector<std::byte>;

  /// @param ranks  the neighbours of this rank, ascending, without the rank itself; the relation must be symmetric
  Neighbourhood(MPI_Comm comm, std::vector<int> ranks);
  ~Neighbourhood();  ///< collective, unless an exception is propagating
  Neighbourhood(const Neighbourhood&) = delete;
  Neighbourhood& operator=(const Neighbourhood&) = delete;

  const std::vector<int>& ranks() const { return ranks_; }
  /// Returns the index of a rank in ranks(). \pre it is a neighbour
  std::size_t number(int rank) const;
  /// Exchanges one message of any length with each neighbour, in the order of ranks().
  /// \throw std::length_error  above 2 GB
  std::vector<Bytes> exchange(const std::vector<Bytes>& out);
  /// Exchanges messages whose lengths both sides know.
  /// @param in  must have the lengths of the incoming messages
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

/// Appends the bytes of a value without pointers.
template <class T>
void put(Neighbourhood::Bytes& bytes, const T& value) {
  const auto* first = reinterpret_cast<const std::byte*>(&value);
  bytes.insert(bytes.end(), first, first + sizeof(T));
}

/// Reads the value at position `at`, and advances `at`.
template <class T>
T take(const Neighbourhood::Bytes& bytes, std::size_t& at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof(T));
  at += sizeof(T);
  return value;
}

}  // namespace umtet
