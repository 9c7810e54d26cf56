#include "bus/transport/unicast_relay.hpp"

#include <algorithm>
#include <cerrno>
#include <system_error>

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include "bus/transport/udpm_packet.hpp"
#include "core/address.hpp"
#include "core/check.hpp"

namespace vantage::bus::udpm {
namespace {

int open_socket() { return socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0); }

/// Returns the IPv4 addresses of this host, in network byte order.
std::vector<in_addr_t> own_addresses() {
  std::vector<in_addr_t> out;
  ifaddrs* first = nullptr;
  if (getifaddrs(&first) != 0) {
    return out;
  }
  for (const ifaddrs* each = first; each != nullptr; each = each->ifa_next) {
    if (each->ifa_addr != nullptr && each->ifa_addr->sa_family == AF_INET) {
      // The family AF_INET states that the address has the type sockaddr_in.
      out.push_back(reinterpret_cast<const sockaddr_in*>(each->ifa_addr)  // NOLINT
                        ->sin_addr.s_addr);
    }
  }
  freeifaddrs(first);
  return out;
}

bool send_to(int fd, const sockaddr_in& to, std::span<const std::uint8_t> head,
             std::span<const std::uint8_t> payload) {
  // sendmsg() only reads through these pointers, but its C interface requires non-const pointers.
  std::array<iovec, 2> pieces{
      iovec{const_cast<std::uint8_t*>(head.data()), head.size()},         // NOLINT
      iovec{const_cast<std::uint8_t*>(payload.data()), payload.size()}};  // NOLINT
  sockaddr_in address = to;
  msghdr message{};
  message.msg_name = &address;
  message.msg_namelen = sizeof address;
  message.msg_iov = pieces.data();
  message.msg_iovlen = pieces.size();
  ssize_t sent = -1;
  do {
    sent = sendmsg(fd, &message, MSG_NOSIGNAL | MSG_DONTWAIT);
  } while (sent < 0 && (errno == EINTR || errno == ECONNREFUSED));
  return sent == static_cast<ssize_t>(head.size() + payload.size());
}

}  // namespace

UnicastRelay::UnicastRelay(const UdpmAddress& address)
    : is_own_(address.peers.size(), 0),
      group_fd_(open_socket()),
      peer_fd_(open_socket()),
      stop_fd_(eventfd(0, EFD_CLOEXEC)) {
  for (const UdpmPeer& peer : address.peers) {
    sockaddr_in& each = peers_.emplace_back();
    each.sin_family = AF_INET;
    each.sin_port = htons(static_cast<std::uint16_t>(peer.port));
    inet_pton(AF_INET, peer.address.c_str(), &each.sin_addr);  // checked by parse_udpm
  }
  group_.sin_family = AF_INET;
  group_.sin_port = htons(static_cast<std::uint16_t>(address.port));
  inet_pton(AF_INET, address.group.c_str(), &group_.sin_addr);
  const std::uint8_t hops = 0;
  const std::uint8_t loop = 1;
  if (group_fd_ < 0 || peer_fd_ < 0 || stop_fd_ < 0 ||
      setsockopt(group_fd_, IPPROTO_IP, IP_MULTICAST_TTL, &hops, sizeof hops) != 0 ||
      setsockopt(group_fd_, IPPROTO_IP, IP_MULTICAST_LOOP, &loop, sizeof loop) != 0) {
    throw StartupError("LCM udpm: cannot create a socket for peers: " +
                       std::system_category().message(errno));
  }
}

UnicastRelay::~UnicastRelay() {
  if (thread_.joinable()) {
    const std::uint64_t one = 1;
    static_cast<void>(!write(stop_fd_, &one, sizeof one));
    thread_.join();
  }
  for (const int fd : {group_fd_, peer_fd_, stop_fd_}) {
    close(fd);
  }
}

bool UnicastRelay::send(std::span<const std::uint8_t> head, std::span<const std::uint8_t> payload) {
  bool is_sent = true;
  for (std::size_t i = 0; i < peers_.size(); ++i) {
    if (is_own_[i] == 0) {
      is_sent = send_to(peer_fd_, peers_[i], head, payload) && is_sent;
    }
  }
  return is_sent;
}

void UnicastRelay::keep(std::int64_t monotonic_ns) {
  if (monotonic_ns < next_try_ns_) {
    return;
  }
  next_try_ns_ = monotonic_ns + kRetryPeriodNs;
  const std::vector<in_addr_t> own = own_addresses();
  for (std::size_t i = 0; i < peers_.size(); ++i) {
    is_own_[i] = std::find(own.begin(), own.end(), peers_[i].sin_addr.s_addr) != own.end() ? 1 : 0;
  }
  const auto mine = std::find(is_own_.begin(), is_own_.end(), 1);
  if (thread_.joinable() || mine == is_own_.end()) {
    return;
  }
  const int fd = open_socket();
  const sockaddr_in& address = peers_[static_cast<std::size_t>(mine - is_own_.begin())];
  constexpr int kBufferBytes = 1 << 20;
  if (fd < 0 || bind(fd, as_sockaddr(address), sizeof address) != 0) {
    if (fd >= 0) {
      close(fd);  // another process of this host is the relay
    }
    return;
  }
  setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &kBufferBytes, sizeof kBufferBytes);
  thread_ = std::thread([this, fd] { relay(fd); });
}

bool UnicastRelay::is_peer(const sockaddr_in& from) const {
  return std::any_of(peers_.begin(), peers_.end(), [&](const sockaddr_in& peer) {
    return peer.sin_addr.s_addr == from.sin_addr.s_addr;
  });
}

std::uint32_t UnicastRelay::number_for(std::uint64_t source, std::uint32_t sequence) {
  const auto known = std::find_if(renumbered_.begin(), renumbered_.end(), [&](const auto& each) {
    return each.source == source && each.sequence == sequence;
  });
  if (known != renumbered_.end()) {
    return known->relayed;
  }
  Renumbered& next = renumbered_[renumbered_next_];
  renumbered_next_ = (renumbered_next_ + 1) % kRenumberedKept;
  next = {source, sequence, next_sequence_++};
  return next.relayed;
}

void UnicastRelay::relay(int receiver) {
  constexpr std::size_t kSequenceAt = 4;
  std::vector<std::uint8_t> buffer(kDatagramBytesMax + 1);
  std::array<pollfd, 2> polled{pollfd{receiver, POLLIN, 0}, pollfd{stop_fd_, POLLIN, 0}};
  while (poll(polled.data(), polled.size(), -1) >= 0 || errno == EINTR) {
    if ((polled[1].revents & POLLIN) != 0) {
      break;
    }
    sockaddr_in from{};
    socklen_t length = sizeof from;
    const ssize_t size = recvfrom(receiver, buffer.data(), buffer.size(), MSG_DONTWAIT,
                                  reinterpret_cast<sockaddr*>(&from), &length);  // NOLINT
    if (size < 0) {
      continue;
    }
    const auto datagram = std::span(buffer).first(static_cast<std::size_t>(size));
    const auto packet = parse_packet(datagram);
    if (!packet || !is_peer(from)) {
      ++refused_;
      continue;
    }
    const std::uint64_t source =
        (std::uint64_t{ntohl(from.sin_addr.s_addr)} << 16U) | ntohs(from.sin_port);
    std::uint32_t number =
        packet->is_fragment ? number_for(source, packet->sequence) : next_sequence_++;
    for (std::size_t i = 4; i-- > 0; number >>= 8U) {
      datagram[kSequenceAt + i] = static_cast<std::uint8_t>(number);
    }
    relayed_ += send_to(group_fd_, group_, datagram, {}) ? 1 : 0;
  }
  close(receiver);
}

}  // namespace vantage::bus::udpm
