// Compares the emulated autopilots with recordings of the real ones (test/data/autopilot), which
// autopilot_recorder made. The same sequence of commands is sent to the emulator. All behaviour
// that matters to a driver must agree within the tolerances given here.

#include <algorithm>
#include <fstream>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/angle.hpp"
#include "test/sim/autopilot/drill.hpp"

namespace vantage::test {
namespace {

constexpr const char* kArdupilotLand = "9";
constexpr const char* kOnGround = "1";
constexpr const char* kLanding = "4";

struct Pair {
  Recording real;
  Recording emulated;
};

/// Returns the real and the emulated recording of a drill; each drill is played once.
const Pair& drill(const std::string& name) {
  static std::map<std::string, Pair> pairs;
  const auto [found, is_new] = pairs.try_emplace(name);
  if (is_new) {
    std::ifstream file(std::string(VANTAGE_RECORDINGS) + "/" + name + ".csv");
    if (!file) {
      throw std::runtime_error("no recording of " + name);
    }
    found->second.real = read_recording(file);
    const DrillCase& played = drill_case(name);
    EmulatorStation station(played.dialect, Pose3{}, 0.1);
    found->second.emulated = play(played, station);
  }
  return found->second;
}

/// Returns the time from the mark to the event, s; −1 without such an event.
double delay(const Recording& recording, const std::string& mark, const std::string& kind,
             const std::string& what) {
  const double told_s = recording.mark(mark);
  const auto event = recording.first(kind, what, told_s);
  return event ? event->time_s - told_s : -1.0;
}

/// Expects the event in both recordings, with the same delay after the mark.
void expect_delay(const Pair& pair, const std::string& mark, const std::string& kind,
                  const std::string& what, double tolerance_s) {
  const double real_s = delay(pair.real, mark, kind, what);
  EXPECT_GE(real_s, 0.0) << mark << ": " << what;
  EXPECT_NEAR(delay(pair.emulated, mark, kind, what), real_s, tolerance_s) << mark << ": " << what;
}

/// Returns the samples from a mark to the next mark.
std::vector<Recording::Moment> after(const Recording& recording, const std::string& mark) {
  const double begin_s = recording.mark(mark);
  double end_s = 1e9;
  for (const Recording::Event& event : recording.events) {
    if (event.kind == "mark" && event.time_s > begin_s + 0.01) {
      end_s = std::min(end_s, event.time_s);
    }
  }
  return recording.between(begin_s - 0.05, end_s);
}

/// The motion of a vehicle along x between two marks.
struct MotionSummary {
  double begin_m = 0.0;
  double end_m = 0.0;
  double farthest_m = 0.0;
  double back_m = 0.0;  ///< m; greatest return from the farthest point
  double fastest_mps = 0.0;
  double fastest_back_mps = 0.0;
};
MotionSummary motion_summary(const Recording& recording, const std::string& mark) {
  const std::vector<Recording::Moment> moments = after(recording, mark);
  MotionSummary out;
  out.begin_m = moments.front().position_m.x();
  out.end_m = moments.back().position_m.x();
  out.farthest_m = out.begin_m;
  for (const Recording::Moment& moment : moments) {
    out.farthest_m = std::max(out.farthest_m, moment.position_m.x());
    out.back_m = std::max(out.back_m, out.farthest_m - moment.position_m.x());
    out.fastest_mps = std::max(out.fastest_mps, moment.velocity_mps.x());
    out.fastest_back_mps = std::min(out.fastest_back_mps, moment.velocity_mps.x());
  }
  return out;
}

void expect_way(const Pair& pair, const std::string& mark, double place_m, double speed_mps) {
  SCOPED_TRACE(mark);
  const MotionSummary real = motion_summary(pair.real, mark);
  const MotionSummary emulated = motion_summary(pair.emulated, mark);
  EXPECT_NEAR(emulated.begin_m, real.begin_m, place_m);
  EXPECT_NEAR(emulated.end_m, real.end_m, place_m);
  EXPECT_NEAR(emulated.farthest_m, real.farthest_m, place_m);
  EXPECT_NEAR(emulated.back_m, real.back_m, place_m);
  EXPECT_NEAR(emulated.fastest_mps, real.fastest_mps, speed_mps);
  EXPECT_NEAR(emulated.fastest_back_mps, real.fastest_back_mps, speed_mps);
}

/// Returns the greatest horizontal distance from the set-point after the mark, m.
double drift_m(const Recording& recording, const std::string& mark) {
  double out = 0.0;
  for (const Recording::Moment& moment : after(recording, mark)) {
    out = std::max(out, moment.position_m.head<2>().norm());
  }
  return out;
}

std::set<std::string> words(const Recording& recording, double after_s, double before_s,
                            const std::string& begin) {
  std::set<std::string> out;
  for (const std::string& text : recording.order("text", after_s, before_s)) {
    if (text.starts_with(begin)) {
      out.insert(text);
    }
  }
  return out;
}

/// Returns the commands with their results.
std::set<std::string> answers(const Recording& recording) {
  const std::vector<std::string> all = recording.order("ack");
  return {all.begin(), all.end()};
}

// --- arming

TEST(RecordedArdupilot, RefusesToArmForTheSameReasons) {
  const auto& [real, emulated] = drill("ardupilot_arming");
  const auto refusals = [](const Recording& recording, const char* from, const char* to) {
    return words(recording, recording.mark(from), recording.mark(to), "Arm: ");
  };
  EXPECT_EQ(refusals(emulated, "arm without poses", "poses"),
            refusals(real, "arm without poses", "poses"));
  EXPECT_EQ(refusals(real, "arm without poses", "poses").size(), 5U);
  // Refusals with poses: until the vehicle has an origin, and then until its gyroscopes agree.
  EXPECT_EQ(refusals(emulated, "no set-points", "origin"),
            refusals(real, "no set-points", "origin"));
  EXPECT_EQ(refusals(emulated, "origin", "idle"), refusals(real, "origin", "idle"));
  EXPECT_EQ(answers(emulated), answers(real));
}

TEST(EmulatedArdupilot, ArmsAndDisarmsAtTheRecordedTimes) {
  const Pair& pair = drill("ardupilot_arming");
  EXPECT_NEAR(pair.emulated.mark("idle"), pair.real.mark("idle"), 1.5);  // s since power-up
  EXPECT_GT(pair.real.mark("idle"), 22.0);
  expect_delay(pair, "idle", "text", "Disarming motors", 0.2);
}

TEST(RecordedArdupilot, ReportsAPositionBeforeItHasAnOrigin) {
  const Pair& pair = drill("ardupilot_arming");
  for (const Recording* recording : {&pair.real, &pair.emulated}) {
    EXPECT_LT(recording->first("position", "")->time_s, recording->mark("origin"));
    EXPECT_LT(recording->first("flags", "0x033F")->time_s, recording->mark("origin"));
  }
  expect_delay(pair, "origin", "origin", "confirmed", 0.2);
  expect_delay(pair, "poses", "flags", "0x033F", 1.5);  // s; aligns its tilt before this
}

TEST(RecordedPx4, RefusesToArmForTheSameReasons) {
  const auto& [real, emulated] = drill("px4_arming");
  const auto refusals = [](const Recording& recording, const char* from, const char* to) {
    return words(recording, recording.mark(from), recording.mark(to), "Arming denied: ");
  };
  EXPECT_EQ(refusals(emulated, "arm without poses", "poses"),
            refusals(real, "arm without poses", "poses"));
  for (const Recording* recording : {&real, &emulated}) {
    EXPECT_FALSE(words(*recording, recording->mark("no set-points"), 1e9, "Arming denied").empty());
  }
  // PX4 accepts Offboard each time, but arms only with poses and set-points.
  EXPECT_EQ(answers(emulated), answers(real));
  expect_delay(drill("px4_arming"), "arm", "ack", "400 0", 0.2);
}

TEST(RecordedPx4, IsReadyWithTheFirstPoses) {
  expect_delay(drill("px4_arming"), "poses", "flags", "0x01AF", 0.2);
}

TEST(RecordedPx4, DisarmsWithoutCommands) {
  expect_delay(drill("px4_arming"), "idle", "text", "Disarmed by auto preflight disarming", 0.6);
}

// --- motion

class RecordedMotion : public testing::TestWithParam<const char*> {};

TEST_P(RecordedMotion, FollowsAndStopsAsRecorded) {
  const Pair& pair = drill(GetParam());
  for (const char* const mark : {"move", "brake", "move again", "place alone", "velocity"}) {
    expect_way(pair, mark, 0.08, 0.15);
  }
  expect_way(pair, "place after velocity", 0.10, 0.10);
}

// When the kind of set-point changes while the vehicle brakes, ArduCopter attributes the braking to
// wind.
TEST_P(RecordedMotion, OvershootsAsRecordedWhenTheTargetKindChanges) {
  const Pair& pair = drill(GetParam());
  expect_way(pair, "place while braking", 0.08, 0.12);
  expect_way(pair, "place after braking velocity", 0.12, 0.12);
}

TEST_P(RecordedMotion, TurnsAsRecorded) {
  const Pair& pair = drill(GetParam());
  const double real_s = pair.real.mark("turn");
  const double emulated_s = pair.emulated.mark("turn");
  double real_most_rad = 0.0;
  double emulated_most_rad = 0.0;
  for (double after_s = 0.0; after_s < 4.0; after_s += 0.1) {
    const double real_rad = pair.real.at(real_s + after_s).yaw_rad;
    const double emulated_rad = pair.emulated.at(emulated_s + after_s).yaw_rad;
    EXPECT_NEAR(wrap_to_pi(emulated_rad - real_rad), 0.0, 0.4) << "after " << after_s << " s";
    real_most_rad = std::max(real_most_rad, real_rad);
    emulated_most_rad = std::max(emulated_most_rad, emulated_rad);
  }
  EXPECT_NEAR(emulated_most_rad, real_most_rad, 0.1);  // ArduCopter overshoots by a third
}

TEST_P(RecordedMotion, LandsAndStopsItsMotorsAsRecorded) {
  const Pair& pair = drill(GetParam());
  expect_delay(pair, "land", "landed", kLanding, 0.2);
  expect_delay(pair, "land", "landed", kOnGround, 0.3);
  expect_delay(pair, "land", "text", "Disarm", 0.4);
}

INSTANTIATE_TEST_SUITE_P(, RecordedMotion, testing::Values("ardupilot_motion", "px4_motion"));

TEST(RecordedArdupilot, OvershootsByHalfAMetre) {
  const auto& [real, emulated] = drill("ardupilot_motion");
  EXPECT_GT(motion_summary(real, "place while braking").back_m, 0.5);
  EXPECT_GT(motion_summary(emulated, "place while braking").back_m, 0.5);
}

// --- loss of messages

class RecordedSilence : public testing::TestWithParam<const char*> {};

TEST_P(RecordedSilence, SetPointLossStopsArdupilot) {
  const Pair& pair = drill(std::string("ardupilot_setpoints_stop") + GetParam());
  expect_way(pair, "set-points stop", 0.10, 0.10);
  for (const Recording* recording : {&pair.real, &pair.emulated}) {  // the mode does not change
    const double stop_s = recording->mark("set-points stop");
    EXPECT_TRUE(recording->order("mode", stop_s, recording->mark("land")).empty());
  }
}

TEST_P(RecordedSilence, SetPointLossLandsPx4) {
  const Pair& pair = drill(std::string("px4_setpoints_stop") + GetParam());
  expect_delay(pair, "set-points stop", "text", "Failsafe activated", 0.1);
  expect_delay(pair, "set-points stop", "landed", kLanding, 0.1);
  expect_delay(pair, "set-points stop", "landed", kOnGround, 0.3);
  expect_delay(pair, "set-points stop", "text", "Disarmed by landing", 0.3);
  expect_way(pair, "set-points stop", 0.12, 0.12);
}

TEST_P(RecordedSilence, HeartbeatLossLandsArdupilotAfterPause) {
  const Pair& pair = drill(std::string("ardupilot_heartbeats_stop") + GetParam());
  // The autopilot checks three times per second, and heartbeats are sent five times per second.
  expect_delay(pair, "heartbeats stop", "text", "GCS Failsafe", 0.5);
  for (const Recording* recording : {&pair.real, &pair.emulated}) {
    const double land_s = recording->first("mode", kArdupilotLand)->time_s;
    EXPECT_NEAR(recording->at(land_s + 3.9).position_m.z(), recording->at(land_s).position_m.z(),
                0.06);
    EXPECT_GT(recording->at(land_s + 5.0).position_m.z(),
              recording->at(land_s).position_m.z() + 0.3);
    const double down_s = recording->first("landed", kOnGround, land_s)->time_s;
    EXPECT_NEAR(down_s - land_s, 7.45, 0.3);
    EXPECT_NEAR(recording->first("text", "Disarming motors", land_s)->time_s - down_s, 0.45, 0.15);
    // Distance, m, that the vehicle moves on from its position at the failsafe.
    EXPECT_NEAR(recording->path.back().position_m.x() - recording->at(land_s).position_m.x(),
                std::string(GetParam()).empty() ? 0.5 : 0.0, 0.2);
  }
}

INSTANTIATE_TEST_SUITE_P(, RecordedSilence, testing::Values("", "_slow"));

TEST(RecordedPx4, IgnoresMissingHeartbeatsDuringSetPoints) {
  const Pair& pair = drill("px4_heartbeats_stop");
  for (const Recording* recording : {&pair.real, &pair.emulated}) {
    const double stop_s = recording->mark("heartbeats stop");
    EXPECT_GT(recording->mark("land") - stop_s, 12.0);
    EXPECT_TRUE(recording->order("mode", stop_s, recording->mark("land")).empty());
  }
}

TEST(RecordedArdupilot, LandsWhenAllInputStops) {
  const Pair& pair = drill("ardupilot_everything_stops");
  expect_delay(pair, "everything stops", "text", "GCS Failsafe", 0.5);
  expect_delay(pair, "everything stops", "landed", kOnGround, 0.6);
  expect_delay(pair, "everything stops", "text", "Disarming motors", 0.6);
  EXPECT_NEAR(motion_summary(pair.emulated, "everything stops").farthest_m,
              motion_summary(pair.real, "everything stops").farthest_m, 0.3);
}

TEST(RecordedPx4, LandsWhenAllInputStops) {
  const Pair& pair = drill("px4_everything_stops");
  expect_delay(pair, "everything stops", "landed", kLanding, 0.1);
  expect_delay(pair, "everything stops", "landed", kOnGround, 0.4);
  expect_way(pair, "everything stops", 0.12, 0.12);
}

TEST(RecordedArdupilot, LandsWhenItsPositionIsLost) {
  const Pair& pair = drill("ardupilot_poses_stop");
  expect_delay(pair, "poses stop", "flags", "0x0025", 0.2);
  expect_delay(pair, "poses stop", "text", "EKF Failsafe: changed to LAND Mode", 0.2);
  expect_delay(pair, "poses stop", "mode", kArdupilotLand, 0.2);
  expect_delay(pair, "poses stop", "landed", kOnGround, 0.5);
  expect_delay(pair, "poses stop", "text", "Disarming motors", 0.5);
  EXPECT_NEAR(drift_m(pair.emulated, "poses stop"), drift_m(pair.real, "poses stop"), 0.5);
}

TEST(RecordedPx4, LandsWhenItsPositionIsLost) {
  const Pair& pair = drill("px4_poses_stop");
  const auto in_the_air = [](const Recording& recording) {
    const double stop_s = recording.mark("poses stop");
    return recording.order("flags", stop_s, recording.first("landed", kOnGround, stop_s)->time_s);
  };
  EXPECT_EQ(in_the_air(pair.real), (std::vector<std::string>{"0x002F", "0x0025"}));
  EXPECT_EQ(in_the_air(pair.emulated), in_the_air(pair.real));
  expect_delay(pair, "poses stop", "flags", "0x002F", 0.15);
  expect_delay(pair, "poses stop", "flags", "0x0025", 0.2);
  expect_delay(pair, "poses stop", "text", "Failsafe activated", 0.2);
  expect_delay(pair, "poses stop", "landed", kOnGround, 0.3);
  expect_delay(pair, "poses stop", "text", "Disarmed by landing", 0.3);
  EXPECT_NEAR(drift_m(pair.emulated, "poses stop"), drift_m(pair.real, "poses stop"), 0.1);
}

// ArduCopter refuses poses with a jump of 0.3 m as long as the jump lasts; PX4 accepts them. PX4
// refuses a jump of 1.5 m for a second, then accepts it and flies to the new position.
class RecordedJump : public testing::TestWithParam<const char*> {};

TEST_P(RecordedJump, MovesEmulatorLikeRealAutopilot) {
  const Pair& pair = drill(GetParam());
  for (const char* const mark : {"small jump", "small jump back", "great jump"}) {
    SCOPED_TRACE(mark);
    const double real_s = pair.real.mark(mark);
    const double emulated_s = pair.emulated.mark(mark);
    for (double after_s = 0.0; after_s < 5.0; after_s += 0.5) {
      EXPECT_NEAR(pair.emulated.at(emulated_s + after_s).position_m.x(),
                  pair.real.at(real_s + after_s).position_m.x(), 0.25)
          << "after " << after_s << " s";
    }
    EXPECT_NEAR(pair.emulated.at(emulated_s + 4.9).position_m.x(),
                pair.real.at(real_s + 4.9).position_m.x(), 0.1);
  }
  const double great_s = pair.real.mark("great jump");
  EXPECT_EQ(
      pair.emulated.order("flags", pair.emulated.mark("great jump"), pair.emulated.mark("land")),
      pair.real.order("flags", great_s, pair.real.mark("land")));
}

INSTANTIATE_TEST_SUITE_P(, RecordedJump, testing::Values("ardupilot_poses_jump", "px4_poses_jump"));

}  // namespace
}  // namespace vantage::test
