#include "sim/vicon/socket_server.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <optional>
#include <system_error>

#include <arpa/inet.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "core/address.hpp"
#include "core/check.hpp"
#include "core/deadline.hpp"
#include "sim/vicon/datastream_peer.hpp"
#include "sim/vicon/natnet_peer.hpp"
#include "sim/vicon/qtm_peer.hpp"
#include "sim/vicon/vrpn_peer.hpp"
#include "wire/vicon/vrpn.hpp"

namespace vantage::sim::vicon {
namespace {

constexpr int kSocketFlags = SOCK_NONBLOCK | SOCK_CLOEXEC;

std::string reason() { return std::system_category().message(errno); }

sockaddr_in address_of(const std::string& host, int port) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  if (inet_pton(AF_INET, host.c_str(), &address.sin_addr) != 1) {
    throw StartupError("'" + host + "' is not an IPv4 address");
  }
  return address;
}

void set_option(int fd, int level, int name, int value) {
  setsockopt(fd, level, name, &value, sizeof value);
}

/// Returns a UDP socket bound to `address`.
int bound_datagram_socket(const sockaddr_in& address) {
  const int fd = socket(AF_INET, SOCK_DGRAM | kSocketFlags, 0);
  if (bind(fd, as_sockaddr(address), sizeof address) != 0) {
    const std::string why = reason();
    close(fd);
    throw StartupError("cannot listen at UDP " + std::to_string(ntohs(address.sin_port)) + ": " +
                       why);
  }
  return fd;
}

/// Calls handle(bytes, sender) for each waiting datagram; longer ones are cut at 2048 bytes.
template <class Handle>
void for_each_datagram(int fd, const Handle& handle) {
  std::array<std::uint8_t, 2048> buffer{};
  for (;;) {
    sockaddr_in from{};
    socklen_t size = sizeof from;
    const ssize_t bytes =
        recvfrom(fd, buffer.data(), buffer.size(), 0, reinterpret_cast<sockaddr*>(&from), &size);
    if (bytes < 0) {
      return;
    }
    handle(wire::vicon::Bytes(buffer).first(static_cast<std::size_t>(bytes)), from);
  }
}

Duration steady_now() { return Duration{monotonic_ns() / 1'000}; }

int bound_port(int fd) {
  sockaddr_in address{};
  socklen_t size = sizeof address;
  getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size);
  return ntohs(address.sin_port);
}

}  // namespace

struct SocketServer::Client {
  int fd = -1;
  std::unique_ptr<Peer> peer;
  std::int64_t skipped_before = 0;
  bool is_gone = false;
  sockaddr_in address{};  ///< set only if the protocol uses datagrams
  Duration last_received{};
};

SocketServer::SocketServer(const ServerSettings& settings, const std::string& host, int port)
    : settings_(settings), port_(port), object_stream_(settings) {
  if (settings.protocol.transport() == scenario::MocapTransport::kTcp) {
    listen_at(host, port);
    return;
  }
  if (settings.protocol.transport() == scenario::MocapTransport::kUdpRequested) {
    answer_at(host, port);
    return;
  }
  const sockaddr_in to = address_of(host, port);
  datagrams_ = socket(AF_INET, SOCK_DGRAM | kSocketFlags, 0);
  set_option(datagrams_, SOL_SOCKET, SO_BROADCAST, 1);
  if (connect(datagrams_, as_sockaddr(to), sizeof to) != 0) {
    throw StartupError("cannot send to " + host + ":" + std::to_string(port) + ": " + reason());
  }
}

SocketServer::~SocketServer() {
  for (const auto& client : clients_) {
    if (client->fd >= 0) {
      close(client->fd);
    }
  }
  for (const int fd : {listener_, datagrams_, frames_socket_}) {
    if (fd >= 0) {
      close(fd);
    }
  }
}

void SocketServer::listen_at(const std::string& host, int port) {
  sockaddr_in address = address_of(host, port);
  listener_ = socket(AF_INET, SOCK_STREAM | kSocketFlags, 0);
  set_option(listener_, SOL_SOCKET, SO_REUSEADDR, 1);
  if (bind(listener_, as_sockaddr(address), sizeof address) != 0 || listen(listener_, 16) != 0) {
    const std::string why = reason();
    close(listener_);
    throw StartupError("cannot listen at " + host + ":" + std::to_string(port) + ": " + why);
  }
  port_ = bound_port(listener_);
  if (settings_.protocol == scenario::MocapProtocol::kVrpn) {
    address.sin_port = htons(static_cast<std::uint16_t>(port_));
    datagrams_ = socket(AF_INET, SOCK_DGRAM | kSocketFlags, 0);
    if (bind(datagrams_, as_sockaddr(address), sizeof address) != 0) {
      const std::string why = reason();
      close(listener_);
      close(datagrams_);
      throw StartupError("cannot listen at UDP " + std::to_string(port_) + ": " + why);
    }
  }
}

// OptiTrack's own clients accept frames only from port 1511, so a server that listens at the
// default port sends its frames from port 1511.
void SocketServer::answer_at(const std::string& host, int port) {
  sockaddr_in address = address_of(host, port);
  if (settings_.data_port == 0 && port == settings_.protocol.default_port()) {
    settings_.data_port = static_cast<std::uint16_t>(wire::natnet::kDataPort);
  }
  datagrams_ = bound_datagram_socket(address);
  port_ = bound_port(datagrams_);
  if (settings_.is_multicast) {
    clients_.push_back(std::make_unique<Client>());
    clients_[0]->peer = std::make_unique<NatNetPeer>(settings_, true);
    const wire::natnet::ServerInfo info;
    sockaddr_in& group = clients_[0]->address;
    group.sin_family = AF_INET;
    std::memcpy(&group.sin_addr, info.group.data(), info.group.size());
    group.sin_port = htons(settings_.data_port > 0 ? settings_.data_port : info.data_port);
    setsockopt(datagrams_, IPPROTO_IP, IP_MULTICAST_IF, &address.sin_addr, sizeof address.sin_addr);
  } else if (settings_.data_port > 0) {
    address.sin_port = htons(settings_.data_port);
    frames_socket_ = bound_datagram_socket(address);
  }
}

SocketServer::Client* SocketServer::client_at(const sockaddr_in& address) {
  const auto found = std::ranges::find_if(clients_, [&](const auto& client) {
    return client->address.sin_addr.s_addr == address.sin_addr.s_addr &&
           client->address.sin_port == address.sin_port;
  });
  if (found != clients_.end()) {
    return found->get();
  }
  if (clients_.size() >= kClientsMax) {
    return nullptr;
  }
  clients_.push_back(std::make_unique<Client>());
  clients_.back()->peer = make_peer();
  clients_.back()->address = address;
  return clients_.back().get();
}

void SocketServer::on_requests() {
  for_each_datagram(datagrams_, [this](wire::vicon::Bytes datagram, const sockaddr_in& from) {
    Client* const client = client_at(from);
    if (client == nullptr) {
      return;
    }
    client->peer->now = client->last_received = steady_now();
    if (client->peer->receive(datagram)) {
      send_datagram(*client, datagrams_);
    }
  });
}

void SocketServer::send_datagram(Client& client, int fd) {
  std::vector<std::uint8_t>& outgoing = client.peer->outgoing;
  if (!outgoing.empty()) {
    const ssize_t sent = sendto(fd, outgoing.data(), outgoing.size(), MSG_NOSIGNAL,
                                as_sockaddr(client.address), sizeof client.address);
    send_errors_ += sent < 0 && errno != ECONNREFUSED ? 1 : 0;
    outgoing.clear();
  }
}

std::size_t SocketServer::clients() const { return clients_.size(); }

std::unique_ptr<Peer> SocketServer::make_peer() const {
  if (settings_.protocol == scenario::MocapProtocol::kVrpn) {
    return std::make_unique<VrpnPeer>(settings_);
  }
  if (settings_.protocol == scenario::MocapProtocol::kNatNet) {
    return std::make_unique<NatNetPeer>(settings_);
  }
  if (settings_.protocol == scenario::MocapProtocol::kQtm) {
    return std::make_unique<QtmPeer>(settings_);
  }
  return std::make_unique<DataStreamPeer>(settings_);
}

void SocketServer::add_client(int fd) {
  if (clients_.size() >= kClientsMax) {
    close(fd);
    return;
  }
  set_option(fd, IPPROTO_TCP, TCP_NODELAY, 1);
  clients_.push_back(std::make_unique<Client>(Client{fd, make_peer()}));
}

void SocketServer::accept_clients() {
  for (;;) {
    const int fd = accept4(listener_, nullptr, nullptr, kSocketFlags);
    if (fd < 0) {
      return;
    }
    add_client(fd);
  }
}

void SocketServer::on_connection_requests() {
  for_each_datagram(datagrams_, [this](wire::vicon::Bytes datagram, sockaddr_in from) {
    const auto callback = wire::vicon::decode_vrpn_callback(datagram);
    if (!callback) {
      return;
    }
    // Connects to the requested port at the datagram's source address, so that a client cannot make
    // the server contact a third host.
    from.sin_port = htons(static_cast<std::uint16_t>(callback->port));
    const int fd = socket(AF_INET, SOCK_STREAM | kSocketFlags, 0);
    if (connect(fd, as_sockaddr(from), sizeof from) == 0 || errno == EINPROGRESS) {
      add_client(fd);
    } else {
      close(fd);
    }
  });
}

void SocketServer::read(Client& client) {
  std::array<std::uint8_t, 16384> buffer{};
  for (;;) {
    const ssize_t bytes = recv(client.fd, buffer.data(), buffer.size(), 0);
    if (bytes < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR)) {
      return;
    }
    if (bytes <= 0 ||
        !client.peer->receive(wire::vicon::Bytes(buffer).first(static_cast<std::size_t>(bytes)))) {
      client.is_gone = true;
      return;
    }
  }
}

void SocketServer::write(Client& client) {
  std::vector<std::uint8_t>& outgoing = client.peer->outgoing;
  while (!outgoing.empty()) {
    const ssize_t bytes = send(client.fd, outgoing.data(), outgoing.size(), MSG_NOSIGNAL);
    if (bytes < 0) {
      client.is_gone =
          errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR && errno != ENOTCONN;
      return;
    }
    outgoing.erase(outgoing.begin(), outgoing.begin() + bytes);
  }
}

void SocketServer::sweep() {
  for (const auto& client : clients_) {
    frames_skipped_ += client->peer->frames_skipped - client->skipped_before;
    client->skipped_before = client->peer->frames_skipped;
    if (client->is_gone && client->fd >= 0) {
      close(client->fd);
    }
  }
  std::erase_if(clients_, [](const auto& client) { return client->is_gone; });
}

void SocketServer::wait(std::chrono::nanoseconds timeout) {
  const bool is_answering =
      settings_.protocol.transport() == scenario::MocapTransport::kUdpRequested;
  std::vector<pollfd> polled;
  for (const auto& client : clients_) {
    const bool is_waiting = !client->peer->outgoing.empty();
    polled.push_back({client->fd, static_cast<short>(is_waiting ? POLLIN | POLLOUT : POLLIN), 0});
  }
  polled.push_back({listener_, POLLIN, 0});
  const bool is_vrpn = settings_.protocol == scenario::MocapProtocol::kVrpn;
  polled.push_back({is_vrpn || is_answering ? datagrams_ : -1, POLLIN, 0});
  const std::int64_t ns = std::max<std::int64_t>(timeout.count(), 0);
  const timespec limit{ns / 1'000'000'000, ns % 1'000'000'000};
  if (ppoll(polled.data(), polled.size(), &limit, nullptr) <= 0) {
    return;
  }
  if (is_answering) {
    on_requests();
    return;
  }
  for (const auto& client : clients_) {
    read(*client);
    if (!client->is_gone) {
      write(*client);
    }
  }
  if (listener_ >= 0) {
    accept_clients();
  }
  if (is_vrpn) {
    on_connection_requests();
  }
  for (const auto& client : clients_) {
    write(*client);
  }
  sweep();
}

void SocketServer::publish(const EmulatedFrame& frame) {
  if (settings_.protocol.is_datagram()) {
    for (const std::vector<std::uint8_t>& datagram : object_stream_.encode(frame)) {
      // ECONNREFUSED is not an error: an object stream may have no listener.
      const ssize_t sent = send(datagrams_, datagram.data(), datagram.size(), MSG_NOSIGNAL);
      send_errors_ += sent < 0 && errno != ECONNREFUSED ? 1 : 0;
    }
    return;
  }
  if (settings_.protocol.transport() == scenario::MocapTransport::kUdpRequested) {
    const Duration now = steady_now();
    for (std::size_t i = 0; i < clients_.size(); ++i) {
      Client& client = *clients_[i];
      const bool is_group = settings_.is_multicast && i == 0;
      client.peer->now = now;
      client.peer->on_frame(frame);
      if (is_group || !settings_.is_multicast) {
        send_datagram(client, frames_socket_ >= 0 ? frames_socket_ : datagrams_);
      }
      client.peer->outgoing.clear();
      client.is_gone = !is_group && now - client.last_received > kClientSilenceMax;
    }
    sweep();
    return;
  }
  for (const auto& client : clients_) {
    client->peer->now = steady_now();
    client->peer->on_frame(frame);
    write(*client);
  }
  sweep();
}

}  // namespace vantage::sim::vicon
