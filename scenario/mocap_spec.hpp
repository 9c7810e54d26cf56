#pragma once

#include <string>

#include "scenario/device_source.hpp"

namespace vantage::scenario {

/// How a mocap server talks to this stack.
enum class MocapProtocol {
  kDataStream,    ///< Vicon DataStream, TCP: Tracker, Nexus, Blade, Shogun, Evoke
  kObjectStream,  ///< Vicon Tracker's UDP object stream
  kVrpn,          ///< VRPN over TCP
};

/// As scenario files and flags write it: "datastream", "object_stream", "vrpn".
const char* name_of(MocapProtocol protocol);
/// The port that the protocol has when nobody says otherwise: 801, 51001, 3883.
int default_port(MocapProtocol protocol);

/// Who decides when a frame of a DataStream is sent.
enum class StreamMode {
  kPush,      ///< the server, as soon as it has one: least latency
  kPull,      ///< the client asks for each: never falls behind
  kPreFetch,  ///< the client asks for the next one while it works on this
};

/// Which way the server's world is up. kAsTold: as it says itself, z when it does not.
enum class UpAxis { kAsTold, kZ, kY };

/// The mocap system that localises everything. The noise is that of a simulated one; how to
/// connect is for one that is `wire` or `real`.
struct MocapSpec {
  double rate_hz = 50.0;
  double position_sigma_m = 0.0005;
  double yaw_sigma_rad = 0.001;
  double latency_s = 0.005;  ///< simulated, and assumed of a server that does not tell its own
  DeviceSource device = DeviceSource::kDirect;

  MocapProtocol protocol = MocapProtocol::kDataStream;
  std::string host = "127.0.0.1";  ///< of the server; by default an object stream is anyone's
  int port = 0;                    ///< 0: the protocol's own
  StreamMode mode = StreamMode::kPush;
  UpAxis up_axis = UpAxis::kAsTold;
  int block_bytes = 256;  ///< of a simulated object stream's datagram: 256, 512 or 1024
  int stuck_frames = 3;   ///< repetitions of a pose, bit by bit, that make it "not seen"; 0: off
  double gate_speed_mps = 10.0;   ///< a body that would be faster is not there; 0: no gate
  double gate_turn_radps = 20.0;  ///< nor is one that would turn faster

  [[nodiscard]] int actual_port() const { return port > 0 ? port : default_port(protocol); }
};

}  // namespace vantage::scenario
