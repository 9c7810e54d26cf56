#pragma once

#include <string>

namespace vantage::test {

/// The page docs/results/faults.md: every fault of the catalogue flown with seed 1, its reaction,
/// its end; and the table of conditions with limits and rules for clearing.
std::string fault_report();

}  // namespace vantage::test
