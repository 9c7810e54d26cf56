#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <string>
#include <unordered_map>

#include "models/exchange/messages.hpp"

namespace vantage::bus {

/// Remembers the newest messages of one kind on each channel, so that a replayed node can be given
/// exactly those that the original consumed: it names the last one of who is silent for as long as
/// it runs. Bounded: the oldest of a channel is forgotten.
template <class Message>
class InputStore {
 public:
  /// @param capacity  of each channel, above 0
  explicit InputStore(std::size_t capacity) : capacity_(capacity) {}

  void add(const std::string& channel, const Message& message) {
    std::deque<Message>& messages = messages_[channel];
    if (messages.size() == capacity_) {
      messages.pop_front();
    }
    messages.push_back(message);
  }

  /// nullptr when it was never heard, or too long ago. Newest first: O(age).
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
