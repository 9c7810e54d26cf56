#pragma once

#include "wire/vicon/bytes.hpp"

namespace vantage::wire::vicon {

/// Who is at the other end of a port.
enum class Speaker {
  kUnknown,       ///< bytes that fit nothing known
  kTooFewBytes,   ///< all that came fits, but it is not enough to tell
  kDataStream,    ///< Vicon DataStream (Tracker, Nexus, Blade, Shogun, Evoke)
  kVrpn,          ///< a VRPN server, of Vicon or anybody
  kObjectStream,  ///< Vicon Tracker's UDP object stream
  kQualisys,      ///< Qualisys Track Manager's real-time server
  kText,          ///< something that greets in words: SSH, HTTP, SMTP, …
};

/// Who speaks, by the first bytes that a server sends over TCP.
Speaker identify_stream(Bytes first_bytes);
/// Who speaks, by one datagram.
Speaker identify_datagram(Bytes datagram);

/// "a Vicon DataStream server", … for sentences.
const char* name_of(Speaker speaker);

}  // namespace vantage::wire::vicon
