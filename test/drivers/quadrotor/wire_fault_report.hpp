#pragma once

#include <string>
#include <vector>

#include "models/exchange/messages.hpp"
#include "test/drivers/safety/fault_catalogue.hpp"

namespace vantage::test {

/// Returns the faults of the catalogue that device bytes can carry, with the reason, counter, final
/// state and limits that apply on the wire for an autopilot of `dialect`.
///
/// Limits are 0.1 s longer than in the catalogue, since a report of the autopilot is up to 0.1 s
/// older than a tick. For messages at 1 Hz they are 1.1 s longer.
const std::vector<Fault>& wire_faults(models::AutopilotDialect dialect);

/// Returns a text that explains how a row of wire_faults() differs from the catalogue; empty if it
/// does not.
std::string difference_reason(const Fault& fault);

/// Observation time of each fault, s.
inline constexpr double kWireLastsS = 24.0;
/// Flies up on a WireBench, starts the fault at kBeginS and continues for kWireLastsS.
FaultRun fly_wire_fault(const Fault& fault, models::AutopilotDialect dialect, std::uint64_t seed);

/// Returns the rows of the faults with a name that contains `part_of_name`, with the reported
/// reasons and the counters of Q1 that increased.
std::string wire_fault_rows(const std::string& part_of_name);

/// Returns a table of every fault of wire_faults(), flown with seed 1 and both dialects.
/// docs/results/faults47.md summarises it.
std::string wire_fault_report();

}  // namespace vantage::test
