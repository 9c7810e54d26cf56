#include "bus/transport/udpm_socket.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <string>
#include <system_error>

#include <arpa/inet.h>
#include <linux/sock_diag.h>
#include <net/if.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include "bus/transport/udpm_packet.hpp"
#include "core/address.hpp"
#include "core/check.hpp"
#include "core/reception.hpp"

namespace vantage::bus::udpm {
namespace {

constexpr int kSendBufferBytes = 1 << 20;
constexpr suseconds_t kSendTimeoutUs = 100'000;

std::string reason() { return std::system_category().message(errno); }

template <class Option>
bool set_option(int fd, int level, int name, const Option& value) {
  return setsockopt(fd, level, name, &value, sizeof value) == 0;
}

template <class Option>
void require_option(int fd, int level, int name, const Option& value, const char* what) {
  if (!set_option(fd, level, name, value)) {
    throw StartupError(std::string("LCM udpm: cannot set ") + what + ": " + reason());
  }
}

std::string advice(const UdpmAddress& address) {
  return address.interface.empty()
             ? ". Is there a multicast route? On one host: ip link set lo up; "
               "ip route add 224.0.0.0/4 dev lo"
             : " (interface=" + address.interface + ")";
}

bool is_network_error(int error) {
  return error == ENETUNREACH || error == ENETDOWN || error == ENODEV || error == EHOSTUNREACH ||
         error == EADDRNOTAVAIL;
}

int open_udp() { return socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0); }

}  // namespace

MulticastSocket::Descriptor::~Descriptor() {
  if (fd_ >= 0) {
    close(fd_);
  }
}

MulticastSocket::MulticastSocket(const UdpmAddress& address, Absence absence)
    : address_(address),
      receiver_(open_udp()),
      sender_(open_udp()),
      buffer_(kDatagramBytesMax + 1) {
  // The temporary third socket checks that join() will be able to open its probe socket.
  if (receiver_.fd() < 0 || sender_.fd() < 0 || Descriptor(open_udp()).fd() < 0) {
    throw StartupError("LCM udpm: cannot create a socket: " + reason());
  }
  group_.sin_family = AF_INET;
  group_.sin_port = htons(static_cast<std::uint16_t>(address.port));
  inet_pton(AF_INET, address.group.c_str(), &group_.sin_addr);  // checked by parse_udpm
  membership_.imr_multiaddr = group_.sin_addr;
  open_receiver(address);
  open_sender(address);
  fault_ = join();
  is_joined_ = fault_.empty();
  if (!is_joined_ && absence == Absence::kError) {
    throw StartupError(fault_);
  }
  network_losses_ = is_joined_ ? 0 : 1;
}

MulticastSocket::~MulticastSocket() = default;

std::string MulticastSocket::find_interface() {
  const std::string& interface = address_.interface;
  if (interface.empty() || inet_pton(AF_INET, interface.c_str(), &membership_.imr_address) == 1) {
    return "";  // the kernel refuses an address that this host does not have
  }
  membership_.imr_ifindex = static_cast<int>(if_nametoindex(interface.c_str()));
  return membership_.imr_ifindex != 0 ? ""
                                      : "LCM udpm: interface=" + interface + ": " + reason() +
                                            ". 'ip -4 address' lists the interfaces";
}

std::string MulticastSocket::join() {
  if (std::string fault = find_interface(); !fault.empty()) {
    return fault;
  }
  // With a configured card, datagrams that arrive on another card are not received. EADDRINUSE: the
  // membership has survived the loss of the network.
  if (!set_option(receiver_.fd(), IPPROTO_IP, IP_ADD_MEMBERSHIP, membership_) &&
      errno != EADDRINUSE) {
    return "LCM udpm: cannot join " + address_.group + ": " + reason() + advice(address_);
  }
  // connect() sends nothing, but checks the route immediately. This check needs a separate socket,
  // because a connected socket does not change its route when the interface changes.
  const Descriptor probe(open_udp());
  const std::string cannot_send = "LCM udpm: cannot send to " + address_.group + ": ";
  if (probe.fd() < 0) {
    return cannot_send + reason();
  }
  const bool names_card = !address_.interface.empty();
  if (names_card && (!set_option(sender_.fd(), IPPROTO_IP, IP_MULTICAST_IF, membership_) ||
                     !set_option(probe.fd(), IPPROTO_IP, IP_MULTICAST_IF, membership_))) {
    return "LCM udpm: cannot set IP_MULTICAST_IF: " + reason();
  }
  if (connect(probe.fd(), as_sockaddr(group_), sizeof group_) != 0) {
    return cannot_send + reason() + advice(address_);
  }
  return "";
}

bool MulticastSocket::keep_joined(std::int64_t monotonic_ns) {
  if (!is_joined_ && monotonic_ns >= next_try_ns_) {
    next_try_ns_ = monotonic_ns + kRetryPeriodNs;
    fault_ = join();
    is_joined_ = fault_.empty();
  }
  return is_joined_;
}

void MulticastSocket::open_receiver(const UdpmAddress& address) {
  const int fd = receiver_.fd();
  // Both options are set: liblcm shares its port by SO_REUSEADDR, and two sockets of this class
  // must share it as well.
  require_option(fd, SOL_SOCKET, SO_REUSEADDR, 1, "SO_REUSEADDR");
  require_option(fd, SOL_SOCKET, SO_REUSEPORT, 1, "SO_REUSEPORT");
  // SO_RCVBUFFORCE needs privileges and may exceed net.core.rmem_max; that value limits SO_RCVBUF.
  if (!set_option(fd, SOL_SOCKET, SO_RCVBUFFORCE, address.recv_buf_bytes)) {
    require_option(fd, SOL_SOCKET, SO_RCVBUF, address.recv_buf_bytes, "SO_RCVBUF");
  }
  int doubled = 0;  // the kernel reports twice the requested size, including overhead
  socklen_t size = sizeof doubled;
  getsockopt(fd, SOL_SOCKET, SO_RCVBUF, &doubled, &size);
  receive_buffer_bytes_ = doubled / 2;
  set_option(fd, SOL_SOCKET, SO_RXQ_OVFL, 1);       // counts drops; optional
  set_option(fd, IPPROTO_IP, IP_MULTICAST_ALL, 0);  // only messages of the joined group
  // The socket is bound to the group address, so it does not receive datagrams to this host's own
  // addresses.
  if (bind(fd, as_sockaddr(group_), sizeof group_) != 0) {
    throw StartupError("LCM udpm: cannot listen on " + address.group + ":" +
                       std::to_string(address.port) + ": " + reason());
  }
}

void MulticastSocket::open_sender(const UdpmAddress& address) {
  const int fd = sender_.fd();
  require_option(fd, IPPROTO_IP, IP_MULTICAST_TTL, static_cast<std::uint8_t>(address.ttl),
                 "IP_MULTICAST_TTL");
  ttl_set_ = address.ttl;
  require_option(fd, IPPROTO_IP, IP_MULTICAST_LOOP, std::uint8_t{1}, "IP_MULTICAST_LOOP");
  set_option(fd, SOL_SOCKET, SO_SNDBUF, kSendBufferBytes);  // the kernel may grant less
  require_option(fd, SOL_SOCKET, SO_SNDTIMEO, timeval{0, kSendTimeoutUs}, "SO_SNDTIMEO");
}

bool MulticastSocket::send(std::span<const std::uint8_t> head,
                           std::span<const std::uint8_t> payload, bool stays_on_host) {
  const int ttl = stays_on_host ? 0 : address_.ttl;
  if (ttl != ttl_set_ &&
      !set_option(sender_.fd(), IPPROTO_IP, IP_MULTICAST_TTL, static_cast<std::uint8_t>(ttl))) {
    return false;
  }
  ttl_set_ = ttl;
  // sendmsg() only reads through these pointers, but its C interface requires non-const pointers.
  std::array<iovec, 2> pieces{
      iovec{const_cast<std::uint8_t*>(head.data()), head.size()},         // NOLINT
      iovec{const_cast<std::uint8_t*>(payload.data()), payload.size()}};  // NOLINT
  msghdr message{};
  message.msg_name = &group_;
  message.msg_namelen = sizeof group_;
  message.msg_iov = pieces.data();
  message.msg_iovlen = pieces.size();
  ssize_t sent = -1;
  do {
    sent = sendmsg(sender_.fd(), &message, MSG_NOSIGNAL);
  } while (sent < 0 && errno == EINTR);
  if (sent < 0 && is_joined_ && is_network_error(errno)) {
    fault_ = "LCM udpm: cannot send to " + address_.group + ": " + reason();
    is_joined_ = false;
    ++network_losses_;
  }
  return sent == static_cast<ssize_t>(head.size() + payload.size());
}

void MulticastSocket::set_filter(std::span<const sock_filter> filter) {
  // The kernel only reads through the pointer.
  const sock_fprog program{static_cast<unsigned short>(filter.size()),
                           const_cast<sock_filter*>(filter.data())};  // NOLINT
  const bool is_attached =
      !filter.empty() && set_option(receiver_.fd(), SOL_SOCKET, SO_ATTACH_FILTER, program);
  if (!is_attached && is_filtered_) {
    set_option(receiver_.fd(), SOL_SOCKET, SO_DETACH_FILTER, 0);
  }
  is_filtered_ = is_attached;
  was_filtered_ = was_filtered_ || is_attached;
}

// Only receive() empties the buffer. So if the buffer was full since the last series, it is nearly
// full now. The kernel frees up to a quarter of the buffer only some time after the data were read.
// Datagrams that arrived after an overflow report it, so the flag stays set until one of them was
// received.
void MulticastSocket::begin_receiving() {
  std::array<std::uint32_t, SK_MEMINFO_VARS> memory{};
  socklen_t size = sizeof memory;
  is_full_ = was_filtered_ &&
             getsockopt(receiver_.fd(), SOL_SOCKET, SO_MEMINFO, memory.data(), &size) == 0 &&
             memory[SK_MEMINFO_RMEM_ALLOC] > memory[SK_MEMINFO_RCVBUF] / 2;
  is_overflow_possible_ = is_overflow_possible_ || is_full_;
}

bool MulticastSocket::wait(std::chrono::nanoseconds timeout) {
  constexpr std::int64_t kNsPerS = 1'000'000'000;
  const std::int64_t ns = std::max<std::int64_t>(timeout.count(), 0);
  const timespec limit{ns / kNsPerS, ns % kNsPerS};
  pollfd polled{receiver_.fd(), POLLIN, 0};
  return ppoll(&polled, 1, &limit, nullptr) > 0;
}

std::optional<Datagram> MulticastSocket::receive() {
  Reception<std::uint32_t> heard(receiver_.fd(), buffer_, MSG_DONTWAIT);
  if (heard.size() < 0) {
    return std::nullopt;
  }
  if (const auto drops = heard.ancillary(SO_RXQ_OVFL)) {
    if (*drops != kernel_drops_seen_ && (is_overflow_possible_ || !was_filtered_)) {
      kernel_drops_ += *drops - kernel_drops_seen_;
      is_overflow_possible_ = is_full_;
    }
    kernel_drops_seen_ = *drops;
  }
  const sockaddr_in& from = heard.from();
  const std::uint64_t source =
      (std::uint64_t{ntohl(from.sin_addr.s_addr)} << 16U) | ntohs(from.sin_port);
  return Datagram{source, std::span(buffer_).first(static_cast<std::size_t>(heard.size()))};
}

}  // namespace vantage::bus::udpm
