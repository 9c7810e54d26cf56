#pragma once

#include <optional>
#include <string>
#include <vector>

#include "drivers/natnet/tick_clock.hpp"
#include "drivers/vicon/session.hpp"
#include "drivers/vicon/session_table.hpp"
#include "wire/natnet/definitions.hpp"
#include "wire/natnet/frame.hpp"

namespace vantage::drivers::natnet {

/// Client of OptiTrack's NatNet, versions 3.0 and later, unicast or multicast.
///
/// The client requests a connection until the server answers with its version, and then the
/// definitions, which contain the names of the bodies. A unicast server sends frames to the source
/// of the request; a multicast server sends them to a group. Echo requests give the server's clock,
/// so that the age of each frame is measured.
///
/// Definitions are requested again when a frame marks them as changed or contains an unknown body.
/// A marked frame waits for them, because its ids may belong to other names. A connection is
/// requested again when no frames arrive.
class NatNetSession : public vicon::Session {
 public:
  NatNetSession(bool is_y_up, vicon::FrameSink sink);

  void open(vicon::Moment now) override;
  /// Processes one datagram. Returns false if the server's version is not supported.
  [[nodiscard]] bool receive(vicon::Moment arrival, wire::vicon::Bytes datagram) override;
  void on_time(vicon::Moment now) override;
  [[nodiscard]] Duration next_wake() const override;
  [[nodiscard]] std::optional<vicon::MulticastGroup> group() const override;

  /// Returns the server's answer to the connection request; nullopt before it arrives.
  [[nodiscard]] const std::optional<wire::natnet::ServerInfo>& server() const { return server_; }

 private:
  /// Periodic request to the server.
  struct Request {
    Duration period{};
    Duration due{};
  };

  [[nodiscard]] bool on_server_info(wire::vicon::Bytes payload);
  void on_definitions(wire::vicon::Bytes payload);
  void on_echo(vicon::Moment arrival, wire::vicon::Bytes payload);
  void on_frame(vicon::Moment arrival, wire::vicon::Bytes payload);
  void pass_on(vicon::Moment arrival);
  [[nodiscard]] const std::string* name_of(std::int32_t id, std::size_t hint) const;
  void add_body(const wire::natnet::RigidBody& body, const std::string& name);

  bool is_y_up_;
  vicon::FrameSink sink_;

  // Received from the server on this connection.
  std::optional<wire::natnet::ServerInfo> server_;
  wire::natnet::Definitions definitions_;
  bool has_definitions_ = false;
  std::optional<vicon::Moment> waits_since_;  ///< arrival of `frame_` if it waits for definitions
  TickClock clock_;
  std::optional<vicon::Echo> echo_;

  Duration opened_{};
  Request connect_;
  Request definitions_request_;
  bool wants_definitions_ = false;
  Request echo_request_;
  Request keep_alive_;

  // Buffers; their memory is reused.
  wire::natnet::Definitions received_;
  wire::natnet::Frame frame_;
  vicon::SeenFrame seen_;
};

/// Returns the protocol of this driver.
const vicon::SessionRow& natnet_row();

}  // namespace vantage::drivers::natnet
