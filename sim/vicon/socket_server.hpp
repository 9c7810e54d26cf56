#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <netinet/in.h>

#include "core/time.hpp"
#include "sim/vicon/object_stream_server.hpp"
#include "sim/vicon/peer.hpp"

namespace vantage::sim::vicon {

/// Emulated mocap server on real sockets, for up to kClientsMax clients.
///
/// A NatNet server answers datagrams at `port`, and forgets clients that send nothing for
/// kClientSilenceMax. A DataStream, VRPN or QTM server listens at `port` (VRPN also by UDP, and
/// then connects back to the client); an object stream is sent to `host` and `port`. Only wait()
/// blocks.
class SocketServer {
 public:
  static constexpr std::size_t kClientsMax = 64;
  static constexpr Duration kClientSilenceMax = std::chrono::seconds(10);

  /// @param port  port number; 0: any free port, returned by port()
  /// @param host  address to listen at, or to which an object stream is sent (may be a broadcast
  ///              address)
  /// @throws StartupError if the port cannot be opened.
  SocketServer(const ServerSettings& settings, const std::string& host, int port);
  ~SocketServer();
  SocketServer(const SocketServer&) = delete;
  SocketServer& operator=(const SocketServer&) = delete;
  SocketServer(SocketServer&&) = delete;
  SocketServer& operator=(SocketServer&&) = delete;

  [[nodiscard]] int port() const { return port_; }
  [[nodiscard]] std::size_t clients() const;
  /// Returns the number of frames skipped for clients that did not read.
  [[nodiscard]] std::int64_t frames_skipped() const { return frames_skipped_; }
  [[nodiscard]] std::int64_t send_errors() const { return send_errors_; }

  /// Serves the clients; waits up to `timeout` for data from a client.
  void wait(std::chrono::nanoseconds timeout);
  /// Sends a frame to all clients that request it.
  void publish(const EmulatedFrame& frame);

 private:
  struct Client;
  void listen_at(const std::string& host, int port);
  void answer_at(const std::string& host, int port);
  void on_requests();
  Client* client_at(const sockaddr_in& address);
  void send_datagram(Client& client, int fd);
  void accept_clients();
  void on_connection_requests();
  void add_client(int fd);
  [[nodiscard]] std::unique_ptr<Peer> make_peer() const;
  void read(Client& client);
  void write(Client& client);
  void sweep();

  ServerSettings settings_;
  int port_ = 0;
  int listener_ = -1;  ///< TCP socket for connections; −1: none
  /// UDP socket: sends an object stream, receives VRPN's connection requests, or receives and
  /// answers NatNet's requests
  int datagrams_ = -1;
  int frames_socket_ = -1;  ///< UDP socket that sends NatNet's frames; −1: `datagrams_`
  ObjectStreamServer object_stream_;
  std::vector<std::unique_ptr<Client>> clients_;
  std::int64_t frames_skipped_ = 0;
  std::int64_t send_errors_ = 0;
};

}  // namespace vantage::sim::vicon
