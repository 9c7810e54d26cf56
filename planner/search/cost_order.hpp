#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "core/reserved_array.hpp"
#include "planner/search/tree.hpp"

namespace vantage::planner {

/// Queue of nodes by ascending cost, stable for equal costs. Uses a radix sort in bounded steps, so
/// that a search can stop during the sort. O(n), about 15 ns per node. Allocates nothing after
/// construction.
class CostOrder {
 public:
  explicit CostOrder(std::size_t entries_max);

  /// See Tree::prefault().
  void prefault();

  void clear();
  /// Adds a node. Precondition: the queue is not full, and `cost` is not NaN.
  void add(double cost, NodeId id) { entries_[count_++] = {key_of(cost), id}; }

  /// Sorts the entries added since clear(). Calls `go_on()` at least once per kStep entries of work
  /// and returns false as soon as go_on() does; the order is then invalid until clear().
  template <class GoOn>
  [[nodiscard]] bool sort(GoOn&& go_on);

  /// True if pop() has no more entries. Call after sort().
  [[nodiscard]] bool is_empty() const { return next_ == count_; }
  [[nodiscard]] bool is_next_before(double cost) const {
    return entries_[next_].key < key_of(cost);
  }
  NodeId pop() { return entries_[next_++].id; }

  [[nodiscard]] std::size_t size() const { return count_; }
  [[nodiscard]] static std::size_t bytes_per_entry() { return 2 * sizeof(Entry); }

 private:
  static constexpr std::size_t kStep = 512;
  /// up to this number of entries, one step of a few µs sorts all of them
  static constexpr std::size_t kFew = 160;
  static constexpr int kDigitBits = 11;
  static constexpr int kDigits = 6;
  static constexpr std::size_t kRadix = std::size_t{1} << kDigitBits;
  struct Entry {
    std::uint64_t key = 0;
    NodeId id = kNoNode;
  };
  /// Maps `cost` to an integer with the same order; valid also for negative costs.
  static std::uint64_t key_of(double cost);
  static std::size_t digit_of(std::uint64_t key, int digit) {
    return (key >> (kDigitBits * digit)) & (kRadix - 1);
  }
  void sort_few();
  void count_digits(std::size_t begin, std::size_t end);
  /// Converts the counts of `digit` into start positions; false if all entries have the same digit.
  bool place(int digit);
  void scatter(int digit, std::size_t begin, std::size_t end);

  ReservedArray<Entry> entries_;
  ReservedArray<Entry> other_;  ///< output of a radix pass
  std::size_t count_ = 0;
  std::size_t next_ = 0;
  std::array<std::array<std::uint32_t, kRadix>, kDigits> places_{};
};

template <class GoOn>
bool CostOrder::sort(GoOn&& go_on) {
  if (count_ <= kFew) {
    sort_few();
    return true;
  }
  const auto by_steps = [&](const auto& work) {
    for (std::size_t begin = 0; begin < count_; begin += kStep) {
      work(begin, std::min(begin + kStep, count_));
      if (!go_on()) {
        return false;
      }
    }
    return true;
  };
  places_ = {};
  if (!by_steps([this](std::size_t begin, std::size_t end) { count_digits(begin, end); })) {
    return false;
  }
  for (int digit = 0; digit < kDigits; ++digit) {
    if (!place(digit)) {
      continue;
    }
    if (!by_steps([&](std::size_t begin, std::size_t end) { scatter(digit, begin, end); })) {
      return false;
    }
    std::swap(entries_, other_);
  }
  return true;
}

}  // namespace vantage::planner
