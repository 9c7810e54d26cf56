#include "sim/firmware/firmware_flight.hpp"

#include <atomic>
#include <memory>

#include <gtest/gtest.h>

#include "core/deadline.hpp"
#include "sim/firmware/ardupilot_link.hpp"

namespace vantage::sim {
namespace {

/// A firmware that answers immediately with fixed throttles, until `is_silent` is set.
class ImmediateFirmware : public FirmwareLink {
 public:
  struct Shared {
    std::atomic<bool> is_silent{false};
    std::atomic<double> throttle{0.0};
    std::atomic<std::int64_t> samples_received{0};
    std::atomic<std::int64_t> disorders{0};  ///< samples sent before the previous answer
  };
  explicit ImmediateFirmware(std::shared_ptr<Shared> shared) : shared_(std::move(shared)) {}
  [[nodiscard]] Duration period() const override { return Duration{2'500}; }
  [[nodiscard]] bool is_lockstep() const override { return true; }
  bool send(const FirmwareSensors& sensors) override {
    shared_->disorders += owes_ || sensors.since_start <= last_ ? 1 : 0;
    last_ = sensors.since_start;
    owes_ = !shared_->is_silent;
    ++shared_->samples_received;
    return owes_;
  }
  std::optional<MotorCommand> receive(Duration) override {
    if (shared_->is_silent || (!owes_ && shared_->samples_received > 0)) {
      return std::nullopt;
    }
    owes_ = false;
    const double u = shared_->throttle;
    return MotorCommand{{u, u, u, u}};
  }

 private:
  std::shared_ptr<Shared> shared_;
  bool owes_ = false;
  Duration last_{-1};
};

/// A firmware that answers with a delay: a receive() that does not wait returns nothing.
class SlowFirmware : public ImmediateFirmware {
 public:
  using ImmediateFirmware::ImmediateFirmware;
  std::optional<MotorCommand> receive(Duration timeout) override {
    constexpr Duration kThinks{500};
    return timeout < kThinks ? std::nullopt : ImmediateFirmware::receive(timeout);
  }
};

void wait_for(FirmwareFlight& flight, std::int64_t steps) {
  while (flight.counts().steps < steps) {
    std::this_thread::yield();
  }
}

TEST(FirmwareFlight, WaitsForTheAnswerToEachSensorSample) {
  auto shared = std::make_shared<ImmediateFirmware::Shared>();
  shared->throttle = 0.8;
  FirmwareFlight flight({}, {}, 1, {}, std::make_unique<ImmediateFirmware>(shared));
  wait_for(flight, 200);
  EXPECT_EQ(shared->disorders, 0);
  EXPECT_GT(flight.at(monotonic_ns()).world_from_body.translation_m.z(), 0.2);
}

TEST(FirmwareFlight, WaitsForSlowFirmware) {
  auto shared = std::make_shared<ImmediateFirmware::Shared>();
  shared->throttle = 0.8;
  FirmwareFlight flight({}, {}, 1, {}, std::make_unique<SlowFirmware>(shared));
  wait_for(flight, 200);
  ASSERT_GT(flight.at(monotonic_ns()).world_from_body.translation_m.z(), 0.2);
  shared->is_silent = true;
  while (flight.counts().silences == 0) {
    std::this_thread::yield();
  }
  wait_for(flight, flight.counts().steps + 1200);
  EXPECT_NEAR(flight.at(monotonic_ns()).world_from_body.translation_m.z(), 0.0, 0.05);
  shared->is_silent = false;
  wait_for(flight, flight.counts().steps + 200);
  EXPECT_GT(flight.at(monotonic_ns()).world_from_body.translation_m.z(), 0.2);
}

TEST(FirmwareFlight, SilentFirmwareStopsTheMotors) {
  auto shared = std::make_shared<ImmediateFirmware::Shared>();
  shared->throttle = 0.8;
  FirmwareFlight flight({}, {}, 1, {}, std::make_unique<ImmediateFirmware>(shared));
  wait_for(flight, 200);
  shared->is_silent = true;
  wait_for(flight, flight.counts().steps + 1200);
  EXPECT_EQ(flight.counts().silences, 1);
  EXPECT_NEAR(flight.at(monotonic_ns()).world_from_body.translation_m.z(), 0.0, 0.05);
}

TEST(FirmwareFlight, InterpolatesBetweenSamples) {
  auto shared = std::make_shared<ImmediateFirmware::Shared>();
  shared->throttle = 0.8;
  FirmwareFlight flight({}, {}, 1, {}, std::make_unique<ImmediateFirmware>(shared));
  wait_for(flight, 200);
  const std::int64_t now_ns = monotonic_ns();
  double last_m = -1.0;
  for (std::int64_t back_ns = 100'000'000; back_ns >= 0; back_ns -= 1'000'000) {
    const double z_m = flight.at(now_ns - back_ns).world_from_body.translation_m.z();
    EXPECT_GE(z_m, last_m);  // m; the body climbs all the time
    last_m = z_m;
  }
}

}  // namespace
}  // namespace vantage::sim
