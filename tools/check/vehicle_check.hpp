#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "drivers/quadrotor/autopilot_link.hpp"
#include "scenario/scenario.hpp"

namespace vantage::tools {

/// Check of a vehicle's autopilot on the ground. It reads the parameters, and load() corrects them.
/// The caller transfers the bytes and passes the time. The check never arms a vehicle, and writes
/// nothing to an armed vehicle.
class VehicleCheck {
 public:
  /// Longest wait for the first message of an autopilot.
  static constexpr Duration kFirstMessageTimeout = std::chrono::seconds(10);

  /// @throws UsageError if the robot has no autopilot.
  VehicleCheck(const scenario::RobotSpec& robot,
               const std::optional<wire::mavlink::SigningKey>& key, Time now);

  /// Handles received bytes. Returns true if they complete a frame of the vehicle.
  bool receive(std::span<const std::uint8_t> bytes, bool is_datagram, Time now) {
    return link_.receive(bytes, is_datagram, now);
  }
  void tick(Time now) { link_.tick(now); }
  std::vector<drivers::WireMessage> take_output() { return link_.take_output(); }

  /// Writes each parameter that violates its rule, and reads it back.
  void load();

  /// True if all parameters are read, or cannot be read (armed, or no answer).
  [[nodiscard]] bool is_done(Time now) const;
  /// Returns the reason why the parameters are not read; nullopt if they are read.
  [[nodiscard]] std::optional<std::string> fault(Time now) const;
  /// Returns the parameters that violate their rules, in the order of the rules.
  [[nodiscard]] std::vector<drivers::ParameterCheck::Entry> differences() const;
  /// True if the parameters are read and no difference forbids a flight.
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

/// Returns the robots of a scenario that have an autopilot with a URL and are not `direct`.
std::vector<const scenario::RobotSpec*> robots_with_autopilot(const scenario::Scenario& scenario);

/// Returns the result as lines: a table of the differences, a fault, or the statement that all
/// parameters are correct.
std::vector<std::string> describe(const VehicleCheck& vehicle, Time now);

}  // namespace vantage::tools
