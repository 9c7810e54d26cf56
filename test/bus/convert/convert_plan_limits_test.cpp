#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "bus/convert/convert.hpp"
#include "test/bus/convert/changed_message.hpp"

// Limits of the fields of plan, command, status and report messages: the last valid value is
// accepted and the first invalid one is rejected.

namespace vantage::bus {
namespace {

using test::Changed;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

models::Trajectory drive() {
  models::Trajectory trajectory;
  trajectory.segments = {{{0.5, 0.25}, 1.0, 0.0}, {{0.5, 0.0}, 0.5, 1.0}};
  return trajectory;
}

/// Checks the limits of a trajectory within any message; `of(message)` returns the field that
/// contains the trajectory.
template <class Message, class Of>
void expect_limits_of_a_trajectory(const Changed<Message>& message, const Of& of) {
  const auto at = [&of](const auto& field) {
    return [&of, field ](auto& w) -> auto& { return field(of(w)); };
  };
  message.between("x", -1e6, 1e6, at(VANTAGE_FIELD(start_x_world_m)));
  message.between("y", -1e6, 1e6, at(VANTAGE_FIELD(start_y_world_m)));
  message.finite("yaw", at(VANTAGE_FIELD(start_yaw_world_rad)));
  message.between("height", -1e6, 1e6, at(VANTAGE_FIELD(height_m)));
  message.count("segments", at(VANTAGE_FIELD(num_segments)));
  message.between("speed", -1e3, 1e3, at(VANTAGE_FIELD(segments[1].speed_mps)));
  message.between("yaw rate", -1e3, 1e3, at(VANTAGE_FIELD(segments[1].yaw_rate_radps)));
  message.between("brake", 0.0, 1e3, at(VANTAGE_FIELD(segments[1].brake_mps2)));
  message.between("duration, with one second before it", 0.0, 3599.0,
                  at(VANTAGE_FIELD(segments[1].duration_s)));
  message.between("the same of the first, with a half behind it", 0.0, 3599.5,
                  at(VANTAGE_FIELD(segments[0].duration_s)));
}

models::RobotPlan plan() {
  models::RobotPlan out;
  out.trajectory = drive();
  out.inputs = {{"A", 1, 2}};
  return out;
}

/// Checks the limits of a plan, alone or within a proposal; `of(message)` returns the plan.
template <class Message, class Of>
void expect_limits_of_a_plan(const Changed<Message>& message, const Of& of) {
  const auto at = [&of](const auto& field) {
    return [&of, field ](auto& w) -> auto& { return field(of(w)); };
  };
  expect_limits_of_a_trajectory(message, of);
  message.text("robot", at(VANTAGE_FIELD(robot)));
  message.whole("source", 0, at(VANTAGE_FIELD(source)), 2);
  message.whole("horizon", 0, at(VANTAGE_FIELD(horizon_steps)));
  message.whole("round", -1, at(VANTAGE_FIELD(round)));
  message.whole("passes", 0, at(VANTAGE_FIELD(passes)));
  message.whole("nodes", 0, at(VANTAGE_FIELD(nodes)));
  message.utime("slot", at(VANTAGE_FIELD(slot_start_utime)));
  message.utime("deadline", at(VANTAGE_FIELD(deadline_utime)));
  message.utime("finish", at(VANTAGE_FIELD(finish_utime)));
  message.boolean("late", at(VANTAGE_FIELD(late)));
  message.count("inputs", at(VANTAGE_FIELD(num_inputs)));
  struct Row {
    const char* what;
    std::vector<double> taken;
    std::vector<double> refused;
    std::function<double&(vantage_lcm::plan_t&)> field;
  };
  const std::vector<Row> rows{
      {"cost", {-1.0, 0.0, 5.0, kNan}, {kInfinity, -kInfinity}, VANTAGE_FIELD(cost_nat)},
      {"bound", {-kInfinity, -1.0, 0.0, 5.0}, {kNan, kInfinity}, VANTAGE_FIELD(lower_bound_nat)},
      {"epsilon", {0.0, 3.0, kInfinity}, {-1e-9, kNan, -kInfinity}, VANTAGE_FIELD(epsilon)},
      {"delta", {0.0, 3.0, kInfinity}, {-1e-9, kNan, -kInfinity}, VANTAGE_FIELD(delta_m)},
      {"step", {1e-3, 100.0}, {0.0, -0.5, kNan, kInfinity}, VANTAGE_FIELD(step_s)}};
  for (const Row& row : rows) {
    for (const double good : row.taken) {
      message.taken(row.what, [&](auto& w) { row.field(of(w)) = good; });
    }
    for (const double bad : row.refused) {
      message.refused(row.what, [&](auto& w) { row.field(of(w)) = bad; });
    }
  }
}

TEST(Limits, AreEnforcedForPlans) {
  const auto itself = [](auto& w) -> auto& { return w; };
  expect_limits_of_a_plan(Changed<models::RobotPlan>(plan()), itself);
}

TEST(Limits, AreEnforcedForProposals) {
  const Changed<models::PlanProposal> message({{}, 1.0, plan()});
  message.amount("value", VANTAGE_FIELD(value_nat));
  message.utime("time of the plan", VANTAGE_FIELD(plan.utime));
  expect_limits_of_a_plan(message, VANTAGE_FIELD(plan));
}

TEST(Limits, AreEnforcedForTeamProposals) {
  models::TeamProposal proposal;
  proposal.choices = {{"Q1", drive(), 1.0, 2.0}, {"Q2", drive(), 3.0, 4.0}};
  proposal.history = {-5, 6};
  proposal.inputs = {{"A", 1, 2}};
  const Changed<models::TeamProposal> message(proposal);
  message.text("robot", VANTAGE_FIELD(robot));
  message.finite("value", VANTAGE_FIELD(value_nat));
  message.whole("nodes", 0, VANTAGE_FIELD(nodes));
  message.count("choices", VANTAGE_FIELD(num_choices));
  message.count("history", VANTAGE_FIELD(num_history));
  message.count("inputs", VANTAGE_FIELD(num_inputs));
  message.text("robot of a choice", VANTAGE_FIELD(choices[1].robot));
  message.amount("information", VANTAGE_FIELD(choices[1].information_nat));
  message.amount("energy", VANTAGE_FIELD(choices[1].energy_nat));
  message.refused("a robot twice", [](auto& w) { w.choices[1].robot = "Q1"; });
  expect_limits_of_a_trajectory(message, VANTAGE_FIELD(choices[1]));
}

TEST(Limits, AreEnforcedForVehicleStatuses) {
  models::VehicleStatus status;
  status.reasons = {"first", "last"};
  const Changed<models::VehicleStatus> message(status);
  message.text("robot", VANTAGE_FIELD(robot));
  message.whole("state", 0, VANTAGE_FIELD(state), 4);
  message.between("battery", 0.0, 1.0, VANTAGE_FIELD(battery_share));
  message.finite("x", VANTAGE_FIELD(setpoint_x_world_m));
  message.finite("y", VANTAGE_FIELD(setpoint_y_world_m));
  message.finite("yaw", VANTAGE_FIELD(setpoint_yaw_world_rad));
  message.finite("height", VANTAGE_FIELD(setpoint_height_m));
  message.whole("round", -1, VANTAGE_FIELD(plan_round));
  message.count("reasons", VANTAGE_FIELD(num_reasons));
  message.text("reason", VANTAGE_FIELD(reasons[1]));
}

TEST(Limits, AreEnforcedForCommandsAndNotices) {
  const Changed<models::OperatorCommand> command(models::OperatorCommand{});
  command.text("robot", VANTAGE_FIELD(robot));
  command.whole("action", 0, VANTAGE_FIELD(action), 6);
  const Changed<models::CollisionReport> contact(models::CollisionReport{});
  contact.whole("kind", 0, VANTAGE_FIELD(kind), 1);
  contact.text("first", VANTAGE_FIELD(body_a));
  contact.text("second", VANTAGE_FIELD(body_b));
  contact.finite("distance", VANTAGE_FIELD(distance_m));
  models::AttackNotice notice;
  notice.jammed = {"Q1", "Q2"};
  const Changed<models::AttackNotice> attack(notice);
  attack.count("jammed", VANTAGE_FIELD(num_jammed));
  attack.text("name", VANTAGE_FIELD(jammed[1]));
  const Changed<models::ScenarioNotice> scenario(models::ScenarioNotice{});
  scenario.text("version", VANTAGE_FIELD(version));
  scenario.text("process", VANTAGE_FIELD(process));
  scenario.refused("not UTF-8", [](auto& w) { w.yaml = "\xFF"; });
}

TEST(Limits, AreEnforcedForHealth) {
  models::ProcessHealth health;
  health.counters = {{"first", 1}, {"last", -2}};
  const Changed<models::ProcessHealth> message(health);
  message.text("process", VANTAGE_FIELD(process));
  message.whole("state", 0, VANTAGE_FIELD(state), 3);
  message.count("counters", VANTAGE_FIELD(num_counters));
  message.text("counter", VANTAGE_FIELD(counters[1].name));
  message.whole("loops", 0, VANTAGE_FIELD(loops));
  message.amount("worst", VANTAGE_FIELD(loop_worst_s));
  message.whole("missed", 0, VANTAGE_FIELD(deadlines_missed));
}

TEST(Limits, AreEnforcedForHostReports) {
  models::HostReport report;
  report.processes.resize(2);
  const Changed<models::HostReport> message(report);
  message.text("host", VANTAGE_FIELD(host));
  message.count("processes", VANTAGE_FIELD(num_processes));
  message.text("name", VANTAGE_FIELD(processes[1].name));
  message.text("last end", VANTAGE_FIELD(processes[1].last_end));
  message.whole("phase", 0, VANTAGE_FIELD(processes[1].phase), 3);
  message.whole("restarts", 0, VANTAGE_FIELD(processes[1].restarts));
  message.amount("down", VANTAGE_FIELD(processes[1].down_s));
  message.amount("processor", VANTAGE_FIELD(processes[1].cpu_share));
  message.whole("memory", 0, VANTAGE_FIELD(processes[1].memory_bytes));
}

}  // namespace
}  // namespace vantage::bus
