#pragma once

#include <string>
#include <vector>

#include "test/drivers/safety/fault_catalogue.hpp"

namespace vantage::test {

/// The reaction to a fault that was flown alone: "hold 0.11 (0.13), land 0.51 (0.53)", each state
/// with the time until it was reached and the limit [s].
std::string reached(const Fault& fault, const Outcome& outcome);
/// "0.11": the time until the reason or the count was seen [s]; empty where the fault has neither.
std::string seen(const Fault& fault, const Outcome& outcome);
/// The reason, or the counter, by which the fault is seen.
std::string sign(const Fault& fault);
/// The state at the end, and every violation.
std::string end(const FaultRun& run);
std::string seconds(double value_s);
/// The words, a "; " behind each.
std::string list(const std::vector<std::string>& words);

/// The page docs/results/faults.md: every fault of the catalogue flown with seed 1, its reaction,
/// its end; and the table of conditions with limits and rules for clearing.
std::string fault_report();

}  // namespace vantage::test
