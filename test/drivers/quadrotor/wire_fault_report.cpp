#include "test/drivers/quadrotor/wire_fault_report.hpp"

#include <algorithm>
#include <optional>

#include "test/drivers/quadrotor/wire_bench.hpp"
#include "test/drivers/safety/fault_report.hpp"

namespace vantage::test {
namespace {

using models::AutopilotDialect;
using models::FlightState;

constexpr AutopilotDialect kDialects[] = {AutopilotDialect::kPx4, AutopilotDialect::kArdupilot};

/// Difference between the catalogue and the reaction on the wire for one fault.
struct Difference {
  const char* fault;
  const char* why;
  const char* reason = nullptr;
  const char* counter = nullptr;
  std::optional<FlightState> end = std::nullopt;  ///< final state; empty: as in the catalogue
  std::optional<FlightState> end_px4 = std::nullopt;
  bool has_stages = true;
  double delay_s = 0.1;
};

constexpr const char* kFiltered = "the mocap driver's filter refuses the pose";
constexpr const char* kBorder = "refused where messages are received";
constexpr const char* kFailsafe = "the autopilot's own failsafe lands it";

constexpr Difference kDifferences[] = {
    {"two bodies swapped for 0.3 s", kFiltered, "pose stale", nullptr, FlightState::kFollow},
    {"two bodies swapped permanently", kFiltered, "pose stale"},
    {"two bodies with one name", "the mocap driver keeps to the body that goes on", nullptr,
     nullptr, FlightState::kFollow, std::nullopt, false},
    {"outlier of 1 m in one frame", kFiltered, nullptr, "vicon.poses_outlying"},
    {"permanent jump of 1 m", kFiltered, "pose stale"},
    {"flipped in one frame", kFiltered, nullptr, "vicon.poses_flipped"},
    {"flipped permanently", kFiltered, "pose stale"},
    {"not a number", kFiltered, "pose stale"},
    {"millimetres instead of metres", kFiltered, "pose stale"},
    {"frame mirrored in flight", kFiltered, "pose stale"},
    {"rate falls to 8 Hz", "at the ticks of 10 ms no pose is older than 0.10 s", "pose aging",
     nullptr, FlightState::kFollow, std::nullopt, false},
    {"late plan after a newer one", "not older than the last plan by whole microseconds"},
    {"plan with NaN", kBorder, nullptr, "PLAN_Q1.refused"},
    {"plan for another vehicle", "counted as a teammate's", nullptr, "plan.teammate_refused"},
    {"empty plan", "by its start time not older than the last plan", nullptr, "plan.discontinuous"},
    {"old plan replayed", kBorder, nullptr, "PLAN_Q1.duplicates"},
    {"battery critical", "reported at 5 Hz", "battery critical", nullptr, std::nullopt,
     std::nullopt, true, 0.25},
    {"battery empty", "reported at 5 Hz", "battery empty", nullptr, std::nullopt, std::nullopt,
     true, 0.25},
    {"motor lost", "reported at 1 Hz", "motor", nullptr, std::nullopt, std::nullopt, true, 1.1},
    {"pilot takes over", "reported at 1 Hz", "autopilot disobeys", nullptr, std::nullopt,
     std::nullopt, true, 1.1},
    {"link cut for 1.2 s", kFailsafe, "telemetry stale", nullptr, FlightState::kIdle},
    {"telemetry stops", "the reports of the estimator stop as well", "telemetry stale", nullptr,
     FlightState::kIdle},
    {"own process stops for 0.4 s", "the failsafe of PX4 lands it", "driver stalled", "tick.stalls",
     std::nullopt, FlightState::kIdle},
};

const Difference* difference_of(const Fault& fault) {
  const auto* const found =
      std::find_if(std::begin(kDifferences), std::end(kDifferences),
                   [&](const Difference& each) { return std::string(each.fault) == fault.name; });
  return found == std::end(kDifferences) ? nullptr : found;
}

// True if device bytes can express the fault. Two faults need a plan check without teammates, which
// no device can cause. Two need rotations that the matrices of DataStream cannot express; the
// quaternions of VRPN can (vicon_test).
bool is_wire_fault(const Fault& fault) {
  const std::string name = fault.name;
  return !fault.trusts_plans && name != "not a rotation" && name != "quaternion not normalised";
}

Fault on_the_wire(Fault fault, AutopilotDialect dialect) {
  double delay_s = 0.1;
  if (const Difference* const difference = difference_of(fault)) {
    fault.reason = difference->reason;
    fault.counter = difference->counter;
    fault.end = difference->end.value_or(fault.end);
    if (dialect == AutopilotDialect::kPx4) {
      fault.end = difference->end_px4.value_or(fault.end);
    }
    if (!difference->has_stages) {
      fault.stages.clear();
    }
    delay_s = difference->delay_s;
  }
  for (Stage& stage : fault.stages) {
    stage.within_s += delay_s;
  }
  return fault;
}

std::string cell(const Fault& fault, const FaultRun& run) {
  const Outcome& outcome = run.outcomes.front();
  const bool has_sign = fault.reason != nullptr || fault.counter != nullptr;
  return reached(fault, outcome) + " | " +
         (has_sign && !outcome.reacted ? "never" : seen(fault, outcome)) + " | " + end(run) +
         " | " + seconds(run.closest_m);
}

constexpr const char* kHead =
    R"(# Faults on the wire

Three vehicles fly in virtual time at 1 m/s along lanes 1.3 m apart. Between the fault and its effect
are the bytes of a DataStream server, the mocap driver, encoded messages on a bus, three quadrotor
nodes and MAVLink to emulated autopilots: Q1 and Q3 of the dialect in the heading, Q2 of the other. A
fault concerns Q1 unless stated otherwise. It begins 6.4 s after `follow` and is watched for 24 s.

"Reached" is the time from the fault to each state, with the asserted limit. "Seen" is the time until
the reason, or the counter of refused inputs, appears. "Apart" is the least distance between two
vehicles, which touch at 0.5 m. Final states are those of docs/reference/faults.md, where the guard
flies alone. The last column explains a difference from that page.

| # | fault | how | seen by | PX4: reached (limit) [s] | seen [s] | end | apart [m] | ArduPilot: reached (limit) [s] | seen [s] | end | apart [m] | differs |
|---|---|---|---|---|---|---|---|---|---|---|---|---|
)";

}  // namespace

const std::vector<Fault>& wire_faults(AutopilotDialect dialect) {
  static const auto all_of = [](AutopilotDialect of) {
    std::vector<Fault> all;
    for (const Fault& fault : fault_catalogue()) {
      if (is_wire_fault(fault)) {
        all.push_back(on_the_wire(fault, of));
      }
    }
    return all;
  };
  static const std::vector<Fault> kPx4 = all_of(AutopilotDialect::kPx4);
  static const std::vector<Fault> kArdupilot = all_of(AutopilotDialect::kArdupilot);
  return dialect == AutopilotDialect::kPx4 ? kPx4 : kArdupilot;
}

std::string difference_reason(const Fault& fault) {
  const Difference* const difference = difference_of(fault);
  return difference == nullptr ? "" : difference->why;
}

FaultRun fly_wire_fault(const Fault& fault, AutopilotDialect dialect, std::uint64_t seed) {
  WireBench bench(seed, dialect);
  bench.fly_up(kBeginS);
  const Fault* const one[] = {&fault};
  return fly(bench, one, kWireLastsS, nullptr);
}

std::string wire_fault_rows(const std::string& part_of_name) {
  std::string out;
  for (const auto dialect : kDialects) {
    for (const Fault& fault : wire_faults(dialect)) {
      if (std::string(fault.name).find(part_of_name) == std::string::npos) {
        continue;
      }
      WireBench bench(1, dialect);
      bench.fly_up(kBeginS);
      const auto before = bench.counts_of(bench.vehicles().front());
      const Fault* const one[] = {&fault};
      const FaultRun run = fly(bench, one, kWireLastsS, nullptr);
      out += std::string(fault.name) + " | " + cell(fault, run) + "\n";
      for (const std::string& reason : run.outcomes.front().reasons) {
        out += "    " + reason + "\n";
      }
      for (const models::NamedCount& now : bench.counts_of(bench.vehicles().front())) {
        const auto was = std::find_if(before.begin(), before.end(),
                                      [&](const auto& each) { return each.name == now.name; });
        if (was == before.end() || was->count != now.count) {
          out += "    `" + now.name + "` " + std::to_string(now.count) + "\n";
        }
      }
    }
  }
  return out;
}

std::string wire_fault_report() {
  std::string out = kHead;
  const std::vector<Fault>& px4 = wire_faults(AutopilotDialect::kPx4);
  const std::vector<Fault>& ardupilot = wire_faults(AutopilotDialect::kArdupilot);
  for (std::size_t i = 0; i < px4.size(); ++i) {
    out += "| " + std::to_string(px4[i].number) + " | " + px4[i].name + " | " + px4[i].what +
           " | " + sign(px4[i]) + " | " +
           cell(px4[i], fly_wire_fault(px4[i], AutopilotDialect::kPx4, 1)) + " | " +
           cell(ardupilot[i], fly_wire_fault(ardupilot[i], AutopilotDialect::kArdupilot, 1)) +
           " | " + difference_reason(px4[i]) + " |\n";
  }
  return out;
}

}  // namespace vantage::test
