#include "test/drivers/safety/fault_report.hpp"

#include <cstdio>

#include "drivers/safety/conditions.hpp"

namespace vantage::test {
namespace {

constexpr const char* kHead =
    R"(# Faults and conditions of flight safety

Written by `build/dev/bin/fault_report > docs/reference/faults.md`; a test compares this page with the
program's output.

## Faults

Three vehicles fly in virtual time at 1 m/s along lanes 1.3 m apart, with mocap and safety at 100 Hz
and one plan per second. The fault begins 6.4 s after all vehicles have lifted and is watched for 16 s.
"Reached" is the time from the fault to each state, with the asserted limit. "Seen" is the time until
the reason, or the counter of refused inputs, appears. The emulated autopilot is simpler than a real
one.

Final states: *follow* and *hold* fly; *idle* is landed and disarmed; *killed* has its motors off until
it is armed again; *land* cannot be commanded any more, and the autopilot lands by itself. No vehicle
touched anything or left the fence.

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
      "\n## Conditions\n\nMost severe first. The most severe active condition determines the "
      "state. `drivers/safety/limits.hpp`\ncontains the numbers.\n\n"
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
