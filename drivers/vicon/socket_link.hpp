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

/// The driver's socket: opens, closes, reads and writes as the driver wishes, without ever waiting
/// (but for a name that has to be looked up; addresses are not).
class SocketLink {
 public:
  /// @param now  what time it is; asked after each read, so it is the arrival time
  /// @throws StartupError when the system gives no descriptors.
  SocketLink(ViconDriver& driver, std::function<Moment()> now);

  /// Becomes readable when step() has something to do before next_wake().
  [[nodiscard]] int wake_fd() const { return epoll_.fd(); }
  [[nodiscard]] Duration next_wake() const { return driver_.next_wake(); }
  /// Does what there is to do.
  void step();
  /// Datagrams of others than the configured sender.
  [[nodiscard]] std::int64_t strangers() const { return strangers_; }

 private:
  static constexpr int kReadsMax = 256;  ///< of one step: a flood must not stop the process

  void open(Moment now);
  void open_datagram(Moment now);
  void open_stream(Moment now);
  void finish_opening(Moment now);
  void read_all();
  void write_all();
  void fail(const std::string& why);
  void watch(std::uint32_t events);

  ViconDriver& driver_;
  std::function<Moment()> now_;
  Descriptor epoll_;
  Descriptor socket_;
  std::optional<in_addr_t> sender_;  ///< of datagrams; nullopt: anyone
  std::int64_t strangers_ = 0;
  bool is_opening_ = false;
  std::uint32_t watched_ = 0;
  std::vector<std::uint8_t> buffer_;
};

}  // namespace vantage::drivers::vicon
