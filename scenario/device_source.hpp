#pragma once

namespace vantage::scenario {

/// Kind of a device. kDirect: simulated; the simulator publishes the channel of the device. kWire:
/// simulated; the real driver connects to the simulated device by the device's real protocol.
/// kReal: real device.
enum class DeviceSource { kDirect, kWire, kReal };

/// Publisher of the messages of a robot's sensor, estimator or planner: a process of vantage, or a
/// process of the user that replaces it.
enum class Publisher { kVantage, kExternal };

}  // namespace vantage::scenario
