#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "wire/mavlink/messages.hpp"

namespace vantage::drivers {

/// Sends commands until they are answered. One of each kind is under way at a time; it is repeated
/// with a growing confirmation until an acknowledgement comes or nobody answers.
/// Source: MAVLink developer guide, command protocol.
class CommandSender {
 public:
  /// How a command ended.
  struct Outcome {
    std::optional<std::uint8_t> result;  ///< of the acknowledgement; none: nobody answered
    Time time{};
    [[nodiscard]] bool is_accepted() const { return result && *result == 0; }
  };

  /// Has `command` sent, unless the same is under way or ended less than `pause` ago. Another of
  /// its kind is given up for it.
  void want(const wire::mavlink::CommandLong& command, Time now, Duration pause);
  /// Has `command` sent each `period` for as long as it is asked, whatever is answered (emergency
  /// stop).
  void insist(const wire::mavlink::CommandLong& command, Time now, Duration period);
  void acknowledge(const wire::mavlink::CommandAck& ack, Time now);
  /// What is to be sent now.
  std::vector<wire::mavlink::CommandLong> due(Time now);

  [[nodiscard]] bool is_under_way(std::uint16_t command) const;
  /// Of the newest of its kind that ended.
  [[nodiscard]] std::optional<Outcome> outcome(std::uint16_t command) const;
  /// Commands that were given up because nobody answered.
  [[nodiscard]] std::int64_t unanswered() const { return unanswered_; }

 private:
  struct Entry {
    wire::mavlink::CommandLong command;
    bool is_under_way = false;
    int sent = 0;
    Time last_send{};
    Time next_send{};
    std::optional<Outcome> outcome;
  };
  std::map<std::uint16_t, Entry> entries_;  ///< by command; the driver has a handful of kinds
  std::int64_t unanswered_ = 0;
};

}  // namespace vantage::drivers
