#pragma once

namespace vantage::scenario {

/// Kind of a device. kDirect: the simulator publishes the device's channel itself. kWire: simulated
/// device behind its real protocol and driver. kReal: real device.
enum class DeviceSource { kDirect, kWire, kReal };

}  // namespace vantage::scenario
