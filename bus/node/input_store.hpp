#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <string>
#include <unordered_map>

#include "models/exchange/messages.hpp"

namespace vantage::bus {

/// The newest messages of one kind on each channel, from which a replayed node is given exactly the
/// inputs of the original. A node keeps naming the last message of a silent sender as its input.
/// Bounded: the oldest message of a channel is dropped.
template <class Message>
class InputStore {
 public:
  /// @param capacity  messages kept per channel; > 0
  explicit InputStore(std::size_t capacity) : capacity_(capacity) {}

  void add(const std::string& channel, const Message& message) {
    std::deque<Message>& messages = messages_[channel];
    if (messages.size() == capacity_) {
      messages.pop_front();
    }
    messages.push_back(message);
  }

  /// Returns the message `name`; nullptr when it was never received or was dropped. Searches from
  /// the newest: O(age).
  [[nodiscard]] const Message* find(const models::InputRef& name) const {
    const auto found = messages_.find(name.channel);
    if (found == messages_.end()) {
      return nullptr;
    }
    const std::deque<Message>& messages = found->second;
    const auto message = std::find_if(messages.rbegin(), messages.rend(), [&](const Message& each) {
      return each.stamp.sequence == name.sequence && each.stamp.run_id == name.run_id;
    });
    return message == messages.rend() ? nullptr : &*message;
  }

 private:
  std::size_t capacity_;
  std::unordered_map<std::string, std::deque<Message>> messages_;  ///< by channel
};

}  // namespace vantage::bus
