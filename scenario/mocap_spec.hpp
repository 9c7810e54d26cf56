#pragma once

#include <string>

#include "scenario/device_source.hpp"

namespace vantage::scenario {

/// Protocol of a mocap server.
enum class MocapProtocol {
  kDataStream,    ///< Vicon DataStream, TCP: Tracker, Nexus, Blade, Shogun, Evoke
  kObjectStream,  ///< Vicon Tracker's UDP object stream
  kVrpn,          ///< VRPN over TCP
};

/// Returns the name in scenario files and flags: "datastream", "object_stream" or "vrpn".
const char* name_of(MocapProtocol protocol);
/// Returns the default port of the protocol: 801, 51001 or 3883.
int default_port(MocapProtocol protocol);

/// Transmission mode of a DataStream.
enum class StreamMode {
  kPush,      ///< server sends each frame at once: lowest latency
  kPull,      ///< client requests each frame: it never falls behind
  kPreFetch,  ///< client requests the next frame while it processes one
};

/// Up axis of the server's world. kAsTold: as reported by the server, z if it reports none.
enum class UpAxis { kAsTold, kZ, kY };

/// Mocap system that localises all bodies. Noise applies to a simulated system, the connection to
/// `wire` and `real`.
struct MocapSpec {
  double rate_hz = 50.0;
  double position_sigma_m = 0.0005;
  double yaw_sigma_rad = 0.001;
  double latency_s = 0.005;  ///< simulated; also assumed of a server that states no latency
  DeviceSource device = DeviceSource::kDirect;

  MocapProtocol protocol = MocapProtocol::kDataStream;
  std::string host = "127.0.0.1";  ///< server; with the default, any host may send an object stream
  int port = 0;                    ///< 0: default port of the protocol
  StreamMode mode = StreamMode::kPush;
  UpAxis up_axis = UpAxis::kAsTold;
  int block_bytes = 256;  ///< datagram size of a simulated object stream: 256, 512, 1024
  int stuck_frames = 3;   ///< identical repetitions of a pose that mark it as not seen; 0: off
  double gate_speed_mps = 10.0;   ///< poses that imply a higher speed are rejected; 0: no gate
  double gate_turn_radps = 20.0;  ///< poses that imply a higher rate are rejected; 0: no gate

  [[nodiscard]] int actual_port() const { return port > 0 ? port : default_port(protocol); }
};

}  // namespace vantage::scenario
