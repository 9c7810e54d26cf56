#pragma once

#include <string>
#include <vector>

#include "models/exchange/messages.hpp"
#include "test/drivers/safety/fault_catalogue.hpp"

namespace vantage::test {

/// The faults of the catalogue that device bytes can carry, with the reason, the counter, the end
/// and the limits that hold on the wire for an autopilot of `dialect`.
///
/// Limits are 0.1 s longer than the catalogue's: a report of the autopilot is up to so much older
/// than a tick. Where a message comes at 1 Hz they are 1.1 s longer.
const std::vector<Fault>& wire_faults(models::AutopilotDialect dialect);

/// Where a row of wire_faults() differs from the catalogue; empty where it does not.
std::string why_different(const Fault& fault);

/// For so long each fault is watched [s].
inline constexpr double kWireLastsS = 24.0;
/// Flies up on a WireBench, begins the fault at kBeginS and goes on for kWireLastsS.
FaultRun fly_on_the_wire(const Fault& fault, models::AutopilotDialect dialect, std::uint64_t seed);

/// The rows of faults whose name contains `part_of_name`, with the reasons that were given and Q1's
/// counters that grew.
std::string wire_fault_rows(const std::string& part_of_name);

/// The page docs/results/faults47.md, up to the tests that hold each fault: every such fault flown
/// with seed 1, by both dialects.
std::string wire_fault_report();

}  // namespace vantage::test
