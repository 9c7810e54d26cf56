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

/// The driver's end of the rover protocol: numbers what it says, and believes only what is news
/// from its own rover. Allocates nothing but in count().
class RoverLink {
 public:
  /// @param session  any number; 0 is taken as 1
  RoverLink(std::uint32_t number, std::uint32_t session);

  std::array<std::uint8_t, wire::rover::kCommandBytes> command(
      const models::UnicycleControl& control, std::uint32_t flags, Time now);
  /// True when it is news of our rover.
  bool receive(std::span<const std::uint8_t> datagram, Time now);

  [[nodiscard]] bool has_telemetry() const { return has_telemetry_; }
  /// The newest; zeros before any.
  [[nodiscard]] const wire::rover::Telemetry& telemetry() const { return telemetry_; }
  [[nodiscard]] bool has_flag(std::uint32_t flag) const { return (telemetry_.flags & flag) != 0; }
  /// Since the newest telemetry came; infinite before any.
  [[nodiscard]] double heard_age_s(Time now) const;
  /// Since the newest of our commands that the rover says it has taken was sent: both directions
  /// of the wire in one number. Infinite before any.
  [[nodiscard]] double obeyed_age_s(Time now) const;
  /// False while the rover says that it takes commands from another session.
  [[nodiscard]] bool is_ours() const;
  void count(std::vector<models::NamedCount>& out) const;

 private:
  std::uint32_t number_;
  std::uint32_t session_;
  std::uint32_t sequence_ = 0;
  bool has_telemetry_ = false;
  wire::rover::Telemetry telemetry_;
  Time heard_{};
  bool is_obeyed_ = false;
  Time obeyed_{};
  std::array<std::int64_t, wire::rover::kVerdicts> verdicts_{};
  std::int64_t misaddressed_ = 0;
  std::int64_t late_ = 0;      ///< older than what was heard before
  std::int64_t restarts_ = 0;  ///< of the rover
};

}  // namespace vantage::drivers
