#pragma once

#include <span>

namespace vantage::scenario {

/// Connection of a driver to a mocap server.
enum class MocapTransport {
  kTcp,
  kUdpReceived,   ///< the server sends datagrams to this host without a request
  kUdpRequested,  ///< the server sends datagrams to hosts that request them
};

/// Properties of a mocap protocol: a row of the table in mocap_protocol.cpp.
struct MocapProtocolRow {
  const char* name;  ///< value of mocap.protocol in scenario files
  int default_port;  ///< TCP or UDP, as `transport` states
  MocapTransport transport;
  bool is_y_up;        ///< true: y is assumed to be up if the server reports no up axis
  const char* driver;  ///< driver name; process vantage-<driver>, counters <driver>.…
};

/// Protocol of a mocap server, stored as a pointer to its table row.
class MocapProtocol {
 public:
  constexpr explicit MocapProtocol(const MocapProtocolRow& row) : row_(&row) {}
  [[nodiscard]] constexpr const char* name() const { return row_->name; }
  [[nodiscard]] constexpr int default_port() const { return row_->default_port; }
  [[nodiscard]] constexpr MocapTransport transport() const { return row_->transport; }
  /// True if the server sends datagrams to this host without a request.
  [[nodiscard]] constexpr bool is_datagram() const {
    return transport() == MocapTransport::kUdpReceived;
  }
  [[nodiscard]] constexpr bool is_y_up() const { return row_->is_y_up; }
  [[nodiscard]] constexpr const char* driver() const { return row_->driver; }

  friend constexpr bool operator==(MocapProtocol a, MocapProtocol b) { return a.row_ == b.row_; }
  /// Compares positions in the table of protocols.
  friend constexpr bool operator<(MocapProtocol a, MocapProtocol b) { return a.row_ < b.row_; }

  static const MocapProtocol kDataStream;    ///< Vicon, TCP: Tracker, Nexus, Blade, Shogun, Evoke
  static const MocapProtocol kObjectStream;  ///< Vicon Tracker's UDP object stream
  static const MocapProtocol kVrpn;          ///< VRPN over TCP
  static const MocapProtocol kNatNet;        ///< OptiTrack Motive
  static const MocapProtocol kQtm;           ///< Qualisys Track Manager's real-time protocol

 private:
  const MocapProtocolRow* row_;
};

/// Returns all protocols that scenarios may name, in display order.
std::span<const MocapProtocol> all_mocap_protocols();

}  // namespace vantage::scenario
