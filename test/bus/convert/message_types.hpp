#pragma once

#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "bus/convert/convert.hpp"
#include "test/bus/convert/sample_compact.hpp"

namespace vantage::test {

/// All message types of the bus.
using MessageTypes =
    ::testing::Types<models::MocapFrame, models::RobotMeasurement, models::OdometryReport,
                     models::SightingReport, models::PoseEstimate, models::RobotBelief,
                     models::CompactBelief, models::BeliefMixture, models::RangeScan,
                     models::RobotMap, models::RobotPlan, models::PlanProposal,
                     models::TeamProposal, models::VehicleStatus, models::OperatorCommand,
                     models::TruthFrame, models::CollisionReport, models::AttackNotice,
                     models::ProcessHealth, models::HostReport, models::ScenarioNotice>;

/// Returns the bytes published for `message`.
template <class Message>
std::vector<std::uint8_t> encoded(const Message& message) {
  const auto wire = bus::to_wire(message);
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(wire.getEncodedSize()));
  wire.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

}  // namespace vantage::test
