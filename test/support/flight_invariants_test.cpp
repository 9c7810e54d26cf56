// A made-up flight that keeps every invariant, and each of them broken once.

#include "test/support/flight_invariants.hpp"

#include <cmath>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bus/convert/convert.hpp"
#include "core/angle.hpp"
#include "core/pose.hpp"
#include "scenario/reader/scenario_yaml.hpp"

namespace vantage::test {
namespace {

using models::FlightState;

constexpr Time kStart = from_utime(1'700'000'000'000'000);
constexpr double kFollowS = 2.0;
constexpr double kLandS = 18.0;

/// Q1 and Q2 of the lab sway about their starts, Q3 stays on the ground out of sight.
class MadeUpFlight {
 public:
  /// Change what is told at `t_s`; false: it is not told.
  std::function<bool(double t_s, models::VehicleStatus&)> says =
      [](double, models::VehicleStatus&) { return true; };
  std::function<bool(double t_s, models::TruthBody&)> is = [](double, models::TruthBody&) {
    return true;
  };
  std::function<void(double t_s, FlightRecord&)> besides = [](double, FlightRecord&) {};

  [[nodiscard]] FlightRecord record() const {
    FlightRecord out;
    models::ScenarioNotice notice;
    notice.stamp.time = kStart;
    notice.yaml = scenario::load_scenario(VANTAGE_SOURCE_DIR "/config/lab.yaml").source_text;
    give(out, "SCENARIO", kStart, notice);
    for (int i = 0; i <= 1000; ++i) {
      const double t_s = 0.02 * i;
      tell_truth(out, t_s, i);
      if (i % 5 == 0) {
        tell_state(out, "Q1", t_s, i / 5);
        tell_state(out, "Q2", t_s, i / 5);
      }
      besides(t_s, out);
    }
    return out;
  }

  /// As LCM's log has it.
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
    out.state = t_s < 1.0        ? FlightState::kIdle
                : t_s < kFollowS ? FlightState::kHold
                : t_s < kLandS   ? FlightState::kFollow
                                 : FlightState::kLand;
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

/// The robots and invariants that are broken: "Q1 speed".
std::vector<std::string> broken(const FlightRecord& record, const FlightBounds& bounds = {}) {
  std::vector<std::string> out;
  for (const std::string& line : violations(record, bounds)) {
    out.push_back(line.substr(0, line.find(':')));
  }
  return out;
}

using Names = std::vector<std::string>;

TEST(FlightInvariants, AreAllKeptByAFlightToWhichNothingHappens) {
  EXPECT_EQ(violations(MadeUpFlight().record()), Names{});
  EXPECT_EQ(violations(FlightRecord()), Names{"nothing flew: no SCENARIO, or no vehicle"});
}

TEST(FlightInvariants, NameTheVehicleWhatWasSeenAndWhatIsAllowed) {
  MadeUpFlight flight;
  flight.is = [](double t_s, models::TruthBody& body) {
    if (body.name == "Q2" && std::abs(t_s - 9.0) < 0.1) {
      body.velocity_world_mps.y() = 1.2;
    }
    return true;
  };
  const auto lines = violations(flight.record());
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_TRUE(lines[0].starts_with("Q2 speed: 1.")) << lines[0];
  EXPECT_TRUE(lines[0].ends_with("of its limit (at most 1.15)")) << lines[0];
}

TEST(FlightInvariants, WhoMayHoldIsNotAskedToFollow) {
  MadeUpFlight flight;
  flight.says = [](double t_s, models::VehicleStatus& status) {
    if (t_s > 7.0 && t_s < 9.0) {
      status.state = FlightState::kHold;
    }
    return true;
  };
  FlightBounds bounds;
  EXPECT_EQ(broken(flight.record(), bounds), (Names{"Q1 following", "Q2 following"}));
  bounds.may_hold = {"Q1"};
  EXPECT_EQ(broken(flight.record(), bounds), Names{"Q2 following"});
}

// Each of them at a moment of the flight, for Q1 alone.
TEST(FlightInvariants, EachIsBrokenByWhatItIsFor) {
  struct Case {
    std::function<bool(double, models::VehicleStatus&)> says;
    std::function<bool(double, models::TruthBody&)> is;
    Names broken;
  };
  const auto during = [](double t_s, double begin_s, double lasts_s) {
    return t_s >= begin_s && t_s < begin_s + lasts_s;
  };
  const auto q1 = [&during](double begin_s, double lasts_s, auto change) {
    return [=](double t_s, auto& told) {
      const std::string* name = nullptr;
      if constexpr (requires { told.robot; }) {
        name = &told.robot;
      } else {
        name = &told.name;
      }
      return *name != "Q1" || !during(t_s, begin_s, lasts_s) || change(told);
    };
  };
  const auto as_it_is = [](double, auto&) { return true; };
  const Case cases[] = {
      {q1(5.0, 2.0,
          [](models::VehicleStatus& said) {
            said.state = FlightState::kHold;
            return true;
          }),
       as_it_is,
       {"Q1 following"}},
      {q1(5.0, 12.0,
          [](models::VehicleStatus& said) {
            said.setpoint_height_m += 0.2;
            return true;
          }),
       as_it_is,
       {"Q1 set-point error"}},
      {as_it_is,
       q1(5.0, 0.3,
          [](models::TruthBody& body) {
            body.world_from_body = lift({body.world_from_body.translation_m.x(), 0.0, 0.0}, 1.0);
            return true;
          }),
       {"Q1 turn"}},
      {q1(5.0, 0.1,
          [](models::VehicleStatus& said) {
            said.setpoint.y_m += 0.3;
            return true;
          }),
       as_it_is,
       {"Q1 continuity"}},
      {q1(17.95, 0.5,
          [](models::VehicleStatus& said) {
            said.state = FlightState::kFollow;
            said.reasons = {"fence"};
            return true;
          }),
       as_it_is,
       {"Q1 fence"}},
      {q1(5.0, 0.6, [](models::VehicleStatus&) { return false; }), as_it_is, {"Q1 ages"}},
      {as_it_is, q1(5.0, 0.6, [](models::TruthBody&) { return false; }), {"Q1 ages"}},
  };
  for (const Case& each : cases) {
    MadeUpFlight flight;
    flight.says = each.says;
    flight.is = each.is;
    EXPECT_EQ(broken(flight.record()), each.broken);
  }
}

/// For a moment in which no driver says where its vehicle is to be.
bool is_between_words(double t_s) { return std::abs(t_s - 9.05) < 0.025; }

TEST(FlightInvariants, ANearMissIsBothVehicles) {
  MadeUpFlight flight;
  flight.is = [](double t_s, models::TruthBody& body) {
    if (body.name == "Q2" && is_between_words(t_s)) {
      body.world_from_body.translation_m.x() = -3.0 + 0.5 * std::sin(t_s) + 0.45;
    }
    return true;
  };
  EXPECT_EQ(broken(flight.record()), (Names{"Q1 separation", "Q2 separation"}));
}

TEST(FlightInvariants, OutsideIsBeyondTheBoundsOrInAnObstacle) {
  for (const Eigen::Vector2d& place_m : {Eigen::Vector2d(-3.0, 2.1), Eigen::Vector2d(-1.5, 0.8)}) {
    MadeUpFlight flight;
    flight.is = [&](double t_s, models::TruthBody& body) {
      if (body.name == "Q1" && is_between_words(t_s)) {
        body.world_from_body.translation_m.head<2>() = place_m;
      }
      return true;
    };
    EXPECT_EQ(broken(flight.record()), Names{"Q1 fence"});
  }
}

// Another run in its name is not believed while its own is alive; after a silence it is, and says
// that its driver was another.
TEST(FlightInvariants, SayWhoElseSpokeAndHowOftenADriverBeganAnew) {
  MadeUpFlight beside;
  beside.besides = [](double t_s, FlightRecord& record) {
    if (std::abs(t_s - 9.01) < 0.05) {
      models::VehicleStatus status = MadeUpFlight::state_of("Q1", t_s);
      status.stamp.run_id = 66;
      status.state = FlightState::kKilled;
      MadeUpFlight::give(record, "VEHICLE_Q1", MadeUpFlight::at(t_s), status);
      models::TruthFrame truth;
      truth.stamp = {MadeUpFlight::at(t_s), 77, 0};
      MadeUpFlight::give(record, "TRUTH", MadeUpFlight::at(t_s), truth);
    }
  };
  EXPECT_EQ(broken(beside.record()), (Names{"TRUTH believed", "Q1 believed"}));

  MadeUpFlight anew;
  anew.says = [](double t_s, models::VehicleStatus& status) {
    status.stamp.run_id += t_s > 9.0 && status.robot == "Q1" ? 100 : 0;
    return status.robot != "Q1" || t_s < 8.3 || t_s > 9.0;
  };
  EXPECT_EQ(broken(anew.record()), (Names{"Q1 ages", "Q1 believed"}));
  FlightBounds mishap;
  mishap.runs_max = 2;
  mishap.gap_max_s = 1.0;
  EXPECT_EQ(broken(anew.record(), mishap), Names{});
}

/// Each second `process` says how long it has waited, of which `waits_us` in the second before
/// `t_s`.
struct Waits {
  std::int64_t run_id = 5;
  std::int64_t sum_us = 7'000'000;
  std::int64_t cpu_us = 9'000'000;

  void say(FlightRecord& record, double t_s, std::int64_t waits_us,
           const std::string& process = "PLANNER_Q1", std::int64_t runs_us = 100'000) {
    sum_us += waits_us;
    cpu_us += runs_us;
    models::ProcessHealth health;
    health.stamp = {MadeUpFlight::at(t_s), run_id, 0};
    health.process = process;
    health.counters = {{"process.cpu_us", cpu_us}, {"process.waited_us", sum_us}};
    MadeUpFlight::give(record, "HEALTH_" + process, MadeUpFlight::at(t_s), health);
  }
};

/// Q1 holds for 2 s on the way, in which a process waits as long as said.
MadeUpFlight flight_held_up_us(std::int64_t waits_us) {
  MadeUpFlight flight;
  flight.says = [](double t_s, models::VehicleStatus& status) {
    if (status.robot == "Q1" && t_s > 7.0 && t_s < 9.0) {
      status.state = FlightState::kHold;
    }
    return true;
  };
  flight.besides = [waits_us, waits = Waits()](double t_s, FlightRecord& record) mutable {
    if (const double second = std::round(t_s); std::abs(t_s - second) < 0.001) {
      waits.say(record, t_s, second == 8.0 ? waits_us : 1'000);
    }
  };
  return flight;
}

TEST(FlightInvariants, WhatTakesTimeIsJudgedWhereTheMachineWasThere) {
  const FlightRecord there = flight_held_up_us(100'000).record();
  EXPECT_EQ(held_up(there), std::nullopt);
  EXPECT_EQ(broken(there), Names{"Q1 following"});

  const FlightRecord away = flight_held_up_us(100'001).record();
  EXPECT_EQ(held_up(away).value_or(""),
            "PLANNER_Q1 waited 0.10 s for a processor in the second before 1700000008000000 (at "
            "most 0.1)");
  EXPECT_EQ(broken(away), Names{});
  FlightBounds patient;
  patient.held_up_max_s = 0.2;
  EXPECT_EQ(held_up(away, patient), std::nullopt);
  EXPECT_EQ(broken(away, patient), Names{"Q1 following"});
  FlightBounds slowed;
  slowed.is_slowed = true;
  EXPECT_EQ(held_up(there, slowed), "a sanitizer slows all down");
  EXPECT_EQ(broken(there, slowed), Names{});
}

TEST(FlightInvariants, SafetyIsJudgedWhateverTheMachineDoes) {
  MadeUpFlight near = flight_held_up_us(900'000);
  near.is = [](double t_s, models::TruthBody& body) {
    if (body.name == "Q2" && is_between_words(t_s)) {
      body.world_from_body.translation_m.x() = -3.0 + 0.5 * std::sin(t_s) + 0.45;
    }
    return true;
  };
  EXPECT_EQ(broken(near.record()), (Names{"Q1 separation", "Q2 separation"}));

  MadeUpFlight outside = flight_held_up_us(900'000);
  outside.is = [](double t_s, models::TruthBody& body) {
    if (body.name == "Q1" && is_between_words(t_s)) {
      body.world_from_body.translation_m.y() = 2.1;
    }
    return true;
  };
  EXPECT_EQ(broken(outside.record()), Names{"Q1 fence"});

  MadeUpFlight strange = flight_held_up_us(900'000);
  strange.besides = [before = strange.besides](double t_s, FlightRecord& record) {
    before(t_s, record);
    if (std::abs(t_s - 9.02) < 0.005) {
      models::VehicleStatus status = MadeUpFlight::state_of("Q1", t_s);
      status.stamp.run_id = 66;
      MadeUpFlight::give(record, "VEHICLE_Q1", MadeUpFlight::at(t_s), status);
    }
  };
  EXPECT_EQ(broken(strange.record()), Names{"Q1 believed"});

  MadeUpFlight idle = flight_held_up_us(900'000);
  idle.says = [](double, models::VehicleStatus& status) {
    status.state = status.robot == "Q1" ? FlightState::kIdle : status.state;
    return true;
  };
  EXPECT_EQ(broken(idle.record()), Names{"Q1 following"});
}

// Of whichever process and second it was the longest; not while all start, nor by what a process of
// another run had waited.
TEST(FlightInvariants, TheLongestWaitSinceSomebodyFollowsIsOfOneRun) {
  MadeUpFlight flight;
  flight.besides = [planner = Waits(), sim = Waits()](double t_s, FlightRecord& record) mutable {
    const double second = std::round(t_s);
    if (std::abs(t_s - second) > 0.001) {
      return;
    }
    planner.say(record, t_s, second <= kFollowS ? 800'000 : second == 6.0 ? 50'000 : 0);
    if (second == 10.0) {
      sim = {6, 60'000'000, 0};
    }
    sim.say(record, t_s, second == 5.0 ? 60'000 : second == 12.0 ? 70'000 : 0, "SIM");
  };
  const FlightRecord record = flight.record();
  ASSERT_TRUE(record.held_up());
  EXPECT_EQ(record.held_up()->process, "SIM");
  EXPECT_NEAR(record.held_up()->waited_s, 0.07, 1e-9);
  EXPECT_EQ(record.held_up()->until, MadeUpFlight::at(12.0));
  EXPECT_FALSE(MadeUpFlight().record().held_up()) << "of a log that does not say it";

  MadeUpFlight older;
  older.besides = [](double t_s, FlightRecord& told) {
    models::ProcessHealth health;
    health.stamp = {MadeUpFlight::at(t_s), 5, 0};
    health.process = "SIM";
    health.counters = {{"process.cpu_us", static_cast<std::int64_t>(5e5 * t_s)}};
    MadeUpFlight::give(told, "HEALTH_SIM", MadeUpFlight::at(t_s), health);
  };
  const FlightRecord of_older = older.record();
  EXPECT_FALSE(of_older.held_up()) << "nor of one that says what was used alone";
  EXPECT_NEAR(of_older.processors_used(), 0.5, 1e-6);
}

// Else who spins would be excused by having held up the others.
TEST(FlightInvariants, ProcessesThatTakeTheMachineThemselvesAreNotExcused) {
  for (const std::int64_t sim_runs_us : {600'000, 601'000}) {
    MadeUpFlight flight;
    flight.besides = [sim_runs_us, planner = Waits(), sim = Waits()](double t_s,
                                                                     FlightRecord& record) mutable {
      const double second = std::round(t_s);
      if (std::abs(t_s - second) > 0.001) {
        return;
      }
      const bool is_after = second > kFollowS;  // before, all start
      if (second == 10.0) {
        sim = {6, 0, 0};  // another run: nothing is known of its first second
      }
      planner.say(record, t_s, 300'000, "PLANNER_Q1", is_after ? 400'000 : 1'000'000);
      sim.say(record, t_s, 0, "SIM", second == 11.0 ? 2 * sim_runs_us : sim_runs_us);
    };
    const FlightRecord record = flight.record();
    EXPECT_NEAR(record.processors_used(), 0.4 + 1e-6 * static_cast<double>(sim_runs_us), 1e-9);
    EXPECT_TRUE(held_up(record));
    EXPECT_EQ(broken(record), sim_runs_us > 600'000 ? Names{"TEAM processors"} : Names{});
    FlightBounds slowed;
    slowed.is_slowed = true;
    EXPECT_EQ(broken(record, slowed), Names{});
  }
  EXPECT_EQ(MadeUpFlight().record().processors_used(), 0.0) << "of a log that does not say it";
}

TEST(FlightInvariants, AVehicleThatNeverFollowedIsNamed) {
  MadeUpFlight flight;
  flight.says = [](double, models::VehicleStatus& status) {
    status.state = status.robot == "Q1" ? FlightState::kIdle : status.state;
    return true;
  };
  EXPECT_EQ(violations(flight.record()), Names{"Q1 following: it never followed a plan"});
}

}  // namespace
}  // namespace vantage::test
