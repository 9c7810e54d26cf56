#pragma once

namespace vantage::scenario {

/// Where a device comes from. kDirect: the simulator publishes the device's channel itself;
/// kWire: simulated device behind its real protocol and driver; kReal: the real one.
enum class DeviceSource { kDirect, kWire, kReal };

}  // namespace vantage::scenario
