#include "bus/node/node.hpp"

#include <gtest/gtest.h>
#include <poll.h>
#include <sys/timerfd.h>
#include <unistd.h>

#include "bus/node/normal_counters.hpp"
#include "core/deadline.hpp"

namespace vantage::bus {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// An endpoint that owns its hub.
class OwnHub : public Transport {
 public:
  void subscribe(const std::string& channel, Handler handler) override {
    own_->subscribe(channel, std::move(handler));
  }
  void unsubscribe(const std::string& channel) override { own_->unsubscribe(channel); }
  bool publish(const std::string& channel, std::span<const std::uint8_t> bytes) override {
    return own_->publish(channel, bytes);
  }
  int handle(std::chrono::microseconds timeout) override { return own_->handle(timeout); }
  [[nodiscard]] TransportStats stats() const override { return own_->stats(); }
  [[nodiscard]] InProcessHub& hub() { return hub_; }

 private:
  InProcessHub hub_;
  std::unique_ptr<Transport> own_ = hub_.connect();
};

/// A transport that advances the clock by the duration of each wait, and stores published messages.
class WaitMovesTheClock : public OwnHub {
 public:
  explicit WaitMovesTheClock(VirtualClock& clock) : clock_(clock) {}
  int handle(std::chrono::microseconds timeout) override {
    longest_wait_ = std::max<Duration>(longest_wait_, timeout);
    clock_.set(clock_.now() + timeout);
    if (ends_at && clock_.now() >= *ends_at) {
      return kSourceEnded;
    }
    return OwnHub::handle(std::chrono::microseconds{0});
  }
  [[nodiscard]] Duration longest_wait() const { return longest_wait_; }

  std::optional<Time> ends_at;

 private:
  VirtualClock& clock_;
  Duration longest_wait_{};
};

class Ticker : public Node {
 public:
  Ticker(Time first, Duration period) : next_(first), period_(period) {}
  [[nodiscard]] std::string name() const override { return "TICKER"; }
  [[nodiscard]] Time next_tick() const override { return next_; }
  void tick(Time now) override {
    ticks.push_back(now);
    next_ = next_ + period_;
  }
  [[nodiscard]] std::vector<models::NamedCount> counters() const override {
    return {{"stale_inputs", stale_inputs}, {"rest_rounds", rest_rounds}, {"busy_us", busy_us}};
  }

  [[nodiscard]] std::int64_t deadlines_missed() const override { return missed; }

  std::vector<Time> ticks;
  std::int64_t stale_inputs = 0;
  std::int64_t rest_rounds = 0;
  std::int64_t busy_us = 0;
  std::int64_t missed = 0;

 private:
  Time next_;
  Duration period_;
};

class RunNode : public ::testing::Test {
 protected:
  RunNode() {
    observer_.subscribe<models::ProcessHealth>(
        health_channel("TICKER"), [this](const models::ProcessHealth& h) { health_.push_back(h); });
  }
  void run_until(Time end) {
    run_node(bus_, node_, clock_, [this, end] { return clock_.now() >= end; });
    observer_.handle(std::chrono::microseconds{0});
  }

  const Time start_ = from_utime(1'000'000'000);
  VirtualClock clock_{start_};
  WaitMovesTheClock transport_{clock_};
  std::unique_ptr<Transport> observing_ = transport_.hub().connect();
  Bus bus_{transport_, 1};
  Bus observer_{*observing_, 2};
  Ticker node_{start_ + milliseconds(5), milliseconds(20)};
  std::vector<models::ProcessHealth> health_;
};

TEST_F(RunNode, TicksAtTheRequestedTimes) {
  run_until(start_ + milliseconds(985));
  ASSERT_EQ(node_.ticks.size(), 50U);
  for (std::size_t i = 0; i < node_.ticks.size(); ++i) {
    EXPECT_EQ(node_.ticks[i], start_ + milliseconds(5) + static_cast<int>(i) * milliseconds(20));
  }
}

// From 2 s on, a thread waits 10 ms in every 100 ms for a processor.
TEST_F(RunNode, ReportsTheProcessorWaitBeforeEachTick) {
  class Waiter : public Ticker {
   public:
    using Ticker::Ticker;
    void on_processor_wait(double wait_s) override { waits_s.push_back(wait_s); }
    std::vector<double> waits_s;
  };
  Waiter waiter(start_ + milliseconds(5), milliseconds(20));
  const auto waited_us = [&]() -> std::optional<std::int64_t> {
    const auto since = std::max<Duration>(clock_.now() - start_ - seconds(2), Duration{0});
    return 3'000'000 + since.count() / 100'000 * 10'000;
  };
  run_node(
      bus_, waiter, clock_, [&] { return clock_.now() >= start_ + seconds(5); }, {}, nullptr,
      waited_us);
  ASSERT_GT(waiter.waits_s.size(), 75U);
  EXPECT_LT(waiter.waits_s.size(), 105U) << "not before every tick";
  EXPECT_EQ(waiter.waits_s[25], 0.0);
  EXPECT_NEAR(waiter.waits_s.back(), 0.1, 0.011);
  Waiter uncounted(start_ + seconds(5), milliseconds(20));
  run_node(
      bus_, uncounted, clock_, [&] { return clock_.now() >= start_ + seconds(6); }, {}, nullptr,
      [] { return std::optional<std::int64_t>(); });
  run_node(bus_, uncounted, clock_, [&] { return clock_.now() >= start_ + seconds(7); });
  EXPECT_TRUE(uncounted.waits_s.empty())
      << "the kernel does not count waits, or no device reads them";
}

TEST_F(RunNode, ChecksForStopDuringLongWaits) {
  Ticker sleeper(start_ + seconds(1'000), seconds(1));
  int checks = 0;
  run_node(bus_, sleeper, clock_, [&] { return ++checks > 10; });
  EXPECT_TRUE(sleeper.ticks.empty());
  EXPECT_EQ(transport_.longest_wait(), milliseconds(50));
}

/// A ticker with a device that is silent for twenty seconds.
class TickerWithADevice : public Ticker {
 public:
  using Ticker::Ticker;
  TickerWithADevice(const TickerWithADevice&) = delete;
  TickerWithADevice& operator=(const TickerWithADevice&) = delete;
  TickerWithADevice(TickerWithADevice&&) = delete;
  TickerWithADevice& operator=(TickerWithADevice&&) = delete;
  ~TickerWithADevice() override { close(device_); }
  [[nodiscard]] int wakes_on() const override { return device_; }
  void start() {
    const itimerspec after{{}, {20, 0}};
    ASSERT_EQ(timerfd_settime(device_, 0, &after, nullptr), 0);
  }
  void publish_value() {
    const itimerspec after{{}, {0, 1}};
    ASSERT_EQ(timerfd_settime(device_, 0, &after, nullptr), 0);
    pollfd polled{device_, POLLIN, 0};
    ASSERT_EQ(poll(&polled, 1, -1), 1);
  }
  [[nodiscard]] bool has_spoken() const {
    std::uint64_t times = 0;
    return read(device_, &times, sizeof times) > 0;
  }

 private:
  int device_ = timerfd_create(CLOCK_MONOTONIC, TFD_NONBLOCK);
};

TEST_F(RunNode, WaitsForADeviceUntilTheNextTickOnly) {
  TickerWithADevice node(start_ + milliseconds(1), milliseconds(1));
  node.start();
  int checks = 0;
  run_node(bus_, node, clock_, [&] { return ++checks > 3; });
  EXPECT_FALSE(node.has_spoken());
}

// The loop must wait until the next tick: otherwise the node would poll thousands of times per
// second.
TEST_F(RunNode, TicksOnTimeWithASilentDevice) {
  TickerWithADevice node(start_ + milliseconds(20), milliseconds(20));
  node.start();
  const std::int64_t begin_ns = monotonic_ns();
  int checks = 0;
  run_node(bus_, node, clock_, [&] { return ++checks > 1; });
  EXPECT_GE(monotonic_ns() - begin_ns, 20'000'000);
}

TEST_F(RunNode, TicksWhenItsDeviceHasData) {
  TickerWithADevice node(start_ + seconds(1'000), seconds(1));
  int checks = 0;
  run_node(bus_, node, clock_, [&] { return ++checks > 1; });
  EXPECT_TRUE(node.ticks.empty()) << "the device sends nothing";
  node.publish_value();
  checks = 0;
  run_node(bus_, node, clock_, [&] { return ++checks > 3; });
  EXPECT_EQ(node.ticks, (std::vector<Time>{start_, start_, start_})) << "before the requested time";
}

/// A node that needs time to stop, like the driver of a vehicle that must land.
class Lander : public Ticker {
 public:
  using Ticker::Ticker;
  void on_stop_request(int requests, Time now) override {
    stop_requests.emplace_back(requests, now);
  }
  [[nodiscard]] bool may_end(Time now) override { return now >= ends_at; }
  [[nodiscard]] InFlight in_flight(Time now) const override {
    return now >= ends_at ? InFlight::kNo : InFlight::kYes;
  }

  std::vector<std::pair<int, Time>> stop_requests;
  Time ends_at{};
};

TEST_F(RunNode, RunsUntilTheNodeMayEndAndReportsEachRequestOnce) {
  Lander node(start_ + milliseconds(20), milliseconds(20));
  node.ends_at = start_ + seconds(3);
  run_node(bus_, node, clock_, [&] {
    return clock_.now() < start_ + seconds(1) ? 0 : clock_.now() < start_ + seconds(2) ? 1 : 2;
  });
  using Asked = std::vector<std::pair<int, Time>>;
  EXPECT_EQ(node.stop_requests, (Asked{{1, start_ + seconds(1)}, {2, start_ + seconds(2)}}));
  EXPECT_EQ(node.ticks.size(), 150U) << "the node continues until the vehicle has landed";
}

TEST_F(RunNode, SendsHeartbeatsAndAFinalFlightState) {
  LivenessReceiver receiver;
  ASSERT_TRUE(receiver.open());
  LivenessSender life(dup(receiver.child_end()));
  Lander node(start_ + milliseconds(20), milliseconds(20));
  node.ends_at = start_ + seconds(1);
  std::vector<InFlight> signs;
  const auto take = [&] {
    if (const LivenessReceiver::Report come = receiver.take(); come.any) {
      signs.push_back(come.in_flight);
    }
  };
  run_node(
      bus_, node, clock_,
      [&] {
        take();
        return 1;
      },
      {}, &life);
  take();
  ASSERT_EQ(signs.size(), 11U) << "ten per second, and one at the landing";
  EXPECT_EQ(signs.front(), InFlight::kYes);
  EXPECT_EQ(signs[9], InFlight::kYes);
  EXPECT_EQ(signs.back(), InFlight::kNo);
}

TEST_F(RunNode, PublishesHealthEverySecond) {
  run_until(start_ + milliseconds(3'500));
  ASSERT_EQ(health_.size(), 6U)
      << "at the start, immediately, after each of three seconds, at the stop";
  EXPECT_EQ(health_.front().state, models::ProcessState::kStarting);
  EXPECT_EQ(health_.back().state, models::ProcessState::kStopping);
  for (std::size_t i = 2; i + 1 < health_.size(); ++i) {
    EXPECT_EQ(health_[i].state, models::ProcessState::kRunning);
    EXPECT_EQ(health_[i].stamp.time - health_[i - 1].stamp.time, seconds(1));
    EXPECT_GT(health_[i].loops, health_[i - 1].loops);
  }
}

TEST_F(RunNode, HandlesMessagesBetweenTicks) {
  int commands = 0;
  bus_.subscribe<models::OperatorCommand>(kCommand, [&](const auto&) { ++commands; });
  observer_.publish(kCommand, models::OperatorCommand{});
  run_until(start_ + milliseconds(2));
  EXPECT_EQ(commands, 1);
}

TEST_F(RunNode, EndsAtTheEndOfItsLog) {
  transport_.ends_at = start_ + seconds(1);
  run_node(bus_, node_, clock_, [] { return false; });
  EXPECT_EQ(node_.ticks.size(), 50U);
}

TEST_F(RunNode, RethrowsExceptionsOfHandlers) {
  bus_.subscribe<models::OperatorCommand>(kCommand,
                                          [](const auto&) { throw std::runtime_error("no"); });
  observer_.publish(kCommand, models::OperatorCommand{});
  EXPECT_THROW(run_until(start_ + seconds(1)), std::runtime_error);
}

class Health : public RunNode {};

TEST_F(Health, IsPublishedAtOnceAndDegradedAfterADrop) {
  HealthReporter reporter(bus_, node_);
  const auto loop = [&](Duration at) {
    reporter.on_loop(start_ + at, 0.001);
    observer_.handle(std::chrono::microseconds{0});
    return health_.size();
  };
  EXPECT_EQ(loop(milliseconds(0)), 1U);
  EXPECT_EQ(loop(milliseconds(500)), 1U) << "nothing has changed";
  node_.stale_inputs = 3;
  EXPECT_EQ(loop(milliseconds(510)), 2U);
  EXPECT_EQ(health_.back().state, models::ProcessState::kDegraded);
  ++node_.stale_inputs;
  EXPECT_EQ(loop(milliseconds(520)), 2U) << "at most ten per second";
  EXPECT_EQ(loop(milliseconds(610)), 3U);
  EXPECT_EQ(loop(milliseconds(1'000)), 4U);
  EXPECT_EQ(health_.back().state, models::ProcessState::kDegraded) << "a loss within this second";
  EXPECT_EQ(loop(milliseconds(2'000)), 5U);
  EXPECT_EQ(health_.back().state, models::ProcessState::kRunning) << "no loss since then";
  ++node_.rest_rounds;
  EXPECT_EQ(loop(milliseconds(2'500)), 5U) << "an idle loop is not a fault";
}

// The limit of ten reports per second is exact to the microsecond. The periodic report follows one
// second after the last periodic report.
TEST_F(Health, IsPublishedAtMostTenTimesPerSecond) {
  HealthReporter reporter(bus_, node_);
  const auto reports = [&](Duration at) {
    reporter.on_loop(start_ + at, 0.001);
    observer_.handle(std::chrono::microseconds{0});
    return health_.size();
  };
  EXPECT_EQ(reports(milliseconds(0)), 1U);
  ++node_.stale_inputs;
  EXPECT_EQ(reports(milliseconds(100) - Duration{1}), 1U);
  EXPECT_EQ(reports(milliseconds(100)), 2U);
  EXPECT_EQ(reports(milliseconds(300)), 2U) << "the loss has been reported";
  EXPECT_EQ(reports(seconds(1) - Duration{1}), 2U);
  EXPECT_EQ(reports(seconds(1)), 3U) << "the periodic report does not depend on reports in between";
  EXPECT_EQ(reports(seconds(2)), 4U);
  EXPECT_EQ(health_.back().stamp.time, start_ + seconds(2));
  EXPECT_EQ(health_.back().process, "TICKER");
}

TEST_F(Health, IsDegradedByLossNotByTraffic) {
  bus_.subscribe<models::AttackNotice>(kAttack, [](const auto&) {});
  HealthReporter reporter(bus_, node_);
  int second = 0;
  const auto state = [&] {
    reporter.on_loop(start_ + seconds(second++), 0.001);
    observer_.handle(std::chrono::microseconds{0});
    return health_.back().state;
  };
  const auto deliver_notice = [&] {
    observer_.publish(kAttack, models::AttackNotice{});
    bus_.handle(std::chrono::microseconds{0});
  };
  EXPECT_EQ(state(), models::ProcessState::kRunning);
  deliver_notice();
  node_.busy_us += 1'000;
  node_.rest_rounds += 1;
  EXPECT_EQ(state(), models::ProcessState::kRunning) << "receives, works and rests";
  node_.missed += 2;
  EXPECT_EQ(state(), models::ProcessState::kDegraded);
  EXPECT_EQ(health_.back().deadlines_missed, 2);
  EXPECT_EQ(state(), models::ProcessState::kRunning) << "the loss was two seconds ago";
  bus_.unsubscribe(kAttack.name);
  const auto raw = transport_.hub().connect();
  bus_.subscribe<models::AttackNotice>(kAttack, [](const auto&) {});
  raw->publish(kAttack.name, std::vector<std::uint8_t>{1});
  bus_.handle(std::chrono::microseconds{0});
  EXPECT_EQ(state(), models::ProcessState::kDegraded) << "a message could not be decoded";
}

// A rejected input is not a loss.
TEST(IsNormalCounter, IsTrueForTrafficAndDurationsAndRejections) {
  for (const char* name : {"transport.messages_sent", "PLAN_Q1.fresh", "busy_us", "rest_rounds",
                           "gated", "undiscoverable", "jammed_looks", "map.jammed_scans"}) {
    EXPECT_TRUE(is_normal_counter(name)) << name;
  }
  for (const char* name : {"PLAN_Q1.lost", "stale_beliefs", "plans_late", "malformed_beliefs"}) {
    EXPECT_FALSE(is_normal_counter(name)) << name;
  }
}

TEST_F(Health, ReportsItsWorstLoop) {
  HealthReporter reporter(bus_, node_);
  for (const double loop_s : {0.002, 0.007, 0.003}) {
    reporter.on_loop(start_, loop_s);
  }
  reporter.publish(start_, models::ProcessState::kStopping);
  reporter.publish(start_, models::ProcessState::kStopping);
  observer_.handle(std::chrono::microseconds{0});
  ASSERT_EQ(health_.size(), 3U);
  EXPECT_EQ(health_[1].loop_worst_s, 0.007);
  EXPECT_EQ(health_[1].loops, 3);
  EXPECT_EQ(health_[2].loop_worst_s, 0.0) << "no loop since the last report";
}

TEST_F(Health, ContainsCountersAndTheWorstLoopSinceTheLastReport) {
  HealthReporter reporter(bus_, node_, [] {
    return std::vector<models::NamedCount>{{"process.memory_bytes", 4096}};
  });
  node_.stale_inputs = 7;
  reporter.on_loop(start_, 0.004);
  reporter.on_loop(start_ + milliseconds(1), 0.2);
  reporter.on_loop(start_ + seconds(1), 0.1);
  observer_.handle(std::chrono::microseconds{0});
  ASSERT_EQ(health_.size(), 2U);
  EXPECT_EQ(health_[0].loop_worst_s, 0.004);
  EXPECT_EQ(health_[1].loop_worst_s, 0.2);
  EXPECT_EQ(health_[1].loops, 3);
  for (int more = 2; more <= 3; ++more) {  // each second has its own worst loop
    reporter.on_loop(start_ + seconds(more), 0.003);
    observer_.handle(std::chrono::microseconds{0});
    EXPECT_EQ(health_.back().loop_worst_s, 0.003);
  }
  std::map<std::string, std::int64_t> counters;
  for (const models::NamedCount& counter : health_[1].counters) {
    counters[counter.name] = counter.count;
  }
  EXPECT_EQ(counters["stale_inputs"], 7);
  EXPECT_EQ(counters["transport.messages_sent"], 1);
  EXPECT_EQ(counters["process.memory_bytes"], 4096);
}

/// An endpoint whose waits advance the machine's monotonic clock; the wall clock is set at given
/// times.
class SetWallClock : public OwnHub {
 public:
  int handle(std::chrono::microseconds timeout) override {
    since_start += timeout;
    return OwnHub::handle(std::chrono::microseconds{0});
  }
  [[nodiscard]] Duration set() const {
    return since_start < seconds(2)   ? Duration{0}
           : since_start < seconds(4) ? Duration{-seconds(3)}
           : since_start < seconds(6) ? Duration{-std::chrono::hours(1)}
                                      : Duration{std::chrono::hours(1)};
  }

  Duration since_start{};
};

TEST(RunNodeBySteadyClock, TicksOnTimeWhenTheWallClockIsSet) {
  const Time start = from_utime(1'700'000'000'000'000);
  SetWallClock machine;
  const SteadyClock clock([&] { return std::chrono::nanoseconds(machine.since_start).count(); },
                          [&] { return start + machine.since_start + machine.set(); });
  Bus bus(machine, 1);
  bus.use_clock(clock);
  Ticker node(start + milliseconds(5), milliseconds(20));
  run_node(bus, node, clock, [&] { return machine.since_start >= milliseconds(7'985); });
  ASSERT_EQ(node.ticks.size(), 400U);
  for (std::size_t i = 0; i < node.ticks.size(); ++i) {
    EXPECT_EQ(node.ticks[i], start + milliseconds(5) + static_cast<int>(i) * milliseconds(20));
  }
}

}  // namespace
}  // namespace vantage::bus
