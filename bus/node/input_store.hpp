#pragma once

#include <cstddef>
#include <deque>
#include <string>
#include <utility>

#include "models/exchange/messages.hpp"

namespace vantage::bus {

/// Remembers the newest messages of one kind by name, so that a replayed node can be given exactly
/// those that the original consumed. Bounded: the oldest is forgotten.
template <class Message>
class InputStore {
 public:
  explicit InputStore(std::size_t capacity) : capacity_(capacity) {}

  void add(const std::string& channel, const Message& message) {
    if (messages_.size() == capacity_) {
      messages_.pop_front();
    }
    messages_.emplace_back(channel, message);
  }

  /// nullptr when it was never heard, or too long ago. Newest first: O(age).
  [[nodiscard]] const Message* find(const models::InputRef& name) const {
    for (auto it = messages_.rbegin(); it != messages_.rend(); ++it) {
      if (it->second.stamp.sequence == name.sequence && it->second.stamp.run_id == name.run_id &&
          it->first == name.channel) {
        return &it->second;
      }
    }
    return nullptr;
  }

 private:
  std::size_t capacity_;
  std::deque<std::pair<std::string, Message>> messages_;
};

}  // namespace vantage::bus
