#pragma once

#include <cstdint>
#include <iterator>
#include <map>

namespace vantage::logs {

/// Set of integers, stored as runs of consecutive numbers. Consecutive numbers, inserted in any
/// order, use the memory of one run.
class RunSet {
 public:
  void insert(std::int64_t number) {
    const auto after = runs_.upper_bound(number);
    const auto before = after == runs_.begin() ? runs_.end() : std::prev(after);
    if (before != runs_.end() && number <= before->second) {
      return;
    }
    ++size_;
    const bool joins_after = after != runs_.end() && after->first == number + 1;
    const std::int64_t last = joins_after ? after->second : number;
    if (joins_after) {
      runs_.erase(after);
    }
    if (before != runs_.end() && before->second + 1 == number) {
      before->second = last;
    } else {
      runs_.emplace(number, last);
    }
  }
  [[nodiscard]] std::int64_t size() const { return size_; }
  [[nodiscard]] std::int64_t runs() const { return std::ssize(runs_); }

 private:
  std::map<std::int64_t, std::int64_t> runs_;  ///< first to last number of each run
  std::int64_t size_ = 0;
};

}  // namespace vantage::logs
