#include "drivers/quadrotor/telemetry.hpp"

#include <algorithm>
#include <chrono>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "wire/mavlink/constants.hpp"
#include "wire/mavlink/messages.hpp"
#include "wire/mavlink/single.hpp"

namespace vantage::drivers {
namespace {

using models::AutopilotDialect;
constexpr Time kNow = from_utime(1'700'000'000'000'000);

struct Bench {
  explicit Bench(AutopilotDialect dialect) : telemetry(dialect) {}

  template <class Message>
  void receive(const Message& message, Time now) {
    telemetry.take(wire::mavlink::pack(message, {1, wire::mavlink::kComponentAutopilot, 0}), now);
  }

  Telemetry telemetry;
};

TEST(Telemetry, IgnoresNonFinitePositions) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  using Position = wire::mavlink::LocalPositionNed;
  for (const auto field :
       {&Position::x, &Position::y, &Position::z, &Position::vx, &Position::vy, &Position::vz}) {
    for (const float value : {kNan, kInfinity, -kInfinity}) {
      Bench bench(AutopilotDialect::kPx4);
      bench.receive(Position{}, kNow);
      ASSERT_TRUE(bench.telemetry.position_world_m(kNow).has_value());
      Position bad;
      bad.*field = value;
      const Time later = kNow + std::chrono::milliseconds(501);
      bench.receive(bad, later);
      EXPECT_FALSE(bench.telemetry.position_world_m(later).has_value());
    }
  }
}

TEST(Telemetry, IgnoresNonFiniteAttitudes) {
  using wire::mavlink::Attitude;
  for (const auto field :
       {&Attitude::roll, &Attitude::pitch, &Attitude::yaw, &Attitude::yawspeed}) {
    for (const float value :
         {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
      Bench bench(AutopilotDialect::kPx4);
      bench.receive(Attitude{}, kNow);
      ASSERT_TRUE(bench.telemetry.has_attitude(kNow));
      Attitude bad;
      bad.*field = value;
      const Time later = kNow + std::chrono::milliseconds(501);
      bench.receive(bad, later);
      EXPECT_FALSE(bench.telemetry.has_attitude(later));
      EXPECT_EQ(bench.telemetry.tilt_rad(), 0.0);
      EXPECT_EQ(bench.telemetry.yaw_rate_radps(), 0.0);
    }
  }
}

// Each dialect reports motor faults in its own way; the report of the other dialect is ignored.
TEST(Telemetry, DetectsMotorFaultsPerDialect) {
  using wire::mavlink::kSensorMotorOutputs;
  struct Row {
    const char* what;
    AutopilotDialect dialect;
    std::uint32_t present, enabled, healthy;
    std::string text;
    bool is_fault;
  };
  constexpr std::uint32_t kAll = 0xFFFF'FFFFU;
  const Row table[] = {
      {"healthy", AutopilotDialect::kPx4, kAll, kAll, kAll, "", false},
      {"unhealthy", AutopilotDialect::kPx4, kAll, kAll, ~kSensorMotorOutputs, "", true},
      {"not present", AutopilotDialect::kPx4, 0, kAll, 0, "", false},
      {"not enabled", AutopilotDialect::kPx4, kAll, 0, 0, "", false},
      {"another sensor", AutopilotDialect::kPx4, kAll, kAll, kSensorMotorOutputs, "", false},
      {"ArduPilot's text", AutopilotDialect::kPx4, kAll, kAll, kAll, "Potential Thrust Loss (3)",
       false},
      {"ArduPilot's text", AutopilotDialect::kArdupilot, kAll, kAll, kAll,
       "Potential Thrust Loss (3)", true},
      {"another text", AutopilotDialect::kArdupilot, kAll, kAll, kAll, "EKF variance", false},
      {"PX4's bit", AutopilotDialect::kArdupilot, kAll, kAll, 0, "", false},
  };
  for (const Row& row : table) {
    SCOPED_TRACE(row.what);
    Bench bench(row.dialect);
    wire::mavlink::SysStatus system;
    system.onboard_control_sensors_present = row.present;
    system.onboard_control_sensors_enabled = row.enabled;
    system.onboard_control_sensors_health = row.healthy;
    bench.receive(system, kNow);
    wire::mavlink::Statustext text;
    std::copy(row.text.begin(), row.text.end(), text.text.begin());
    bench.receive(text, kNow);
    EXPECT_EQ(bench.telemetry.has_motor_fault(kNow), row.is_fault);
    system.onboard_control_sensors_health = kAll;
    bench.receive(system, kNow + std::chrono::seconds(1));
    EXPECT_FALSE(bench.telemetry.has_motor_fault(kNow + std::chrono::seconds(11)));
  }
}

// The lowest of all battery reports applies, in any order of ids.
TEST(Telemetry, ReportsTheLowestBattery) {
  struct Report {
    int id;  ///< battery id; negative: reported in SYS_STATUS
    std::int8_t percent;
    int at_s;
  };
  struct Row {
    const char* what;
    std::vector<Report> reports;
    double share;  ///< reported share; negative: unknown
  };
  const Row rows[] = {
      {"two packs", {{0, 90, 0}, {1, 5, 0}}, 0.05},
      {"two packs, the emptier first", {{1, 5, 0}, {0, 90, 1}}, 0.05},
      {"the second id alone", {{1, 80, 0}}, 0.8},
      {"a full pack, and the system's charge lower", {{0, 90, 0}, {-1, 5, 0}}, 0.05},
      {"the system's charge before the pack's", {{-1, 5, 0}, {0, 90, 0}}, 0.05},
      {"a pack without a charge", {{0, 90, 0}, {1, -1, 0}}, 0.9},
      {"no pack has a charge", {{0, -1, 0}, {1, -1, 0}}, -1.0},
      {"a pack that was last reported 11 s ago", {{1, 5, 0}, {0, 90, 11}}, 0.9},
      {"a pack that was last reported 9 s ago", {{1, 5, 0}, {0, 90, 9}}, 0.05},
  };
  for (const Row& row : rows) {
    SCOPED_TRACE(row.what);
    Bench bench(AutopilotDialect::kPx4);
    for (const Report& report : row.reports) {
      const Time at = kNow + std::chrono::seconds(report.at_s);
      if (report.id < 0) {
        wire::mavlink::SysStatus system;
        system.battery_remaining = report.percent;
        bench.receive(system, at);
      } else {
        wire::mavlink::BatteryStatus battery;
        battery.id = static_cast<std::uint8_t>(report.id);
        battery.battery_remaining = report.percent;
        bench.receive(battery, at);
      }
    }
    EXPECT_DOUBLE_EQ(bench.telemetry.battery_share().value_or(-1.0), row.share);
  }
}

}  // namespace
}  // namespace vantage::drivers
