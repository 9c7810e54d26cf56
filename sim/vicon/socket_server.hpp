#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "sim/vicon/object_stream_server.hpp"
#include "sim/vicon/peer.hpp"

namespace vantage::sim::vicon {

/// The emulated server on real sockets; any number of clients (up to kClientsMax at once).
///
/// A DataStream or VRPN server listens at `port` (VRPN also by UDP, and then dials back); an object
/// stream is sent to `host` and `port`. Never blocks but in wait().
class SocketServer {
 public:
  static constexpr std::size_t kClientsMax = 64;

  /// @param port  0: any free one; see port()
  /// @param host  where to listen, or where to send an object stream (may be a broadcast address)
  /// @throws StartupError when the port cannot be had.
  SocketServer(const ServerSettings& settings, const std::string& host, int port);
  ~SocketServer();
  SocketServer(const SocketServer&) = delete;
  SocketServer& operator=(const SocketServer&) = delete;
  SocketServer(SocketServer&&) = delete;
  SocketServer& operator=(SocketServer&&) = delete;

  [[nodiscard]] int port() const { return port_; }
  [[nodiscard]] std::size_t clients() const;
  /// Frames that some client should have had and did not, because it did not read.
  [[nodiscard]] std::int64_t frames_skipped() const { return frames_skipped_; }
  [[nodiscard]] std::int64_t send_errors() const { return send_errors_; }

  /// Serves the clients, and waits up to `timeout` for one to say something.
  void wait(std::chrono::nanoseconds timeout);
  /// Sends a frame to everybody who wants it.
  void publish(const EmulatedFrame& frame);

 private:
  struct Client;
  void listen_at(const std::string& host, int port);
  void accept_clients();
  void on_callbacks();
  void add_client(int fd);
  [[nodiscard]] std::unique_ptr<Peer> make_peer() const;
  void read(Client& client);
  void write(Client& client);
  void sweep();

  ServerSettings settings_;
  int port_ = 0;
  int listener_ = -1;   ///< TCP
  int datagrams_ = -1;  ///< UDP: to send an object stream, to hear VRPN's calls
  ObjectStreamServer object_stream_;
  std::vector<std::unique_ptr<Client>> clients_;
  std::int64_t frames_skipped_ = 0;
  std::int64_t send_errors_ = 0;
};

}  // namespace vantage::sim::vicon
