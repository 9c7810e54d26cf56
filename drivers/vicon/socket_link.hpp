#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <netinet/in.h>

#include "drivers/vicon/descriptor.hpp"
#include "drivers/vicon/driver.hpp"

namespace vantage::drivers::vicon {

/// Socket of the driver. It opens, closes, reads and writes on the driver's request without
/// blocking, except for the lookup of a host name.
class SocketLink {
 public:
  /// @param now  returns the current time; called after each read for the arrival time
  /// @throws StartupError if the system has no free descriptor.
  SocketLink(ViconDriver& driver, std::function<Moment()> now);

  /// Returns a descriptor that becomes readable when step() has work before next_wake().
  [[nodiscard]] int wake_fd() const { return epoll_.fd(); }
  [[nodiscard]] Duration next_wake() const { return driver_.next_wake(); }
  /// Performs all pending work.
  void step();
  /// Returns the number of datagrams from senders other than the configured one.
  [[nodiscard]] std::int64_t strangers() const { return strangers_; }

 private:
  /// maximum reads per step: a flood of data must not block the process
  static constexpr int kReadsMax = 256;

  void open(Moment now);
  void open_datagram(Moment now);
  void open_requested(Moment now);
  void open_stream(Moment now);
  void finish_opening(Moment now);
  /// Joins or leaves the multicast group, as the driver requests.
  void follow_group();
  void read_all(int fd);
  void write_all();
  void fail(const std::string& why);
  void watch(std::uint32_t events);

  ViconDriver& driver_;
  std::function<Moment()> now_;
  Descriptor epoll_;
  Descriptor socket_;
  Descriptor group_socket_;
  std::optional<MulticastGroup>
      group_;  ///< group of `group_socket_`, or the one that could not be joined
  /// destination of datagrams; nullopt: the socket is connected, or there is none
  std::optional<sockaddr_in> server_;
  std::optional<in_addr_t> sender_;  ///< accepted sender of datagrams; nullopt: any
  std::int64_t strangers_ = 0;
  bool is_opening_ = false;
  std::uint32_t watched_ = 0;
  std::vector<std::uint8_t> buffer_;
};

}  // namespace vantage::drivers::vicon
