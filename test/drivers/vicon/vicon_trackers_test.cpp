// Tests a VRPN server with trackers that report at different times and rates, in virtual time.

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "drivers/vicon/driver.hpp"
#include "wire/vicon/vrpn.hpp"

namespace vantage::drivers::vicon {
namespace {

constexpr Time kEpoch = from_utime(1'700'000'000'000'000);
constexpr std::int32_t kPoseType = 0;

/// A tracker that moves on a circle of radius 1 m at 1 m/s and turns with its heading.
struct Tracker {
  std::string name;
  Duration period;
  Duration offset;
  Duration silent_from = Duration::max();

  static double phase(Duration at, std::size_t which) {
    return to_seconds(at) + static_cast<double>(which);
  }
};

class VrpnTrackersOnTheWire : public ::testing::Test {
 protected:
  void run(const std::vector<Tracker>& trackers, Duration length) {
    trackers_ = trackers;
    driver_.on_opening(now());
    driver_.on_opened(now());
    std::vector<std::uint8_t> hello;
    wire::vicon::append_vrpn_cookie(hello);
    wire::vicon::append_vrpn_name(hello, wire::vicon::kVrpnTypeDescription, kPoseType,
                                  wire::vicon::kVrpnPoseType);
    for (std::size_t i = 0; i < trackers.size(); ++i) {
      wire::vicon::append_vrpn_name(hello, wire::vicon::kVrpnSenderDescription,
                                    static_cast<std::int32_t>(i), trackers[i].name);
    }
    driver_.receive(now(), hello);
    for (; elapsed_ < length; elapsed_ += Duration{500}) {
      driver_.on_time(now());
      for (std::size_t i = 0; i < trackers.size(); ++i) {
        if (elapsed_ >= trackers[i].offset && elapsed_ < trackers[i].silent_from &&
            (elapsed_ - trackers[i].offset) % trackers[i].period == Duration{0}) {
          report(i);
        }
      }
    }
  }

  void report(std::size_t which) {
    const double phase = Tracker::phase(elapsed_, which);
    wire::vicon::VrpnPose pose;
    pose.position_m = {std::cos(phase), std::sin(phase), 1.0};
    pose.quaternion_xyzw = {0.0, 0.0, std::sin(0.5 * phase), std::cos(0.5 * phase)};
    const std::int64_t stamp_us = to_utime(kEpoch + elapsed_);
    std::vector<std::uint8_t> bytes;
    wire::vicon::append_vrpn_pose(bytes,
                                  {static_cast<std::uint32_t>(stamp_us / 1'000'000),
                                   static_cast<std::uint32_t>(stamp_us % 1'000'000),
                                   static_cast<std::int32_t>(which), kPoseType},
                                  pose);
    driver_.receive(now(), bytes);
  }

  [[nodiscard]] Moment now() const { return {kEpoch + elapsed_, elapsed_}; }

  /// Returns the frames that arrived between `from` and `to`.
  [[nodiscard]] std::vector<models::MocapFrame> frames(Duration from, Duration to) const {
    std::vector<models::MocapFrame> out;
    for (const models::MocapFrame& frame : frames_) {
      if (frame.arrival >= kEpoch + from && frame.arrival < kEpoch + to) {
        out.push_back(frame);
      }
    }
    return out;
  }

  static scenario::MocapSpec spec() {
    scenario::MocapSpec out;
    out.protocol = scenario::MocapProtocol::kVrpn;
    return out;
  }

  std::vector<Tracker> trackers_;
  Duration elapsed_{};
  std::vector<models::MocapFrame> frames_;
  ViconDriver driver_{spec(),
                      [this](const models::MocapFrame& frame) { frames_.push_back(frame); }};
};

constexpr Duration ms(std::int64_t count) { return Duration{1'000 * count}; }

TEST_F(VrpnTrackersOnTheWire, AppearInEveryFrame) {
  run({{"A", ms(10), ms(0)}, {"B", ms(20), ms(3)}, {"C", ms(10), ms(5)}}, ms(3'000));
  const auto settled = frames(ms(200), ms(3'000));
  EXPECT_NEAR(static_cast<double>(settled.size()), 280.0, 1.0) << "the rate of the fastest tracker";
  for (const models::MocapFrame& frame : settled) {
    ASSERT_EQ(frame.bodies.size(), 3U);
    const Duration at = frame.arrival - kEpoch;
    for (std::size_t i = 0; i < trackers_.size(); ++i) {
      const models::MocapBody* body = frame.find(trackers_[i].name);
      ASSERT_NE(body, nullptr);
      ASSERT_FALSE(body->occluded) << body->name << " at " << to_seconds(at);
      // m; poses are extrapolated along the tangent for up to 20 ms. With 1 m/s² the error is ½ ·
      // 0.02², plus the error from the delay of the velocity estimate.
      const double phase = Tracker::phase(at, i);
      const Eigen::Vector3d truth(std::cos(phase), std::sin(phase), 1.0);
      EXPECT_LT((body->world_from_body.translation_m - truth).norm(), 6e-4);
      const Eigen::Quaterniond turned(std::cos(0.5 * phase), 0.0, 0.0, std::sin(0.5 * phase));
      EXPECT_LT(body->world_from_body.rotation.angularDistance(turned), 1e-6);
    }
  }
}

TEST_F(VrpnTrackersOnTheWire, HaveSeparateRates) {
  run({{"A", ms(10), ms(0)}, {"B", ms(20), ms(3)}, {"C", ms(10), ms(5)}}, ms(500));
  const std::vector<BodyRate> rates = driver_.rates();
  ASSERT_EQ(rates.size(), 3U);
  EXPECT_NEAR(rates[0].rate_hz, 100.0, 0.1);
  EXPECT_NEAR(rates[1].rate_hz, 50.0, 0.1);
  EXPECT_NEAR(rates[2].rate_hz, 100.0, 0.1);
}

TEST_F(VrpnTrackersOnTheWire, AreUnseenWhenSilent) {
  run({{"A", ms(10), ms(0)}, {"B", ms(20), ms(3), ms(1'000)}}, ms(2'000));
  for (const models::MocapFrame& frame : frames(ms(200), ms(1'000))) {
    EXPECT_FALSE(frame.find("B")->occluded);
  }
  for (const models::MocapFrame& frame : frames(ms(1'020), ms(2'000))) {
    EXPECT_TRUE(frame.find("B")->occluded) << "1.5 periods of 20 ms after its last report at 983";
    EXPECT_FALSE(frame.find("A")->occluded);
  }
}

TEST_F(VrpnTrackersOnTheWire, ContinueWhenTheFastestTrackerIsSilent) {
  run({{"A", ms(10), ms(0), ms(1'000)}, {"B", ms(10), ms(4)}, {"C", ms(20), ms(7)}}, ms(2'000));
  const auto after = frames(ms(1'200), ms(2'000));
  EXPECT_NEAR(static_cast<double>(after.size()), 80.0, 1.0);
  for (const models::MocapFrame& frame : after) {
    EXPECT_TRUE(frame.find("A")->occluded);
    EXPECT_FALSE(frame.find("B")->occluded);
    EXPECT_FALSE(frame.find("C")->occluded);
  }
}

TEST_F(VrpnTrackersOnTheWire, AreOccludedAtTheFirstMissingReportOfSynchronousTrackers) {
  run({{"A", ms(10), ms(0)}, {"B", ms(10), ms(0), ms(1'000)}}, ms(2'000));
  EXPECT_EQ(frames(ms(200), ms(2'000)).size(), 180U);
  for (const models::MocapFrame& frame : frames(ms(200), ms(2'000))) {
    EXPECT_EQ(frame.find("B")->occluded, frame.arrival - kEpoch >= ms(1'000));
  }
}

}  // namespace
}  // namespace vantage::drivers::vicon
