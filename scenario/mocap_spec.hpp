#pragma once

#include <string>

#include "scenario/device_source.hpp"
#include "scenario/mocap_protocol.hpp"

namespace vantage::scenario {

/// Transmission mode of a DataStream.
enum class StreamMode {
  kPush,      ///< server sends each frame immediately: lowest latency
  kPull,      ///< client requests each frame: frames cannot queue up
  kPreFetch,  ///< client requests the next frame while it processes the current one
};

/// Up axis of the server's world frame. kAsTold: as reported by the server; if the server reports
/// none, the default of its protocol (MocapProtocol::is_y_up).
enum class UpAxis { kAsTold, kZ, kY };

/// Mocap system that localises all bodies. The noise values apply to a simulated system. The
/// connection is used by the device kinds `wire` and `real`.
struct MocapSpec {
  double rate_hz = 50.0;
  double position_sigma_m = 0.0005;
  double yaw_sigma_rad = 0.001;
  double latency_s = 0.005;  ///< simulated latency; also assumed if a server reports none
  DeviceSource device = DeviceSource::kDirect;

  MocapProtocol protocol = MocapProtocol::kDataStream;
  std::string host =
      "127.0.0.1";  ///< host of the server; with an object stream, the default accepts any sender
  int port = 0;     ///< 0: default port of the protocol
  StreamMode mode = StreamMode::kPush;
  UpAxis up_axis = UpAxis::kAsTold;
  int block_bytes = 256;          ///< datagram size of a simulated object stream: 256, 512 or 1024
  int stuck_frames = 3;           ///< number of repeated poses that mark a body as occluded; 0: off
  double gate_speed_mps = 10.0;   ///< a pose that implies a higher speed is rejected; 0: off
  double gate_turn_radps = 20.0;  ///< a pose that implies a higher turn rate is rejected; 0: off

  [[nodiscard]] int actual_port() const { return port > 0 ? port : protocol.default_port(); }
  /// True if y is up in the world of a server that reports no axis.
  [[nodiscard]] bool is_y_up() const {
    return up_axis == UpAxis::kAsTold ? protocol.is_y_up() : up_axis == UpAxis::kY;
  }
};

}  // namespace vantage::scenario
