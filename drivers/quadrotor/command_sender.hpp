#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "wire/mavlink/messages.hpp"

namespace vantage::drivers {

/// Sender of commands. It repeats each command, with an increasing confirmation field, until the
/// command is acknowledged or given up. At most one command of each kind (command id) is pending.
/// Source: MAVLink developer guide, command protocol.
class CommandSender {
 public:
  /// Result of a command.
  struct Outcome {
    std::optional<std::uint8_t> result;  ///< result in the acknowledgement; nullopt: no answer
    Time time{};
    [[nodiscard]] bool is_accepted() const { return result && *result == 0; }
  };

  /// Sends `command`, unless the same command is pending or ended less than `pause` ago. A
  /// different pending command with the same id is replaced.
  void send_command(const wire::mavlink::CommandLong& command, Time now, Duration pause);
  /// Sends `command` every `period` while this function is called, regardless of answers (emergency
  /// stop).
  void send_command_periodically(const wire::mavlink::CommandLong& command, Time now,
                                 Duration period);
  void acknowledge(const wire::mavlink::CommandAck& ack, Time now);
  /// Returns the commands to send now.
  std::vector<wire::mavlink::CommandLong> due(Time now);

  [[nodiscard]] bool is_under_way(std::uint16_t command) const;
  /// Returns the result of the newest completed command of this kind.
  [[nodiscard]] std::optional<Outcome> outcome(std::uint16_t command) const;
  /// Returns the number of commands given up without an answer.
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
  std::map<std::uint16_t, Entry> entries_;  ///< commands by command id; the driver uses few ids
  std::int64_t unanswered_ = 0;
};

}  // namespace vantage::drivers
