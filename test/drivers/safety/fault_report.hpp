#pragma once

#include <string>
#include <vector>

#include "test/drivers/safety/fault_catalogue.hpp"

namespace vantage::test {

/// Formats the reaction to a single fault: "hold 0.11 (0.13), land 0.51 (0.53)". Each state has the
/// time until it was reached and, in parentheses, its limit, s.
std::string reached(const Fault& fault, const Outcome& outcome);
/// Formats the time until the reason or count appeared, "0.11", s; empty for a fault without
/// either.
std::string seen(const Fault& fault, const Outcome& outcome);
/// Returns the name of the reason or counter by which the fault is recognised.
std::string sign(const Fault& fault);
/// Formats the final state and all violations.
std::string end(const FaultRun& run);
std::string seconds(double value_s);
/// Joins the words; each is followed by "; ".
std::string list(const std::vector<std::string>& words);

/// Returns the page docs/reference/faults.md. It lists every fault of the catalogue, flown with
/// seed 1, with its reaction and final state. It also contains the table of conditions with limits
/// and rules for clearing.
std::string fault_report();

}  // namespace vantage::test
