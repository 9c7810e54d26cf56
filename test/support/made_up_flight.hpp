#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "bus/convert/convert.hpp"
#include "core/angle.hpp"
#include "core/pose.hpp"
#include "scenario/reader/scenario_yaml.hpp"
#include "test/support/flight_invariants.hpp"

namespace vantage::test {

inline constexpr Time kStart = from_utime(1'700'000'000'000'000);
inline constexpr double kFollowS = 2.0;
inline constexpr double kLandS = 18.0;

/// An artificial flight: Q1 and Q2 of the lab oscillate about their starts; Q3 stays on the ground
/// and is not visible.
class MadeUpFlight {
 public:
  /// These functions may change the message at `t_s`; they return false to omit it.
  std::function<bool(double t_s, models::VehicleStatus&)> says =
      [](double, models::VehicleStatus&) { return true; };
  std::function<bool(double t_s, models::TruthBody&)> is = [](double, models::TruthBody&) {
    return true;
  };
  std::function<void(double t_s, FlightRecord&)> add_messages = [](double, FlightRecord&) {};
  /// Content of the SCENARIO message.
  std::string yaml = scenario::load_scenario(VANTAGE_SOURCE_DIR "/config/lab.yaml").source_text;

  [[nodiscard]] FlightRecord record() const {
    FlightRecord out;
    models::ScenarioNotice notice;
    notice.stamp.time = kStart;
    notice.yaml = yaml;
    give(out, "SCENARIO", kStart, notice);
    for (int i = 0; i <= 1000; ++i) {
      const double t_s = 0.02 * i;
      tell_truth(out, t_s, i);
      if (i % 5 == 0) {
        tell_state(out, "Q1", t_s, i / 5);
        tell_state(out, "Q2", t_s, i / 5);
      }
      add_messages(t_s, out);
    }
    return out;
  }

  /// Passes a message to the record in the form in which LCM's log contains it.
  template <class Message>
  static void give(FlightRecord& record, const std::string& channel, Time now,
                   const Message& message) {
    const auto wire = bus::to_wire(message);
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(wire.getEncodedSize()));
    wire.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
    lcm::LogEvent event;
    event.channel = channel;
    event.timestamp = to_utime(now);
    event.data = bytes.data();
    event.datalen = static_cast<std::int32_t>(bytes.size());
    record.take(event);
  }
  static Time at(double t_s) { return kStart + from_seconds(t_s); }
  static models::VehicleStatus state_of(const std::string& robot, double t_s) {
    models::VehicleStatus out;
    out.stamp = {at(t_s), robot == "Q1" ? 11 : 12, 0};
    out.robot = robot;
    out.state = t_s < 1.0        ? models::FlightState::kIdle
                : t_s < kFollowS ? models::FlightState::kHold
                : t_s < kLandS   ? models::FlightState::kFollow
                                 : models::FlightState::kLand;
    out.setpoint = {place_m(robot, t_s).x(), place_m(robot, t_s).y(), wrap_to_pi(0.5 * t_s)};
    out.setpoint_height_m = 1.0;
    return out;
  }

 private:
  static Eigen::Vector3d place_m(const std::string& robot, double t_s) {
    return {(robot == "Q1" ? -3.0 : 0.0) + 0.5 * std::sin(t_s), 0.0, 1.0};
  }
  void tell_state(FlightRecord& out, const std::string& robot, double t_s, int sequence) const {
    models::VehicleStatus status = state_of(robot, t_s);
    status.stamp.sequence = sequence;
    if (says(t_s, status)) {
      give(out, "VEHICLE_" + robot, at(t_s), status);
    }
  }
  void tell_truth(FlightRecord& out, double t_s, int sequence) const {
    models::TruthFrame truth;
    truth.stamp = {at(t_s), 7, sequence};
    for (const char* const robot : {"Q1", "Q2"}) {
      models::TruthBody body;
      body.name = robot;
      body.world_from_body = lift({0.0, 0.0, 0.5 * t_s}, 0.0);
      body.world_from_body.translation_m = place_m(robot, t_s);
      body.velocity_world_mps = {0.5 * std::cos(t_s), 0.0, 0.0};
      if (is(t_s, body)) {
        truth.bodies.push_back(body);
      }
    }
    give(out, "TRUTH", at(t_s), truth);
  }
};

/// Returns the violated invariants with their robots, e.g. "Q1 speed".
inline std::vector<std::string> broken(const FlightRecord& record,
                                       const FlightBounds& bounds = {}) {
  std::vector<std::string> out;
  for (const std::string& line : violations(record, bounds)) {
    out.push_back(line.substr(0, line.find(':')));
  }
  return out;
}

/// True at one time between two status messages.
inline bool is_between_words(double t_s) { return std::abs(t_s - 9.05) < 0.025; }

}  // namespace vantage::test
