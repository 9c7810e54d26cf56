// Measures the cost of signing and verifying messages. To be built in release. Usage: auth_bench
// [--benchmark_filter=…]

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include <benchmark/benchmark.h>

#include "bus/auth/authenticator.hpp"
#include "bus/auth/envelope.hpp"
#include "bus/node/bus.hpp"
#include "bus/node/clock.hpp"
#include "test/bus/auth/auth_support.hpp"

namespace vantage {
namespace {

using bus::auth::Role;

constexpr Time kStart = Time{Duration{1'700'000'000'000'000}};

const char* channel_of(Role role) { return role == Role::kOperator ? "COMMAND" : "VICON"; }

void Sign(benchmark::State& state, Role role) {
  const bus::auth::Key key = test::key_of(role, 1);
  const std::vector<std::uint8_t> payload(static_cast<std::size_t>(state.range(0)), 7);
  std::vector<std::uint8_t> message;
  std::uint64_t counter = 0;
  for (auto _ : state) {
    message = payload;
    bus::auth::sign(key, channel_of(role), {key.id, 1, ++counter, role, scenario::TrialMode::kLive},
                    {}, message);
    benchmark::DoNotOptimize(message.data());
  }
}

void Verify(benchmark::State& state, Role role) {
  bus::auth::Keyring keyring;
  keyring.add(test::key_of(role, 1));
  const bus::auth::Key key = test::key_of(role, 1);
  std::vector<std::uint8_t> message(static_cast<std::size_t>(state.range(0)), 7);
  bus::auth::sign(
      key, channel_of(role),
      {key.id, 1, static_cast<std::uint64_t>(to_utime(kStart)), role, scenario::TrialMode::kLive},
      {}, message);
  const bus::auth::Budget any(1e9, 1e9);
  bus::auth::SignatureBudgets budgets({any, any}, {any, any}, {any, any});
  for (auto _ : state) {
    bus::auth::ReplayGuard replays;  // new in each iteration: an old one would refuse a replay
    const auto verdict =
        bus::auth::verify(keyring, channel_of(role), message,
                          {scenario::TrialMode::kLive, kStart, true, false}, replays, budgets);
    if (verdict.refusal != bus::auth::Refusal::kNone) {
      state.SkipWithError(bus::auth::name_of(verdict.refusal));
    }
  }
}

void RefuseForged(benchmark::State& state) {
  bus::auth::Keyring keyring;
  keyring.add(test::key_of(Role::kOperator, 1));
  const bus::auth::Key key = test::key_of(Role::kOperator, 1);
  std::vector<std::uint8_t> message(static_cast<std::size_t>(state.range(0)), 7);
  bus::auth::sign(key, "COMMAND", {key.id, 1, 5, Role::kOperator, scenario::TrialMode::kLive}, {},
                  message);
  message[0] ^= 1U;
  bus::auth::SignatureBudgets budgets;
  bus::auth::ReplayGuard replays;
  for (auto _ : state) {
    benchmark::DoNotOptimize(bus::auth::verify(keyring, "COMMAND", message,
                                               {scenario::TrialMode::kLive, kStart, true, false},
                                               replays, budgets));
  }
}

/// Measures one second of work of a vehicle's driver in a lab with three vehicles and five targets.
/// The driver receives or sends 100 frames of eight bodies, 5 heartbeats, 30 statuses (10 of its
/// own) and one plan. range(0): 1 if messages are signed and verified, else 0.
void SecondOfADriver(benchmark::State& state) {
  bus::InProcessHub hub;
  bus::VirtualClock clock(kStart);
  const auto lab_link = hub.connect();
  const auto own_link = hub.connect();
  bus::Bus lab(*lab_link, 1);
  bus::Bus own(*own_link, 2);
  if (state.range(0) != 0) {
    lab.secure(test::authenticator(test::keys_of_a_trial()), clock);
    own.secure(test::authenticator(test::keys_of_a_trial()), clock);
  }
  own.use_clock(clock);
  own.act_as_vehicle("Q1");
  std::int64_t received_count = 0;
  own.subscribe<models::MocapFrame>(bus::kVicon, [&](const auto&) { ++received_count; });
  own.subscribe<models::RobotPlan>(bus::plan_channel("*"), [&](const auto&) { ++received_count; });
  own.subscribe<models::VehicleStatus>(bus::vehicle_channel("*"),
                                       [&](const auto&) { ++received_count; });
  own.subscribe<models::OperatorCommand>(bus::kCommand, [&](const auto&) { ++received_count; });
  lab.subscribe<models::VehicleStatus>(bus::vehicle_channel("*"), [](const auto&) {});
  models::MocapFrame frame;
  for (int i = 0; i < 8; ++i) {
    frame.bodies.push_back({"B" + std::to_string(i), Pose3{}, false});
  }
  models::RobotPlan plan;
  plan.robot = "Q1";
  plan.trajectory.segments.resize(20, {{0.5, 0.1}, 0.5, 0.0});
  models::VehicleStatus status;
  status.robot = "Q1";
  status.reasons = {"waiting for take-off height"};
  models::OperatorCommand beat;
  beat.action = models::OperatorAction::kHeartbeat;
  // Only the driver's own time counts: verifying, receiving and sending.
  for (auto _ : state) {
    std::int64_t driver_ns = 0;
    const auto timed = [&](auto&& what) {
      const auto start = std::chrono::steady_clock::now();
      what();
      driver_ns += std::chrono::duration_cast<std::chrono::nanoseconds>(
                       std::chrono::steady_clock::now() - start)
                       .count();
    };
    for (int i = 0; i < 100; ++i) {
      clock.set(clock.now() + std::chrono::milliseconds(10));
      frame.stamp.time = frame.arrival = beat.stamp.time = status.stamp.time = clock.now();
      lab.publish(bus::kVicon, frame);
      if (i % 10 == 0) {
        timed([&] { own.publish(bus::vehicle_channel("Q1"), status); });
        lab.publish(bus::vehicle_channel("Q2"), status);
        lab.publish(bus::vehicle_channel("Q3"), status);
      }
      if (i % 20 == 0) {
        while (lab.handle(std::chrono::microseconds(0)) > 0) {
        }
        lab.publish(bus::kCommand, beat);
      }
      if (i == 50) {
        plan.trajectory.start_time = plan.stamp.time = clock.now();
        lab.publish(bus::plan_channel("Q1"), plan);
      }
      timed([&] {
        while (own.handle(std::chrono::microseconds(0)) > 0) {
        }
      });
    }
    state.SetIterationTime(static_cast<double>(driver_ns) * 1e-9);
  }
  state.counters["heard_per_s"] =
      static_cast<double>(received_count) / static_cast<double>(state.iterations());
}

BENCHMARK_CAPTURE(Sign, mac, Role::kMocap)->Arg(250)->Arg(1'000)->Arg(4'500);
BENCHMARK_CAPTURE(Verify, mac, Role::kMocap)->Arg(250)->Arg(1'000)->Arg(4'500);
BENCHMARK_CAPTURE(Sign, command, Role::kOperator)->Arg(48)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(Verify, command, Role::kOperator)->Arg(48)->Unit(benchmark::kMicrosecond);
BENCHMARK(RefuseForged)->Arg(48);
BENCHMARK(SecondOfADriver)->Arg(0)->Arg(1)->UseManualTime()->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace vantage

BENCHMARK_MAIN();
