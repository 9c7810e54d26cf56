// Tests set-points, clocks, origins and long texts of an emulated autopilot.

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/axes.hpp"
#include "test/sim/autopilot/emulator_bench.hpp"

namespace vantage::sim {
namespace {

namespace mavlink = wire::mavlink;
using models::AutopilotDialect;
using test::EmulatorBench;
using test::flying;
using test::spec_of;
using test::target_of;

constexpr Time kBoot = test::kBenchBoot;

mavlink::SetPositionTargetLocalNed velocity_of(double vx, double vy, double vz) {
  auto out = target_of(mavlink::mask::kVelocityAndYawRate);
  out.vx = mavlink::f32(vx);
  out.vy = mavlink::f32(vy);
  out.vz = mavlink::f32(vz);
  return out;
}

/// Returns the position and yaw after 1.5 s with the set-point `target`.
Eigen::Vector4d place_after(EmulatorBench bench, const mavlink::SetPositionTargetLocalNed& target) {
  bench.send_poses(1.5, &target);
  const Eigen::Vector3d place_m = bench.place_m();
  return {place_m.x(), place_m.y(), place_m.z(), bench.emulator.controller().airframe().yaw_rad()};
}

// Set-points in body axes (forward, right, down) are rotated by the yaw. A position in body axes is
// refused.
TEST(EmulatorTargets, InBodyAxesAreRotatedByYaw) {
  const EmulatorBench begin = flying();
  const double yaw_rad = begin.emulator.controller().airframe().yaw_rad();
  ASSERT_NEAR(yaw_rad, -0.5, 0.01);
  for (const Eigen::Vector3d& wish :
       {Eigen::Vector3d(0.8, 0.3, 0.1), Eigen::Vector3d(-0.4, 0.6, -0.2)}) {
    auto body = velocity_of(wish.x(), wish.y(), wish.z());
    body.coordinate_frame = mavlink::frame::kBodyNed;
    const Eigen::Vector3d turned = Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()) * wish;
    const Eigen::Vector4d expected =
        place_after(begin, velocity_of(turned.x(), turned.y(), turned.z()));
    EXPECT_LT((place_after(begin, body) - expected).norm(), 2e-3) << wish.transpose();
    EXPECT_GT((place_after(begin, velocity_of(wish.x(), wish.y(), wish.z())) - expected).norm(),
              0.1);
    body.type_mask = mavlink::mask::kVelocityAndYawRate &
                     static_cast<std::uint16_t>(~mavlink::mask::kIgnorePosition);
    body.x = 5.0F;
    body.y = -5.0F;
    body.z = -9.0F;
    EXPECT_LT((place_after(begin, body) - expected).norm(), 2e-3);
  }
}

TEST(EmulatorTargets, InUnknownFramesAreIgnoredAndCounted) {
  const EmulatorBench begin = flying();
  auto stay = target_of(mavlink::mask::kPositionAndYaw);
  stay.x = 1.0F;
  stay.y = -2.0F;
  stay.z = -1.75F;
  stay.yaw = -0.5F;
  for (int frame = 0; frame <= 21; ++frame) {
    EmulatorBench bench = begin;
    auto target = velocity_of(0.5, 0.0, 0.0);
    target.coordinate_frame = static_cast<std::uint8_t>(frame);
    bench.send(target);
    const bool is_known = frame == mavlink::frame::kLocalNed || frame == mavlink::frame::kBodyNed;
    EXPECT_EQ(bench.emulator.ignored(), is_known ? 0 : 1) << frame;
    bench.run(0.1);
    EXPECT_EQ(bench.emulator.velocity_world_mps().norm() > 0.02, is_known) << frame;
  }
  EmulatorBench bench = begin;
  auto force = velocity_of(0.5, 0.0, 0.0);
  force.type_mask |= mavlink::mask::kIsForce;
  bench.send(force);
  EXPECT_EQ(bench.emulator.ignored(), 1);
  auto others = velocity_of(0.5, 0.0, 0.0);
  others.target_system = 8;
  bench.send(others);
  EXPECT_EQ(bench.emulator.ignored(), 1) << "set-points for another vehicle are not counted";
  bench.send_poses(0.5, &stay);
  EXPECT_LT(bench.emulator.velocity_world_mps().norm(), 0.02);
}

// Each of the five parts of a set-point acts if and only if it is not masked out.
TEST(EmulatorTargets, ApplyAllUnmaskedFields) {
  using Target = mavlink::SetPositionTargetLocalNed;
  struct Part {
    std::uint16_t bits;
    void (*set)(Target&);
  };
  const Part parts[] = {{mavlink::mask::kIgnorePosition,
                         [](Target& t) {
                           t.x = 1.3F;
                           t.y = -2.4F;
                           t.z = -1.6F;
                         }},
                        {mavlink::mask::kIgnoreVelocity,
                         [](Target& t) {
                           t.vx = 0.5F;
                           t.vy = 0.4F;
                           t.vz = -0.2F;
                         }},
                        {mavlink::mask::kIgnoreAcceleration,
                         [](Target& t) {
                           t.afx = 0.5F;
                           t.afy = -0.3F;
                           t.afz = 0.2F;
                         }},
                        {mavlink::mask::kIgnoreYaw, [](Target& t) { t.yaw = 0.3F; }},
                        {mavlink::mask::kIgnoreYawRate, [](Target& t) { t.yaw_rate = 0.4F; }}};
  const EmulatorBench begin = flying();
  const std::uint16_t all = mavlink::mask::kIgnorePosition | mavlink::mask::kIgnoreVelocity |
                            mavlink::mask::kIgnoreAcceleration | mavlink::mask::kIgnoreYaw |
                            mavlink::mask::kIgnoreYawRate;
  const Eigen::Vector4d nothing = place_after(begin, target_of(all));
  for (const Part& part : parts) {
    Target masked = target_of(all);
    part.set(masked);
    EXPECT_EQ(place_after(begin, masked), nothing) << part.bits;
    masked.type_mask = static_cast<std::uint16_t>(all & ~part.bits);
    EXPECT_GT((place_after(begin, masked) - nothing).norm(), 0.05) << part.bits;
  }
}

// --- clocks

TEST(EmulatorMessages, AnswersAndSendsTimesync) {
  EmulatorBench bench(AutopilotDialect::kPx4);
  bench.run(0.5);
  bench.frames.clear();
  mavlink::Timesync request;
  request.ts1 = 123'456'789;
  bench.send(request);
  const auto answers = bench.all<mavlink::Timesync>();
  ASSERT_EQ(answers.size(), 1u);
  EXPECT_EQ(answers[0].ts1, 123'456'789);
  EXPECT_EQ(answers[0].tc1, (bench.now - kBoot).count() * 1'000);
  bench.frames.clear();
  request.tc1 = 5;  // tc1 ≠ 0: a reply
  bench.send(request);
  EXPECT_TRUE(bench.all<mavlink::Timesync>().empty()) << "a reply is not answered";
}

// The host's clock is offset by five hours. The reply gives the host's time, valid half a round
// trip after the request. A pose captured 0.1 s ago must be compared with the position 0.1 s ago.
TEST(EmulatorMessages, ConvertsPoseTimeFromHostClock) {
  constexpr Duration kOff = std::chrono::hours(5);
  for (const bool is_answered : {false, true}) {
    EmulatorBench bench = flying();
    const auto flies_on = velocity_of(1.0, 0.0, 0.0);
    bench.send_poses(2.0, &flies_on);
    if (is_answered) {
      mavlink::Timesync answer;
      answer.ts1 = (bench.now - kBoot).count() * 1'000;
      answer.tc1 = to_utime(bench.now + kOff + Duration{20'000}) * 1'000;
      bench.run(0.04);
      bench.send(answer);
      answer.ts1 += 1'000'000'000;  // replies to a request that was not sent
      answer.tc1 += 9'000'000'000;
      bench.send(answer);
    }
    std::vector<Eigen::Vector3d> places_m;
    for (int k = 0; k < 100; ++k) {
      places_m.push_back(bench.place_m());
      if (k >= 5) {
        auto late = bench.pose(places_m[places_m.size() - 6]);
        late.time_usec = static_cast<std::uint64_t>(to_utime(bench.now + kOff - Duration{100'000}));
        bench.send(late);
      }
      bench.send(flies_on);
      bench.run(0.02);
    }
    ASSERT_GT(bench.emulator.velocity_world_mps().x(), 0.85);
    const double behind_m =
        bench.place_m().x() - bench.emulator.controller().estimator().position_m().x();
    EXPECT_NEAR(behind_m, is_answered ? 0.0 : 0.1 * bench.emulator.velocity_world_mps().x(), 0.005);
  }
}

TEST(EmulatorMessages, ConfirmsOrigin) {
  for (const AutopilotDialect dialect : {AutopilotDialect::kPx4, AutopilotDialect::kArdupilot}) {
    EmulatorBench bench(dialect);
    bench.run(4.0);
    mavlink::SetGpsGlobalOrigin origin{421'234'567, -710'987'654, 12'345, 8};
    bench.frames.clear();
    bench.send(origin);
    EXPECT_TRUE(bench.all<mavlink::GpsGlobalOrigin>().empty()) << "message for another vehicle";
    EXPECT_FALSE(bench.emulator.controller().has_origin());
    origin.target_system = 9;
    bench.send(origin);
    const auto confirmed = bench.all<mavlink::GpsGlobalOrigin>();
    ASSERT_EQ(confirmed.size(), 1u);
    EXPECT_EQ(confirmed[0].latitude, 421'234'567);
    EXPECT_EQ(confirmed[0].longitude, -710'987'654);
    EXPECT_EQ(confirmed[0].altitude, 12'345);
    EXPECT_TRUE(bench.emulator.controller().has_origin());
  }
}

// --- long texts

// A text is split into messages of 50 characters, which share an id and are numbered.
TEST(EmulatorMessages, SplitsLongTexts) {
  EmulatorBench bench(AutopilotDialect::kPx4);
  mavlink::Heartbeat station;
  station.type = mavlink::type::kGroundStation;
  bench.send_poses(1.0);
  std::uint16_t last_id = 0;
  for (const std::size_t letters : {49U, 50U, 51U, 100U, 101U, 130U}) {
    std::string why;
    for (std::size_t k = 0; k < letters; ++k) {
      why.push_back(static_cast<char>('a' + k % 23));
    }
    bench.send(station);
    bench.emulator.controller().set_fault(why);
    EXPECT_EQ(bench.command(mavlink::command::kArmDisarm, 1.0F), 1);
    const auto pieces = bench.all<mavlink::Statustext>();
    ASSERT_EQ(pieces.size(), (letters + 49) / 50);
    std::string text;
    for (std::size_t k = 0; k < pieces.size(); ++k) {
      EXPECT_EQ(pieces[k].severity, 2);
      EXPECT_EQ(pieces[k].chunk_seq, k);
      EXPECT_EQ(pieces[k].id, pieces[0].id);
      text += std::string(pieces[k].text.begin(),
                          std::find(pieces[k].text.begin(), pieces[k].text.end(), '\0'));
    }
    EXPECT_EQ(text, why);
    EXPECT_EQ(pieces[0].id != 0, letters > 50) << letters;
    EXPECT_TRUE(letters <= 50 || pieces[0].id != last_id);
    last_id = pieces[0].id;
    // The text with the reason is sent before the refusal.
    EXPECT_TRUE(mavlink::unpack<mavlink::CommandAck>(bench.frames.back()));
  }
}

// PX4 sends texts to a ground station only if its last heartbeat is at most 2.5 s old.
TEST(EmulatorMessages, SendsTextsFor2_5SecondsAfterHeartbeat) {
  const auto texts_after = [](AutopilotDialect dialect, double silence_s) {
    EmulatorBench bench(dialect);
    bench.run(1.0);
    mavlink::Heartbeat station;
    station.type = mavlink::type::kGroundStation;
    bench.send(station);
    bench.run(silence_s);
    EXPECT_GT(bench.command(mavlink::command::kArmDisarm, 1.0F), 0);
    return bench.all<mavlink::Statustext>().size();
  };
  EXPECT_GT(texts_after(AutopilotDialect::kPx4, 2.5), 0u);
  EXPECT_EQ(texts_after(AutopilotDialect::kPx4, 2.505), 0u);
  EXPECT_GT(texts_after(AutopilotDialect::kArdupilot, 2.505), 0u) << "sent on all links";
}

// When 1024 messages have not been fetched, the older half is dropped.
TEST(EmulatorMessages, DropsOlderHalfOfUnfetchedOutput) {
  AutopilotEmulator emulator(spec_of(AutopilotDialect::kPx4), kBoot);
  std::uint8_t sequence = 0;
  const auto ask = [&](std::uint16_t number) {
    mavlink::CommandLong command;
    command.command = number;
    command.target_system = 9;
    std::vector<std::uint8_t> bytes;
    mavlink::append_bytes(mavlink::pack(command, {255, 191, sequence++}), bytes);
    emulator.receive(bytes, kBoot);
  };
  ask(9'999);
  emulator.take_output();
  const auto received = [&](std::uint16_t questions) {
    for (std::uint16_t k = 0; k < questions; ++k) {
      ask(static_cast<std::uint16_t>(10'000 + k));
    }
    std::vector<int> out;
    mavlink::Parser parser;
    for (const auto& datagram : emulator.take_output()) {
      parser.feed(datagram, [&](const mavlink::Frame& frame) {
        const auto ack = mavlink::unpack<mavlink::CommandAck>(frame);
        out.push_back(ack ? ack->command - 10'000 : -1);
      });
    }
    return out;
  };
  const auto from_to = [](int first, int end) {
    std::vector<int> out;
    for (int k = first; k < end; ++k) {
      out.push_back(k);
    }
    return out;
  };
  EXPECT_EQ(received(1'024), from_to(0, 1'024));
  EXPECT_EQ(received(1'025), from_to(512, 1'025));
  EXPECT_EQ(received(1'536), from_to(512, 1'536));
  EXPECT_EQ(received(1'537), from_to(1'024, 1'537));
}

}  // namespace
}  // namespace vantage::sim
