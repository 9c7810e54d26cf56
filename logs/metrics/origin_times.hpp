#pragma once

#include <cstddef>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <tuple>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::logs {

/// Store of one time per message for the newest kKept messages, keyed by message name.
class OriginTimes {
 public:
  void add(const models::InputRef& name, Time time) {
    const Key key{name.channel, name.run_id, name.sequence};
    if (times_.insert_or_assign(key, time).second) {
      order_.push_back(key);
    }
    if (order_.size() > kKept) {
      times_.erase(order_.front());
      order_.pop_front();
    }
  }

  /// Returns the latest stored time of the messages in `names`; nullopt if no time is stored.
  [[nodiscard]] std::optional<Time> newest(std::span<const models::InputRef> names) const {
    std::optional<Time> newest;
    for (const models::InputRef& name : names) {
      const auto found = times_.find({name.channel, name.run_id, name.sequence});
      if (found != times_.end() && (!newest || found->second > *newest)) {
        newest = found->second;
      }
    }
    return newest;
  }

 private:
  static constexpr std::size_t kKept = 20'000;
  using Key = std::tuple<std::string, std::int64_t, std::int64_t>;
  std::map<Key, Time> times_;
  std::deque<Key> order_;
};

}  // namespace vantage::logs
