#pragma once

#include <mpi.h>

#include <cstddef>
#include <utility>
#include <vector>

#include "distributed/exchange/all_to_all.h"

namespace umtet {

/// Exchange of data on shared items, such as vertices or edges, between the ranks that have them and the one rank that
/// owns each.
class OwnerExchange {
 public:
  /// @param n_owned  number of items that this rank owns, on any rank
  /// @param asked    for each rank, the local items that the other rank owns
  /// @param wanted   for each rank, the indices of items that this rank owns and the other rank has, in the order of
  ///                 the other rank
  OwnerExchange(MPI_Comm comm, std::size_t n_items, std::size_t n_owned, std::vector<std::vector<std::size_t>> asked,
                std::vector<std::vector<std::size_t>> wanted)
      : comm_(comm), n_items_(n_items), n_owned_(n_owned), asked_(std::move(asked)), wanted_(std::move(wanted)) {}

  std::size_t n_items() const { return n_items_; }
  std::size_t n_owned() const { return n_owned_; }

  /// Sends values from owners to all ranks that have the items. Collective.
  /// @param of_owned  one value per owned item
  /// @return one value per local item
  template <class T>
  std::vector<T> tell(const std::vector<T>& of_owned) const {
    std::vector<std::vector<T>> out(wanted_.size());
    for (std::size_t r = 0; r < out.size(); ++r)
      for (const std::size_t k : wanted_[r]) out[r].push_back(of_owned[k]);
    std::vector<T> told(n_items_);
    const auto in = all_to_all(comm_, out);
    for (std::size_t r = 0; r < in.size(); ++r)
      for (std::size_t k = 0; k < in[r].size(); ++k) told[asked_[r][k]] = in[r][k];
    return told;
  }
  /// Sends values from all ranks that have items to the owners: take(index, value) is called once per rank that has the
  /// item. Collective.
  /// @param value  function of an item; its result contains no pointers
  template <class Value, class Take>
  void ask(const Value& value, const Take& take) const {
    using T = decltype(value(std::size_t{0}));
    std::vector<std::vector<T>> out(asked_.size());
    for (std::size_t r = 0; r < out.size(); ++r)
      for (const std::size_t v : asked_[r]) out[r].push_back(value(v));
    const auto in = all_to_all(comm_, out);
    for (std::size_t r = 0; r < in.size(); ++r)
      for (std::size_t k = 0; k < in[r].size(); ++k) take(wanted_[r][k], in[r][k]);
  }

  /// Returns for each owned item the logical or over all ranks that have the item. Collective.
  /// @param of_items  0 or 1 for each local item
  template <class T>
  std::vector<T> any_of_owned(const std::vector<T>& of_items) const {
    std::vector<T> owned(n_owned_, 0);
    ask([&](std::size_t item) { return of_items[item]; }, [&](std::size_t k, T is_so) { owned[k] |= is_so; });
    return owned;
  }
  /// Returns for each local item the logical or over all ranks that have the item. Collective.
  template <class T>
  std::vector<T> any(const std::vector<T>& of_items) const {
    return tell(any_of_owned(of_items));
  }

  /// Combines two exchanges between the same ranks: items and owned items of the second follow those of the first.
  friend OwnerExchange joined(const OwnerExchange& first, const OwnerExchange& second) {
    OwnerExchange both = first;
    both.n_items_ += second.n_items_;
    both.n_owned_ += second.n_owned_;
    for (std::size_t r = 0; r < both.asked_.size(); ++r) {
      for (const std::size_t item : second.asked_[r]) both.asked_[r].push_back(first.n_items_ + item);
      for (const std::size_t k : second.wanted_[r]) both.wanted_[r].push_back(first.n_owned_ + k);
    }
    return both;
  }

 private:
  MPI_Comm comm_;
  std::size_t n_items_, n_owned_;
  std::vector<std::vector<std::size_t>> asked_, wanted_;
};

}  // namespace umtet
