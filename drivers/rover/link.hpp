#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/time.hpp"
#include "models/exchange/messages.hpp"
#include "models/motion/unicycle.hpp"
#include "wire/rover/packet.hpp"

namespace vantage::drivers {

/// Driver side of the rover protocol. It numbers its commands and accepts only new telemetry of its
/// rover. Only count() allocates.
class RoverLink {
 public:
  /// @param session  any number; 0 is replaced by 1
  RoverLink(std::uint32_t number, std::uint32_t session);

  std::array<std::uint8_t, wire::rover::kCommandBytes> command(
      const models::UnicycleControl& control, std::uint32_t flags, Time now);
  /// Processes a datagram. Returns true if the datagram is new telemetry of this rover.
  bool receive(std::span<const std::uint8_t> datagram, Time now);

  [[nodiscard]] bool has_telemetry() const { return has_telemetry_; }
  /// Returns the newest telemetry; zeros before the first.
  [[nodiscard]] const wire::rover::Telemetry& telemetry() const { return telemetry_; }
  [[nodiscard]] bool has_flag(std::uint32_t flag) const { return (telemetry_.flags & flag) != 0; }
  /// Returns the time since the arrival of the newest telemetry, s; infinite before the first.
  [[nodiscard]] double receive_age_s(Time now) const;
  /// Returns the age of the newest command that the rover reports as accepted, s: the time since
  /// the command was sent, which covers both directions of the link. Infinite before the first.
  [[nodiscard]] double taken_command_age_s(Time now) const;
  /// False while the rover reports that it accepts commands from another session.
  [[nodiscard]] bool is_ours() const;
  void count(std::vector<models::NamedCount>& out) const;

 private:
  std::uint32_t number_;
  std::uint32_t session_;
  std::uint32_t sequence_ = 0;
  bool has_telemetry_ = false;
  wire::rover::Telemetry telemetry_;
  Time received_at_{};
  bool has_taken_command_ = false;
  Time taken_command_sent_at_{};
  std::array<std::int64_t, wire::rover::kVerdicts> verdicts_{};
  std::int64_t misaddressed_ = 0;
  std::int64_t late_ = 0;      ///< telemetry that was not newer than earlier telemetry
  std::int64_t restarts_ = 0;  ///< number of restarts of the rover
};

}  // namespace vantage::drivers
