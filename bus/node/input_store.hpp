#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <string>
#include <unordered_map>

#include "models/exchange/messages.hpp"

namespace vantage::bus {

/// Store of the newest messages of one type per channel. A replayed node takes exactly the inputs
/// of the original node from the store. The messages are stored per channel, because the last
/// message of a silent sender can remain an input for a long time. When a channel is full, its
/// oldest message is dropped.
template <class Message>
class InputStore {
 public:
  /// @param capacity maximum number of messages per channel; > 0
  explicit InputStore(std::size_t capacity) : capacity_(capacity) {}

  void add(const std::string& channel, const Message& message) {
    std::deque<Message>& messages = messages_[channel];
    if (messages.size() == capacity_) {
      messages.pop_front();
    }
    messages.push_back(message);
  }

  /// Returns the message with name `name`; nullptr when it was never received or was dropped.
  /// Searches backwards from the newest message.
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
