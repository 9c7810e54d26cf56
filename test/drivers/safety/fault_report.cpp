#include "test/drivers/safety/fault_report.hpp"

#include <cstdio>

#include "drivers/safety/conditions.hpp"

namespace vantage::test {
namespace {

constexpr const char* kHead =
    R"(# What flight safety did about each fault

Written by `build/dev/bin/fault_report > docs/results/faults.md`; a test compares this page with what the
program writes. Three vehicles in closed loop in virtual time (100 Hz mocap and safety, plans each second), flying
1 m/s along lanes 1.3 m apart; the fault strikes 6.4 s after all have lifted and 16 s are watched. "Reached" is the
time from the fault to each state, with the limit that is asserted; "seen" is the time to the reason, or to the count
of what was refused and flown through. What the stand-in autopilot does is simpler than a real one.

The ends: *follow* and *hold* fly; *idle* is landed and disarmed; *killed* is motors off, latched; *land* could
not be told to the vehicle (its own watchdog lands it). No run touched anything or left the fence.

| # | fault | how | reached (limit) [s] | seen [s] | reason or count | end |
|---|---|---|---|---|---|---|
)";

std::string row(const Fault& fault) {
  const Fault* const one[] = {&fault};
  const FaultRun run = fly_with(one, 1);
  const Outcome& outcome = run.outcomes.front();
  return "| " + std::to_string(fault.number) + " | " + fault.name + " | " + fault.what + " | " +
         reached(fault, outcome) + " | " + seen(fault, outcome) + " | " + sign(fault) + " | " +
         end(run) + " |\n";
}

}  // namespace

std::string seconds(double value_s) {
  char text[16];
  std::snprintf(text, sizeof text, "%.2f", value_s);
  return text;
}

std::string list(const std::vector<std::string>& words) {
  std::string out;
  for (const std::string& word : words) {
    out += word + "; ";
  }
  return out;
}

std::string reached(const Fault& fault, const Outcome& outcome) {
  std::string out;
  for (std::size_t i = 0; i < fault.stages.size(); ++i) {
    const double at_s = outcome.stage_s[i];
    out += (i == 0 ? "" : ", ") + std::string(name_of(fault.stages[i].state)) + " " +
           (at_s < 0.0 ? "never" : seconds(at_s)) + " (" + seconds(fault.stages[i].within_s) + ")";
  }
  return out;
}

std::string seen(const Fault& fault, const Outcome& outcome) {
  const bool has_sign = fault.reason != nullptr || fault.counter != nullptr;
  return has_sign ? seconds(outcome.reaction_s) : "";
}

std::string sign(const Fault& fault) {
  return fault.reason != nullptr    ? fault.reason
         : fault.counter != nullptr ? std::string("`") + fault.counter + "`"
                                    : "";
}

std::string end(const FaultRun& run) {
  std::string out = name_of(run.outcomes.front().end);
  for (const std::string& violation : run.violations) {
    out += " **" + violation + "**";
  }
  return out;
}

std::string fault_report() {
  std::string out = kHead;
  for (const Fault& fault : fault_catalogue()) {
    out += row(fault);
  }
  out +=
      "\n## The table\n\nMost severe first; the most severe that acts wins. The numbers are in "
      "`drivers/safety/limits.hpp`.\n\n"
      "| condition | in the air | on the ground | limit | after [s] | ends |\n"
      "|---|---|---|---|---|---|\n";
  for (const drivers::Condition& each : drivers::conditions()) {
    out += "| " + std::string(each.name) + " | " + drivers::name_of(each.severity) + " | " +
           (each.blocks_arming     ? "blocks arming"
            : each.blocks_take_off ? "blocks take-off"
                                   : "") +
           " | " + each.limit + " | " + seconds(each.after_s) + " | " + each.clears + " |\n";
  }
  return out;
}

}  // namespace vantage::test
