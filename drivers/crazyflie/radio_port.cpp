#include "drivers/crazyflie/radio_port.hpp"

#include <atomic>
#include <deque>
#include <mutex>
#include <thread>
#include <utility>

#include "core/latency_record.hpp"
#include "drivers/crazyflie/radio_link.hpp"
#include "models/exchange/counts.hpp"

namespace vantage::drivers {
namespace {

namespace crtp = wire::crtp;

Time steady_now() {
  return from_utime(std::chrono::duration_cast<std::chrono::microseconds>(
                        std::chrono::steady_clock::now().time_since_epoch())
                        .count());
}

/// Port to one vehicle through a dongle. The lock is not held during USB transfers.
class RadioPort : public Port {
 public:
  RadioPort(std::unique_ptr<UsbRadio> usb, const crtp::RadioAddress& address)
      : link_(address), dongle_(std::move(usb)) {
    dongle_.add(link_);
    thread_ = std::thread([this] { run(); });
  }
  ~RadioPort() override {
    is_ending_ = true;
    thread_.join();
  }
  RadioPort(const RadioPort&) = delete;
  RadioPort& operator=(const RadioPort&) = delete;
  RadioPort(RadioPort&&) = delete;
  RadioPort& operator=(RadioPort&&) = delete;

  [[nodiscard]] bool is_datagram() const override { return true; }

  std::size_t read(std::span<std::uint8_t> buffer, Time /*now*/) override {
    const std::lock_guard lock(mutex_);
    const auto packet = received_.empty() ? std::nullopt : std::optional(received_.front());
    if (!packet || packet->size > buffer.size()) {
      return 0;
    }
    received_.pop_front();
    std::copy_n(packet->data.begin(), packet->size, buffer.begin());
    return packet->size;
  }

  void write(std::span<const std::uint8_t> message, Time /*now*/) override {
    if (message.size() > crtp::kPacketMax) {
      return;
    }
    crtp::Encoded packet;
    std::copy(message.begin(), message.end(), packet.data.begin());
    packet.size = message.size();
    const std::lock_guard lock(mutex_);
    if (waiting_.size() < RadioLink::kQueueMax) {
      waiting_.push_back({packet, steady_now()});
    } else {
      ++dropped_;
    }
  }

  [[nodiscard]] std::vector<models::NamedCount> counters() const override {
    const std::lock_guard lock(mutex_);
    std::vector<models::NamedCount> out =
        models::nonzero({{"radio.sent", counts_.sent},
                         {"radio.lost", counts_.lost},
                         {"radio.retries", counts_.retries},
                         {"radio.dropped", counts_.dropped + dropped_},
                         {"radio.received", counts_.received},
                         {"radio.opened", opened_}});
    models::append_latency(out, "radio.latency", latency_);
    return out;
  }

 private:
  struct Sent {
    crtp::Encoded packet;
    Time at{};
  };
  static constexpr Duration kIdlePause = std::chrono::milliseconds(1);

  void run() {
    while (!is_ending_) {
      const Time now = steady_now();
      std::deque<Sent> waiting;
      {
        const std::lock_guard lock(mutex_);
        waiting.swap(waiting_);
      }
      for (const Sent& each : waiting) {
        link_.write(each.packet.bytes(), each.at);
      }
      const bool is_there = dongle_.exchange(now);
      {
        const std::lock_guard lock(mutex_);
        while (auto packet = link_.read()) {
          crtp::Encoded copy;
          std::copy(packet->begin(), packet->end(), copy.data.begin());
          copy.size = packet->size();
          if (received_.size() < RadioLink::kQueueMax) {
            received_.push_back(copy);
          }
        }
        counts_ = link_.counts();
        if (const auto latency = link_.take_latency()) {
          latency_.add(*latency);
        }
        opened_ = dongle_.opened();
      }
      if (!is_there || link_.is_idle()) {
        std::this_thread::sleep_for(kIdlePause);
      }
    }
  }

  RadioLink link_;      // used only by the thread
  RadioDongle dongle_;  // used only by the thread
  mutable std::mutex mutex_;
  std::deque<Sent> waiting_;
  std::deque<crtp::Encoded> received_;
  RadioCounts counts_;
  LatencyRecord latency_;
  std::int64_t opened_ = 0;
  std::int64_t dropped_ = 0;
  std::atomic<bool> is_ending_ = false;
  std::thread thread_;
};

}  // namespace

std::unique_ptr<Port> open_radio_port(const crtp::RadioUri& uri) {
  return open_radio_port(make_usb_radio(uri.dongle), uri.address);
}

std::unique_ptr<Port> open_radio_port(std::unique_ptr<UsbRadio> usb,
                                      const crtp::RadioAddress& address) {
  return std::make_unique<RadioPort>(std::move(usb), address);
}

}  // namespace vantage::drivers
