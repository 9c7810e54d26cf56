#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "bus/transport/channel_pattern.hpp"

namespace vantage::bus {

/// Hash of a name that also supports lookup by string_view.
struct NameHash {
  using is_transparent = void;
  std::size_t operator()(std::string_view name) const {
    return std::hash<std::string_view>{}(name);
  }
};

/// Values by channel name.
template <class Value>
using ByName = std::unordered_map<std::string, Value, NameHash, std::equal_to<>>;

/// Index from channel names to numbered subscriptions. Exact names are found by hash, at a cost
/// independent of the other subscriptions. Patterns ("PREFIX*") are compared one by one, so there
/// should be few. Removed numbers are reused, so all numbers are less than the largest number of
/// entries that existed simultaneously.
class ChannelIndex {
 public:
  /// Adds the pattern and returns its number: the last removed number, if any, otherwise the next
  /// unused number (0, 1, …).
  std::size_t add(const std::string& pattern) {
    const std::size_t number = free_.empty() ? count_++ : free_.back();
    if (!free_.empty()) {
      free_.pop_back();
    }
    if (pattern.ends_with('*')) {
      prefixes_.push_back({pattern, number});
    } else {
      std::vector<std::size_t>& numbers = exact_[pattern];
      numbers.insert(std::upper_bound(numbers.begin(), numbers.end(), number), number);
    }
    return number;
  }

  /// Removes all entries of exactly this pattern and returns their numbers.
  std::vector<std::size_t> remove(const std::string& pattern) {
    std::vector<std::size_t> numbers;
    if (const auto found = exact_.find(pattern); found != exact_.end()) {
      numbers = std::move(found->second);
      exact_.erase(found);
    }
    std::erase_if(prefixes_, [&](const Prefix& each) {
      const bool is_it = each.pattern == pattern;
      if (is_it) {
        numbers.push_back(each.number);
      }
      return is_it;
    });
    free_.insert(free_.end(), numbers.begin(), numbers.end());
    return numbers;
  }

  /// True if the index contains exactly this pattern.
  [[nodiscard]] bool contains(const std::string& pattern) const {
    return exact_.contains(pattern) ||
           std::any_of(prefixes_.begin(), prefixes_.end(),
                       [&](const Prefix& each) { return each.pattern == pattern; });
  }

  /// Returns the smallest number ≥ `from` of a pattern that matches `channel`.
  [[nodiscard]] std::optional<std::size_t> next(std::string_view channel, std::size_t from) const {
    std::optional<std::size_t> least;
    if (const auto found = exact_.find(channel); found != exact_.end()) {
      const std::vector<std::size_t>& numbers = found->second;
      const auto at = std::lower_bound(numbers.begin(), numbers.end(), from);
      if (at != numbers.end()) {
        least = *at;
      }
    }
    for (const Prefix& each : prefixes_) {
      if (each.number >= from && (!least || each.number < *least) &&
          channel_matches(each.pattern, channel)) {
        least = each.number;
      }
    }
    return least;
  }

 private:
  struct Prefix {
    std::string pattern;
    std::size_t number = 0;
  };
  std::size_t count_ = 0;
  std::vector<std::size_t> free_;  ///< unused numbers below count_
  ByName<std::vector<std::size_t>> exact_;
  std::vector<Prefix> prefixes_;
};

}  // namespace vantage::bus
