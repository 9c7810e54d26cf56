// Tests the detection of flights that an overloaded host delayed, and the rules that still apply to
// them.

#include <cmath>
#include <cstdint>
#include <string>
#include <tuple>

#include <gtest/gtest.h>

#include "test/support/flight_invariants.hpp"
#include "test/support/made_up_flight.hpp"

namespace vantage::test {
namespace {

using models::FlightState;
using Names = std::vector<std::string>;

/// Publishes each second the CPU and waiting time of `process`, which waited `waits_us` in the
/// second before `t_s`.
struct Waits {
  std::int64_t run_id = 5;
  std::int64_t sum_us = 7'000'000;
  std::int64_t cpu_us = 9'000'000;

  void report(FlightRecord& record, double t_s, std::int64_t waits_us,
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

/// Returns a flight in which Q1 holds for 2 s while a process waits `waits_us` for a processor.
MadeUpFlight flight_held_up_us(std::int64_t waits_us) {
  MadeUpFlight flight;
  flight.says = [](double t_s, models::VehicleStatus& status) {
    if (status.robot == "Q1" && t_s > 7.0 && t_s < 9.0) {
      status.state = FlightState::kHold;
    }
    return true;
  };
  flight.add_messages = [waits_us, waits = Waits()](double t_s, FlightRecord& record) mutable {
    if (const double second = std::round(t_s); std::abs(t_s - second) < 0.001) {
      waits.report(record, t_s, second == 8.0 ? waits_us : 1'000);
    }
  };
  return flight;
}

TEST(DelayedFlight, IsJudgedByTimingOnlyIfTheHostWasIdle) {
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

/// Returns a flight in which Q1 lands for `reason` from 10 s on, the autopilot lands it alone from
/// 11 s on, and Q1 touches `other` at `touches_s`.
MadeUpFlight flight_that_touches(const std::string& other, double touches_s, std::int64_t waits_us,
                                 const std::string& reason = "pose lost") {
  MadeUpFlight flight = flight_held_up_us(waits_us);
  flight.says = [reason](double t_s, models::VehicleStatus& status) {
    if (status.robot == "Q1" && t_s > 9.99) {
      status.state = FlightState::kLand;
      status.reasons = {reason + "; what its rule is"};
      if (t_s > 10.99) {
        status.reasons.emplace_back("waiting for touch-down");
      }
    }
    return true;
  };
  flight.add_messages = [=, before = flight.add_messages](double t_s, FlightRecord& record) {
    before(t_s, record);
    if (std::abs(t_s - touches_s) < 0.001) {
      models::CollisionReport contact;
      contact.stamp.time = MadeUpFlight::at(t_s);
      contact.body_a = "Q1";
      contact.body_b = other;
      for (const auto kind :
           {models::CollisionKind::kNearMiss, models::CollisionKind::kCollision}) {
        contact.kind = kind;
        MadeUpFlight::give(record, "COLLISION", contact.stamp.time, contact);
      }
    }
  };
  return flight;
}

TEST(DelayedFlight, IsExcusedForACollisionInABlindLanding) {
  const FlightRecord blind = flight_that_touches("R2", 12.0, 100'001).record();
  ASSERT_EQ(blind.collisions().size(), 1U);
  EXPECT_EQ(blind.collisions()[0].text,
            "Q1 with R2; Q1 was at 1.00 m, land: pose lost, waiting for touch-down");
  EXPECT_EQ(collisions(blind), Names{});
  // A collision counts if the host delayed nothing, the driver still steered (before 11 s), the
  // other body was a robot, or the vehicle landed for a reason other than a lost pose.
  for (const auto& [other, touches_s, waits_us] :
       {std::tuple{"R2", 12.0, std::int64_t{100'000}},
        std::tuple{"R2", 10.5, std::int64_t{100'001}}, std::tuple{"R2", 9.0, std::int64_t{100'001}},
        std::tuple{"Q2", 12.0, std::int64_t{100'001}}}) {
    EXPECT_EQ(collisions(flight_that_touches(other, touches_s, waits_us).record()).size(), 1U)
        << other << " " << touches_s << " " << waits_us;
  }
  EXPECT_EQ(collisions(flight_that_touches("R2", 12.0, 100'001, "operator lost").record()).size(),
            1U);
}

TEST(DelayedFlight, IsStillJudgedBySafety) {
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
  strange.add_messages = [before = strange.add_messages](double t_s, FlightRecord& record) {
    before(t_s, record);
    if (std::abs(t_s - 9.02) < 0.005) {
      models::VehicleStatus status = MadeUpFlight::state_of("Q1", t_s);
      status.stamp.run_id = 66;
      MadeUpFlight::give(record, "VEHICLE_Q1", MadeUpFlight::at(t_s), status);
    }
  };
  EXPECT_EQ(broken(strange.record()), Names{"Q1 believed"});

  MadeUpFlight anew = flight_held_up_us(900'000);
  anew.says = [](double t_s, models::VehicleStatus& status) {
    status.stamp.run_id += t_s > 9.0 && status.robot == "Q1" ? 100 : 0;
    return status.robot != "Q1" || t_s < 8.3 || t_s > 9.0;
  };
  EXPECT_EQ(broken(anew.record()), Names{"Q1 believed"});

  MadeUpFlight grounded = flight_held_up_us(900'000);
  grounded.says = [](double t_s, models::VehicleStatus& status) {
    if (status.robot == "Q1" && t_s > 9.0) {
      status.reasons = {"fence"};
    }
    return true;
  };
  EXPECT_EQ(broken(grounded.record()), Names{"Q1 fence"});

  MadeUpFlight idle = flight_held_up_us(900'000);
  idle.says = [](double, models::VehicleStatus& status) {
    status.state = status.robot == "Q1" ? FlightState::kIdle : status.state;
    return true;
  };
  EXPECT_EQ(broken(idle.record()), Names{"Q1 following"});
}

// The longest wait of any process in any second is reported. Waits during the start and
// waits of another run of the process do not count.
TEST(DelayedFlight, ReportsTheLongestWaitWithinOneRun) {
  MadeUpFlight flight;
  flight.add_messages = [planner = Waits(), sim = Waits()](double t_s,
                                                           FlightRecord& record) mutable {
    const double second = std::round(t_s);
    if (std::abs(t_s - second) > 0.001) {
      return;
    }
    planner.report(record, t_s, second <= kFollowS ? 800'000 : second == 6.0 ? 50'000 : 0);
    if (second == 10.0) {
      sim = {6, 60'000'000, 0};
    }
    sim.report(record, t_s, second == 5.0 ? 60'000 : second == 12.0 ? 70'000 : 0, "SIM");
  };
  FlightBounds impatient;
  impatient.held_up_max_s = 0.045;
  EXPECT_EQ(held_up(flight.record(), impatient).value_or(""),
            "SIM waited 0.07 s for a processor in the second before 1700000012000000 (at most "
            "0.045)");
  impatient.held_up_max_s = 0.071;
  EXPECT_FALSE(held_up(flight.record(), impatient));
  impatient.held_up_max_s = 0.0;
  EXPECT_FALSE(held_up(MadeUpFlight().record(), impatient)) << "the log lacks the waiting times";

  MadeUpFlight older;
  older.add_messages = [](double t_s, FlightRecord& flight_record) {
    models::ProcessHealth health;
    health.stamp = {MadeUpFlight::at(t_s), 5, 0};
    health.process = "SIM";
    health.counters = {{"process.cpu_us", static_cast<std::int64_t>(5e5 * t_s)}};
    MadeUpFlight::give(flight_record, "HEALTH_SIM", MadeUpFlight::at(t_s), health);
  };
  const FlightRecord of_older = older.record();
  EXPECT_FALSE(held_up(of_older, impatient)) << "the log contains processor use only";
  EXPECT_NEAR(processors_used(of_older, MadeUpFlight::at(5.0), MadeUpFlight::at(9.0)), 0.5, 1e-6);
}

// Two processes report at different instants of the second. Each counts with the part of its second
// inside the requested span.
TEST(DelayedFlight, CountsProcessorTimeOfTheRequestedSpan) {
  MadeUpFlight flight;
  flight.add_messages = [planner = Waits(), sim = Waits()](double t_s,
                                                           FlightRecord& record) mutable {
    const double second = std::round(t_s);
    if (std::abs(t_s - second) < 0.001) {
      planner.report(record, t_s, 0, "PLANNER_Q1", second == 7.0 ? 800'000 : 200'000);
    } else if (std::abs(t_s - second) > 0.499) {
      sim.report(record, t_s, 0, "SIM", std::abs(t_s - 6.5) < 0.001 ? 600'000 : 100'000);
    }
  };
  const FlightRecord record = flight.record();
  const auto used = [&](double begin_s, double end_s) {
    return processors_used(record, MadeUpFlight::at(begin_s), MadeUpFlight::at(end_s));
  };
  EXPECT_NEAR(used(6.0, 7.0), 0.8 + 0.5 * 0.6 + 0.5 * 0.1, 1e-9);
  EXPECT_NEAR(used(5.5, 6.5), 0.5 * 0.2 + 0.5 * 0.8 + 0.6, 1e-9);
  EXPECT_NEAR(used(6.25, 6.75), 0.8 + 0.5 * 0.6 + 0.5 * 0.1, 1e-9);
  EXPECT_NEAR(used(8.0, 10.0), 0.2 + 0.1, 1e-9);
  EXPECT_EQ(used(-9.0, -8.0), 0.0);
  EXPECT_EQ(used(9.0, 9.0), 0.0);
}

// Waits caused by the flight's own processes are not an excuse. A wait caused by other programs at
// another time is an excuse.
TEST(DelayedFlight, IsNotExcusedIfItsProcessesCausedTheWait) {
  const auto record = [](std::int64_t sim_runs_us, std::int64_t waits_later_us) {
    MadeUpFlight flight = flight_held_up_us(300'000);
    flight.add_messages = [=, of_planner = flight.add_messages, later = Waits(), sim = Waits()](
                              double t_s, FlightRecord& out) mutable {
      of_planner(t_s, out);  // the planner reports 0.1 s of processor time
      const double second = std::round(t_s);
      if (std::abs(t_s - second) > 0.001) {
        return;
      }
      sim.report(out, t_s, 0, "SIM", second == 8.0 ? sim_runs_us : 200'000);
      later.report(out, t_s, second == 12.0 ? waits_later_us : 0, "SENSOR_Q1");  // 0.1 s used
    };
    return flight.record();
  };
  EXPECT_EQ(broken(record(1'299'000, 0)), Names{});
  EXPECT_EQ(broken(record(1'301'000, 0)), Names{"Q1 following"});
  EXPECT_EQ(held_up(record(1'301'000, 0)), std::nullopt);
  EXPECT_EQ(broken(record(1'900'000, 150'000)), Names{});
  EXPECT_TRUE(
      held_up(record(1'900'000, 150'000)).value_or("").starts_with("SENSOR_Q1 waited 0.15"));
}

// Processor time counts from the first followed plan on. The second in which a process was
// restarted is skipped.
TEST(DelayedFlight, NamesAProcessThatUsesTooMuchProcessorTime) {
  for (const std::int64_t sim_runs_us : {600'000, 601'000}) {
    MadeUpFlight flight;
    flight.add_messages = [sim_runs_us, planner = Waits(), sim = Waits()](
                              double t_s, FlightRecord& record) mutable {
      const double second = std::round(t_s);
      if (std::abs(t_s - second) > 0.001) {
        return;
      }
      if (second == 10.0) {
        sim = {6, 0, 0};
      }
      const bool is_after = second > kFollowS;
      planner.report(record, t_s, 300'000, "PLANNER_Q1", is_after ? 400'000 : 1'000'000);
      sim.report(record, t_s, 0, "SIM", second == 11.0 ? 2 * sim_runs_us : sim_runs_us);
    };
    const FlightRecord record = flight.record();
    EXPECT_NEAR(processors_used(record), 0.4 + 1e-6 * static_cast<double>(sim_runs_us), 1e-9);
    EXPECT_TRUE(held_up(record));
    EXPECT_EQ(broken(record), sim_runs_us > 600'000 ? Names{"TEAM processors"} : Names{});
    FlightBounds slowed;
    slowed.is_slowed = true;
    EXPECT_EQ(broken(record, slowed), Names{});
  }
  EXPECT_EQ(processors_used(MadeUpFlight().record()), 0.0) << "the log lacks the processor use";
}

}  // namespace
}  // namespace vantage::test
