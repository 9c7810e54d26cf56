#pragma once

#include "wire/vicon/bytes.hpp"

namespace vantage::wire::vicon {

/// Type of the server at a port.
enum class ServerType {
  kUnknown,       ///< no known protocol
  kTooFewBytes,   ///< valid start, but too few bytes to decide
  kDataStream,    ///< Vicon DataStream (Tracker, Nexus, Blade, Shogun, Evoke)
  kVrpn,          ///< a VRPN server, from Vicon or another vendor
  kObjectStream,  ///< Vicon Tracker's UDP object stream
  kNatNet,        ///< OptiTrack's NatNet
  kQualisys,      ///< Qualisys Track Manager's real-time server
  kText,          ///< a text protocol: SSH, HTTP, SMTP, …
};

/// Identifies the server type from the first bytes that it sends over TCP.
ServerType identify_stream(Bytes first_bytes);
/// Identifies the server type from one datagram.
ServerType identify_datagram(Bytes datagram);

/// Returns a name for use in sentences: "a Vicon DataStream server", …
const char* name_of(ServerType server_type);

}  // namespace vantage::wire::vicon
