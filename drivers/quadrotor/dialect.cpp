#include "drivers/quadrotor/dialect.hpp"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "wire/mavlink/constants.hpp"

namespace vantage::drivers {
namespace {

using models::AutopilotDialect;

constexpr std::uint32_t px4_mode(std::uint32_t main, std::uint32_t sub = 0) {
  return main << 16U | sub << 24U;
}

template <class Message>
WantedStream stream(double rate_hz) {
  return {Message::kMessage.id, rate_hz};
}

std::vector<WantedStream> streams_with(const WantedStream& estimator) {
  return {stream<wire::mavlink::LocalPositionNed>(20.0),
          stream<wire::mavlink::Attitude>(10.0),
          estimator,
          stream<wire::mavlink::ExtendedSysState>(5.0),
          stream<wire::mavlink::SysStatus>(1.0),
          stream<wire::mavlink::BatteryStatus>(1.0)};
}

DialectTraits px4() {
  DialectTraits out;
  out.name = "PX4";
  out.autopilot_id = wire::mavlink::autopilot::kPx4;
  out.own_system_id = 254;
  // PX4 sends the reason of a refusal only to ground stations
  out.own_type = wire::mavlink::type::kGroundStation;
  out.follow_mode = px4_mode(6);
  out.land_mode = px4_mode(4, 6);
  out.wants_proof_of_life = true;
  out.lead_s = 0.05;
  out.acceleration_lead_s = 0.05;
  out.streams = streams_with(stream<wire::mavlink::EstimatorStatus>(5.0));
  return out;
}

DialectTraits ardupilot() {
  DialectTraits out;
  out.name = "ArduPilot";
  out.autopilot_id = wire::mavlink::autopilot::kArdupilot;
  out.own_system_id = 255;  // ArduPilot's ground-station failsafe monitors this id
  out.own_type = wire::mavlink::type::kGroundStation;
  out.follow_mode = 4;
  out.land_mode = 9;
  out.takes_off_by_command = true;
  out.lead_s = 0.07;
  out.acceleration_lead_s = 0.16;
  out.needs_origin = true;
  out.streams = streams_with(stream<wire::mavlink::EkfStatusReport>(5.0));
  return out;
}

wire::mavlink::CommandLong set_mode(std::uint32_t main, std::uint32_t sub = 0) {
  wire::mavlink::CommandLong out;
  out.command = wire::mavlink::command::kSetMode;
  out.param1 = 1.0F;  // 1: use the custom mode
  out.param2 = static_cast<float>(main);
  out.param3 = static_cast<float>(sub);
  return out;
}

}  // namespace

const DialectTraits& traits_of(AutopilotDialect dialect) {
  static const DialectTraits kPx4 = px4();
  static const DialectTraits kArdupilot = ardupilot();
  return dialect == AutopilotDialect::kPx4 ? kPx4 : kArdupilot;
}

wire::mavlink::CommandLong follow_mode_command(AutopilotDialect dialect) {
  return dialect == AutopilotDialect::kPx4 ? set_mode(6) : set_mode(4);
}

wire::mavlink::CommandLong land_command(AutopilotDialect dialect) {
  if (dialect == AutopilotDialect::kArdupilot) {
    return set_mode(9);
  }
  wire::mavlink::CommandLong out;
  out.command = wire::mavlink::command::kLand;
  return out;
}

std::string mode_name(AutopilotDialect dialect, std::uint32_t custom_mode) {
  struct Name {
    std::uint32_t mode;
    const char* name;
  };
  static constexpr std::array<Name, 12> kPx4Modes{{{px4_mode(1), "manual"},
                                                   {px4_mode(2), "altitude"},
                                                   {px4_mode(3), "position"},
                                                   {px4_mode(4, 1), "ready"},
                                                   {px4_mode(4, 2), "take-off"},
                                                   {px4_mode(4, 3), "loiter"},
                                                   {px4_mode(4, 4), "mission"},
                                                   {px4_mode(4, 5), "return"},
                                                   {px4_mode(4, 6), "land"},
                                                   {px4_mode(5), "acro"},
                                                   {px4_mode(6), "offboard"},
                                                   {px4_mode(7), "stabilised"}}};
  static constexpr std::array<Name, 8> kArdupilotModes{{{0, "stabilize"},
                                                        {2, "alt-hold"},
                                                        {3, "auto"},
                                                        {4, "guided"},
                                                        {5, "loiter"},
                                                        {6, "return"},
                                                        {9, "land"},
                                                        {17, "brake"}}};
  const auto name_in = [custom_mode](const auto& names) -> std::string {
    for (const Name& known : names) {
      if (known.mode == custom_mode) {
        return known.name;
      }
    }
    return fmt::format("mode {:#x}", custom_mode);
  };
  return dialect == AutopilotDialect::kPx4 ? name_in(kPx4Modes) : name_in(kArdupilotModes);
}

// Mode numbers as in PX4's px4_custom_mode.h (1.18) and ArduCopter's mode.h (4.6).
bool is_flown_by_hand(AutopilotDialect dialect, std::uint32_t custom_mode) {
  if (dialect == AutopilotDialect::kPx4) {
    // modes manual, altitude, position, acro, stabilised, rattitude, altitude cruise
    static constexpr std::array<std::uint32_t, 7> kByHand{1, 2, 3, 5, 7, 8, 11};
    return std::find(kByHand.begin(), kByHand.end(), custom_mode >> 16U & 0xFFU) != kByHand.end();
  }
  // modes stabilize, acro, alt-hold, loiter, drift, sport, pos-hold, flow-hold
  static constexpr std::array<std::uint32_t, 8> kByHand{0, 1, 2, 5, 11, 13, 16, 22};
  return std::find(kByHand.begin(), kByHand.end(), custom_mode) != kByHand.end();
}

std::optional<std::string> estimator_fault(AutopilotDialect dialect, std::uint16_t flags,
                                           bool is_airborne) {
  namespace bit = wire::mavlink::estimator;
  const auto lacks = [flags](unsigned bits) { return (flags & bits) == 0; };
  if (dialect == AutopilotDialect::kArdupilot && !lacks(bit::kUninitialised)) {
    return "estimator is not initialised";
  }
  if (lacks(bit::kAttitude)) {
    return "estimator has no attitude";
  }
  if (lacks(bit::kRelativePosition | bit::kAbsolutePosition)) {
    return "estimator has no horizontal position";
  }
  if (lacks(bit::kHorizontalVelocity) || lacks(bit::kVerticalVelocity)) {
    return "estimator has no velocity";
  }
  if (lacks(bit::kHeight)) {
    return "estimator has no height";
  }
  // PX4 correctly reports a constant position while it is on the ground.
  const bool may_stand_still = dialect == AutopilotDialect::kPx4 && !is_airborne;
  if (!lacks(bit::kConstantPosition) && !may_stand_still) {
    return "estimator assumes that the vehicle does not move";
  }
  return std::nullopt;
}

const char* result_name(std::uint8_t ack_result) {
  static constexpr std::array<const char*, 11> kNames{"accepted",
                                                      "temporarily rejected",
                                                      "denied",
                                                      "unsupported",
                                                      "failed",
                                                      "in progress",
                                                      "cancelled",
                                                      "only as COMMAND_LONG",
                                                      "only as COMMAND_INT",
                                                      "frame unsupported",
                                                      "not in control"};
  return ack_result < kNames.size() ? kNames[ack_result] : "refused";
}

std::string command_name(std::uint16_t command) {
  switch (command) {
    case wire::mavlink::command::kLand:
      return "land";
    case wire::mavlink::command::kTakeOff:
      return "take-off";
    case wire::mavlink::command::kSetMode:
      return "mode change";
    case wire::mavlink::command::kArmDisarm:
      return "arm";
    case wire::mavlink::command::kSetMessageInterval:
      return "message interval";
    default:
      return fmt::format("command {}", command);
  }
}

}  // namespace vantage::drivers
