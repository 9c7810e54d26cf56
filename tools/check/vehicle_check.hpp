#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "drivers/quadrotor/autopilot_link.hpp"
#include "scenario/scenario.hpp"

namespace vantage::tools {

/// A vehicle's autopilot looked at without flying it: its parameters read back, and mended when
/// told to. Bytes in, bytes out; handed time. It never arms, and sets nothing on an armed vehicle.
class VehicleCheck {
 public:
  /// How long it waits for an autopilot to be heard.
  static constexpr Duration kHeardWithin = std::chrono::seconds(10);

  /// @throws UsageError for a robot without an autopilot.
  VehicleCheck(const scenario::RobotSpec& robot,
               const std::optional<wire::mavlink::SigningKey>& key, Time now);

  /// Returns true if a frame of the vehicle was complete with these bytes.
  bool receive(std::span<const std::uint8_t> bytes, bool is_datagram, Time now) {
    return link_.receive(bytes, is_datagram, now);
  }
  void tick(Time now) { link_.tick(now); }
  std::vector<drivers::WireMessage> take_output() { return link_.take_output(); }

  /// Has every parameter that breaks its rule set; what is there to be set is read then.
  void load();

  /// Everything is read, or will not be.
  [[nodiscard]] bool is_done(Time now) const;
  /// Why it cannot be read, in words; nullopt when it can.
  [[nodiscard]] std::optional<std::string> fault(Time now) const;
  /// Those whose rule is broken, by the order of the rules.
  [[nodiscard]] std::vector<drivers::ParameterCheck::Entry> differences() const;
  /// Nothing that differs forbids a flight.
  [[nodiscard]] bool is_ready(Time now) const {
    return !fault(now) && link_.parameters().is_kept();
  }
  [[nodiscard]] const std::string& robot() const { return robot_; }
  [[nodiscard]] models::AutopilotDialect dialect() const { return spec_.dialect; }
  [[nodiscard]] std::size_t settled() const { return link_.parameters().settled(); }
  [[nodiscard]] std::size_t size() const { return link_.parameters().entries().size(); }

 private:
  std::string robot_;
  scenario::AutopilotSpec spec_;
  drivers::AutopilotLink link_;
  Time started_;
};

/// The robots of a scenario that have an autopilot at the end of a wire.
std::vector<const scenario::RobotSpec*> robots_with_autopilot(const scenario::Scenario& scenario);

/// What was found, a line each: the differences as a table, or that there is none.
std::vector<std::string> describe(const VehicleCheck& vehicle, Time now);

}  // namespace vantage::tools
