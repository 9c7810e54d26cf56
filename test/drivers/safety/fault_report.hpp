#pragma once

#include <string>
#include <vector>

#include "test/drivers/safety/fault_catalogue.hpp"

namespace vantage::test {

/// Formats the reaction to a fault that was flown alone: "hold 0.11 (0.13), land 0.51 (0.53)", each
/// state with the time until it was reached and its limit, s.
std::string reached(const Fault& fault, const Outcome& outcome);
/// Formats the time until the reason or count was seen, "0.11", s; empty for a fault without
/// either.
std::string seen(const Fault& fault, const Outcome& outcome);
/// Returns the reason or the counter that shows the fault.
std::string sign(const Fault& fault);
/// Formats the final state and every violation.
std::string end(const FaultRun& run);
std::string seconds(double value_s);
/// Joins the words; each is followed by "; ".
std::string list(const std::vector<std::string>& words);

/// Returns the page docs/results/faults.md: every fault of the catalogue flown with seed 1, with
/// its reaction and final state, and the table of conditions with limits and rules for clearing.
std::string fault_report();

}  // namespace vantage::test
