// Compares every limit for poses and frames with docs/guide/vicon.md.

#include <gtest/gtest.h>

#include "drivers/vicon/driver.hpp"
#include "drivers/vicon/frame_assembly.hpp"
#include "drivers/vicon/frame_filter.hpp"
#include "drivers/vicon/pose_gate.hpp"
#include "drivers/vicon/vrpn_trackers.hpp"
#include "scenario/scenario.hpp"
#include "test/support/stated.hpp"

namespace vantage::drivers::vicon {
namespace {

TEST(ViconLimits, MatchTheDocument) {
  const GateSettings gate;
  const scenario::MocapSpec mocap;
  const test::Stated rows[] = {
      {"speed_max_mps", gate.speed_max_mps, 10.0},
      {"turn_max_radps", gate.turn_max_radps, 20.0},
      {"jump_margin_m", gate.jump_margin_m, 0.15},
      {"turn_margin_rad", gate.turn_margin_rad, 0.5},
      {"lost_after", to_seconds(gate.lost_after), 1.0},
      {"usual_divisor", static_cast<double>(gate.usual_divisor), 5.0},
      {"confirm_frames", static_cast<double>(gate.confirm_frames), 5.0},
      {"accept_jump_after", to_seconds(gate.accept_jump_after), 2.0},
      {"stuck_frames", static_cast<double>(gate.stuck_frames), 3.0},
      {"scenario: gate_speed_mps", mocap.gate_speed_mps, 10.0},
      {"scenario: gate_turn_radps", mocap.gate_turn_radps, 20.0},
      {"scenario: stuck_frames", static_cast<double>(mocap.stuck_frames), 3.0},
      {"scenario: latency_s", mocap.latency_s, 0.005},
      {"FrameFilter::kLatencyPossible_s", FrameFilter::kLatencyPossible_s, 10.0},
      {"FrameFilter::kQueuedMax", to_seconds(FrameFilter::kQueuedMax), 0.1},
      {"FrameFilter::kWaitedMax", to_seconds(FrameFilter::kWaitedMax), 10.0},
      {"FrameFilter::kBehindFor", to_seconds(FrameFilter::kBehindFor), 0.5},
      {"FrameClock::kDrift", FrameClock::kDrift, 0.0005},
      {"FrameClock::kLearn_s", FrameClock::kLearn_s, 2.0},
      {"FrameClock::kRefuted_s", FrameClock::kRefuted_s, 3.0},
      {"ViconDriver::kBacklogPeriod", to_seconds(ViconDriver::kBacklogPeriod), 5.0},
      {"swap_certain", to_seconds(gate.swap_certain), 0.4},
      {"FrameAssembly::kPatience", to_seconds(FrameAssembly::kPatience), 0.004},
      {"VrpnTrackers::kSameFrame_us", static_cast<double>(VrpnTrackers::kSameFrame_us), 400.0},
  };
  test::expect_as_stated(rows);
}

}  // namespace
}  // namespace vantage::drivers::vicon
