#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/time.hpp"
#include "drivers/crazyflie/crazyradio.hpp"
#include "models/exchange/messages.hpp"
#include "wire/crtp/link_uri.hpp"
#include "wire/crtp/packet.hpp"

namespace vantage::drivers {

/// Numbers of packets on one radio link.
struct RadioCounts {
  std::int64_t sent = 0;     ///< packets sent for the first time
  std::int64_t lost = 0;     ///< transmissions without an acknowledgement, after all retries
  std::int64_t retries = 0;  ///< repetitions by the dongle
  std::int64_t dropped = 0;  ///< packets that were too old or did not fit into the queue
  std::int64_t received = 0;
};

/// Connection with one Crazyflie on the air. Each transmission is acknowledged, and the
/// acknowledgement contains at most one packet of the vehicle. With "safe link", bits of the header
/// count packets in both directions, so that no packet is lost or received twice.
class RadioLink {
 public:
  /// Packets wait at most this long; an old set-point or pose must not be sent.
  static constexpr Duration kAgeMax = std::chrono::milliseconds(200);
  static constexpr std::size_t kQueueMax = 64;

  explicit RadioLink(const wire::crtp::RadioAddress& address) : address_(address) {}

  [[nodiscard]] const wire::crtp::RadioAddress& address() const { return address_; }
  /// Queues a packet. A newer set-point or pose replaces one of the same kind that still waits.
  void write(std::span<const std::uint8_t> packet, Time now);
  /// Returns the next received packet, and removes it.
  std::optional<std::vector<std::uint8_t>> read();

  /// Returns the bytes of the next transmission.
  wire::crtp::Encoded next(Time now);
  /// Processes the answer of the dongle to the last transmission: its status byte and the payload
  /// of the acknowledgement; empty: the dongle did not answer.
  void answer(std::span<const std::uint8_t> bytes, Time now);
  /// True if no packet waits.
  [[nodiscard]] bool is_idle() const { return (!current_ || current_->is_empty) && queue_.empty(); }
  /// True if the vehicle has agreed to safe link.
  [[nodiscard]] bool has_safe_link() const { return is_safe_; }
  [[nodiscard]] const RadioCounts& counts() const { return counts_; }
  /// Returns the time from write() to the acknowledgement of the last packet; nullopt if this time
  /// was already returned.
  std::optional<Duration> take_latency() { return std::exchange(latency_, std::nullopt); }

 private:
  struct Waiting {
    wire::crtp::Encoded packet;
    Time since{};
    bool is_empty = false;
  };
  static Waiting without_content(Time now);
  static constexpr int kSafeLinkTries = 10;

  wire::crtp::RadioAddress address_;
  std::deque<Waiting> queue_;
  std::optional<Waiting> current_;  ///< not acknowledged yet
  std::deque<std::vector<std::uint8_t>> received_;
  bool is_safe_ = false;
  int safe_link_tries_ = 0;
  bool is_asking_ = false;  ///< the last transmission requested safe link
  std::uint8_t up_ = 0;
  std::uint8_t down_ = 0;
  int lost_in_row_ = 0;
  RadioCounts counts_;
  std::optional<Duration> latency_;
};

/// One dongle that serves several vehicles in turn, on any channels and data rates.
class RadioDongle {
 public:
  /// Pause between attempts to open a dongle that is absent.
  static constexpr Duration kReopen = std::chrono::milliseconds(200);

  explicit RadioDongle(std::unique_ptr<UsbRadio> usb) : usb_(std::move(usb)) {}

  /// Adds a link, which must outlive the dongle.
  void add(RadioLink& link) { links_.push_back(&link); }
  /// Exchanges one packet with the vehicle whose turn it is. Returns false if the dongle is absent.
  bool exchange(Time now);
  /// Sends `packet` without acknowledgement to all vehicles of the channel and data rate that
  /// listen to the broadcast address.
  bool broadcast(const wire::crtp::RadioAddress& on, std::span<const std::uint8_t> packet);
  [[nodiscard]] std::int64_t opened() const { return opened_; }

 private:
  bool open(Time now);
  bool tune(const wire::crtp::RadioAddress& address, bool has_acknowledgement);
  bool fail();

  std::unique_ptr<UsbRadio> usb_;
  std::vector<RadioLink*> links_;
  std::size_t turn_ = 0;
  std::optional<wire::crtp::RadioAddress> tuned_;
  bool has_acknowledgement_ = true;
  std::optional<Time> tried_at_;
  std::int64_t opened_ = 0;
};

}  // namespace vantage::drivers
