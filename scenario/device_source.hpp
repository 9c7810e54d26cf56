#pragma once

namespace vantage::scenario {

/// Kind of a device. kDirect: simulated; the simulator publishes the channel of the device. kWire:
/// simulated; the real driver receives the simulated device by its real protocol. kReal: real
/// device.
enum class DeviceSource { kDirect, kWire, kReal };

}  // namespace vantage::scenario
