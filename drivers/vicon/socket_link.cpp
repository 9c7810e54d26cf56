#include "drivers/vicon/socket_link.hpp"

#include <cerrno>
#include <cstring>
#include <system_error>
#include <utility>

#include <netinet/tcp.h>
#include <poll.h>
#include <sys/epoll.h>
#include <sys/socket.h>

#include "core/address.hpp"
#include "core/check.hpp"

namespace vantage::drivers::vicon {
namespace {

constexpr std::size_t kReadBytes = std::size_t{1} << 16U;  // bytes; size of the largest datagram
constexpr int kReceiveBufferBytes = 4 << 20;               // buffer for 4 s of 100 bodies at 100 Hz

std::string reason(int error) { return std::system_category().message(error); }

void set_option(int fd, int level, int name, int value) {
  setsockopt(fd, level, name, &value, sizeof value);  // errors are ignored: no option is essential
}

void enlarge_receive_buffer(int fd) {
  // The privileged option may exceed net.core.rmem_max. Without the privilege, the kernel limits
  // the buffer to that value.
  const int bytes = kReceiveBufferBytes;
  if (setsockopt(fd, SOL_SOCKET, SO_RCVBUFFORCE, &bytes, sizeof bytes) != 0) {
    set_option(fd, SOL_SOCKET, SO_RCVBUF, bytes);
  }
}

}  // namespace

SocketLink::SocketLink(ViconDriver& driver, std::function<Moment()> now)
    : driver_(driver),
      now_(std::move(now)),
      epoll_(epoll_create1(EPOLL_CLOEXEC)),
      buffer_(kReadBytes) {
  if (!epoll_.is_open()) {
    throw StartupError("cannot create an epoll descriptor: " + reason(errno));
  }
}

void SocketLink::watch(std::uint32_t events) {
  if (events == watched_) {
    return;
  }
  epoll_event event{};
  event.events = events;
  epoll_ctl(epoll_.fd(), watched_ == 0 ? EPOLL_CTL_ADD : EPOLL_CTL_MOD, socket_.fd(), &event);
  watched_ = events;
}

void SocketLink::fail(const std::string& why) {
  socket_.reset();  // closing also removes the socket from the epoll set
  group_socket_.reset();
  group_.reset();
  watched_ = 0;
  is_opening_ = false;
  driver_.on_closed(now_(), why);
}

void SocketLink::step() {
  const Moment now = now_();
  if (is_opening_) {
    finish_opening(now);
  }
  if (driver_.is_open()) {
    read_all(socket_.fd());
  }
  if (driver_.is_open() && group_socket_.is_open()) {
    read_all(group_socket_.fd());
  }
  driver_.on_time(now_());
  if (driver_.wants_close()) {
    fail("closed");
  } else if (driver_.wants_open(now)) {
    open(now);
  }
  if (driver_.is_open()) {
    write_all();
  }
  if (driver_.is_open()) {
    follow_group();
  }
}

void SocketLink::open(Moment now) {
  driver_.on_opening(now);
  switch (driver_.transport()) {
    case scenario::MocapTransport::kTcp:
      open_stream(now);
      return;
    case scenario::MocapTransport::kUdpReceived:
      open_datagram(now);
      return;
    case scenario::MocapTransport::kUdpRequested:
      open_requested(now);
      return;
  }
}

void SocketLink::open_datagram(Moment now) {
  if (driver_.has_sender()) {
    const Result<sockaddr_in> sender = find_host(driver_.host(), driver_.port());
    if (!sender.ok()) {
      fail(sender.error().message + "; check mocap.host");
      return;
    }
    sender_ = sender.value().sin_addr.s_addr;
  }
  socket_.reset(socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  // other processes may also receive a broadcast
  set_option(socket_.fd(), SOL_SOCKET, SO_REUSEADDR, 1);
  enlarge_receive_buffer(socket_.fd());
  const sockaddr_in address = address_of(INADDR_ANY, driver_.port());
  if (bind(socket_.fd(), as_sockaddr(address), sizeof address) != 0) {
    fail("cannot listen: " + reason(errno));
    return;
  }
  watch(EPOLLIN);
  driver_.on_opened(now);
}

// The socket is not connected, because a server may send frames from a port other than that of its
// answers.
void SocketLink::open_requested(Moment now) {
  const Result<sockaddr_in> server = find_host(driver_.host(), driver_.port());
  if (!server.ok()) {
    fail(server.error().message + "; check mocap.host");
    return;
  }
  server_ = server.value();
  sender_ = server_->sin_addr.s_addr;
  socket_.reset(socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  enlarge_receive_buffer(socket_.fd());
  watch(EPOLLIN);
  driver_.on_opened(now);
}

void SocketLink::follow_group() {
  const std::optional<MulticastGroup> wanted = driver_.group();
  if (wanted == group_) {
    return;
  }
  group_ = wanted;
  group_socket_.reset();
  if (!wanted) {
    return;
  }
  // Joins the group on the network card that leads to the server; the default card may differ.
  sockaddr_in own{};
  socklen_t own_size = sizeof own;
  const Descriptor route(socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  if (connect(route.fd(), as_sockaddr(*server_), sizeof *server_) != 0 ||
      getsockname(route.fd(), reinterpret_cast<sockaddr*>(&own), &own_size) != 0) {
    fail("no route to the server: " + reason(errno));
    return;
  }
  ip_mreq join{};
  std::memcpy(&join.imr_multiaddr, wanted->address.data(), wanted->address.size());
  join.imr_interface = own.sin_addr;
  group_socket_.reset(socket(AF_INET, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  set_option(group_socket_.fd(), SOL_SOCKET, SO_REUSEADDR,
             1);  // other processes may also join the group
  enlarge_receive_buffer(group_socket_.fd());
  sockaddr_in address = address_of(INADDR_ANY, wanted->port);
  address.sin_addr = join.imr_multiaddr;
  if (bind(group_socket_.fd(), as_sockaddr(address), sizeof address) != 0 ||
      setsockopt(group_socket_.fd(), IPPROTO_IP, IP_ADD_MEMBERSHIP, &join, sizeof join) != 0) {
    fail("cannot receive the server's multicast group: " + reason(errno));
    return;
  }
  epoll_event event{};
  event.events = EPOLLIN;
  epoll_ctl(epoll_.fd(), EPOLL_CTL_ADD, group_socket_.fd(), &event);
}

void SocketLink::open_stream(Moment now) {
  const Result<sockaddr_in> address = find_host(driver_.host(), driver_.port());
  if (!address.ok()) {
    fail(address.error().message + "; check mocap.host");
    return;
  }
  socket_.reset(socket(AF_INET, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  set_option(socket_.fd(), IPPROTO_TCP, TCP_NODELAY, 1);
  enlarge_receive_buffer(socket_.fd());
  if (connect(socket_.fd(), as_sockaddr(address.value()), sizeof address.value()) == 0) {
    watch(EPOLLIN);
    driver_.on_opened(now);
  } else if (errno == EINPROGRESS) {
    is_opening_ = true;
    watch(EPOLLOUT);
  } else {
    fail("cannot connect: " + reason(errno));
  }
}

void SocketLink::finish_opening(Moment now) {
  pollfd polled{socket_.fd(), POLLOUT, 0};
  if (poll(&polled, 1, 0) <= 0) {
    return;
  }
  int error = 0;
  socklen_t size = sizeof error;
  getsockopt(socket_.fd(), SOL_SOCKET, SO_ERROR, &error, &size);
  if (error != 0) {
    fail(error == ECONNREFUSED
             ? "connection refused; is the server running, and is mocap.port right?"
             : "cannot connect: " + reason(error));
    return;
  }
  is_opening_ = false;
  watch(EPOLLIN);
  driver_.on_opened(now);
}

void SocketLink::read_all(int fd) {
  for (int reads = 0; reads < kReadsMax && driver_.is_open() && !driver_.wants_close(); ++reads) {
    sockaddr_in from{};
    socklen_t from_size = sizeof from;
    const ssize_t size = recvfrom(fd, buffer_.data(), buffer_.size(), 0,
                                  reinterpret_cast<sockaddr*>(&from), &from_size);
    if (size < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) {
      return;
    }
    if (size < 0 && errno == EINTR) {
      continue;
    }
    if (size == 0 && driver_.transport() == scenario::MocapTransport::kTcp) {
      fail("the server closed the connection");
      return;
    }
    if (size < 0) {
      fail("the connection failed: " + reason(errno));
      return;
    }
    if (sender_ && from.sin_addr.s_addr != *sender_) {
      ++strangers_;
      continue;
    }
    driver_.receive(now_(), wire::vicon::Bytes(buffer_).first(static_cast<std::size_t>(size)));
  }
}

void SocketLink::write_all() {
  std::vector<std::uint8_t>& outgoing = driver_.outgoing();
  while (!outgoing.empty()) {
    const ssize_t size =
        sendto(socket_.fd(), outgoing.data(), outgoing.size(), MSG_NOSIGNAL,
               server_ ? as_sockaddr(*server_) : nullptr, server_ ? sizeof *server_ : 0);
    if (size < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) {
      break;
    }
    if (size < 0 && errno == EINTR) {
      continue;
    }
    if (size < 0) {
      fail("the connection failed: " + reason(errno));
      return;
    }
    outgoing.erase(outgoing.begin(), outgoing.begin() + size);
  }
  watch(outgoing.empty() ? EPOLLIN : EPOLLIN | EPOLLOUT);
}

}  // namespace vantage::drivers::vicon
