#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <random>
#include <span>
#include <vector>

#include "drivers/crazyflie/crazyradio.hpp"
#include "wire/crtp/packet.hpp"

namespace vantage::test {

using RadioBytes = std::vector<std::uint8_t>;

/// Vehicle's end of a radio link; follows the firmware's safe-link protocol.
struct EmulatedPeer {
  std::vector<RadioBytes> received;  ///< packets with content; the link bits of the header are set
  std::deque<RadioBytes> to_send;
  bool offers_safe_link = true;

  /// Processes a transmission. Returns the payload of the acknowledgement.
  RadioBytes take(const RadioBytes& packet) {
    if (packet == RadioBytes{0xFF, 0x05, 0x01}) {
      is_safe_ = offers_safe_link;
      up_ = down_ = 1;
      return is_safe_ ? packet : RadioBytes{};
    }
    const unsigned header = packet.empty() ? 0xFFU : packet[0];
    if (is_safe_) {
      if ((header >> 2U & 1U) != down_) {
        down_ ^= 1U;
        current_ = next();
      }
      if ((header >> 3U & 1U) != up_) {
        up_ ^= 1U;
        keep(packet);
      }
      RadioBytes out = current_;
      out[0] = static_cast<std::uint8_t>((out[0] & 0xF3U) | down_ << 2U);
      return out;
    }
    keep(packet);
    return next();
  }

 private:
  RadioBytes next() {
    if (to_send.empty()) {
      return {0xF3};
    }
    RadioBytes out = to_send.front();
    to_send.pop_front();
    return out;
  }
  void keep(RadioBytes packet) {
    if ((packet[0] & 0xF3U) != 0xF3U) {
      packet[0] |= 0x0CU;
      received.push_back(packet);
    }
  }

  bool is_safe_ = false;
  unsigned up_ = 1;
  unsigned down_ = 1;
  RadioBytes current_{0xF3};
};

/// Dongle with emulated vehicles in range. Transmissions and acknowledgements are lost at random;
/// like the real dongle, this one repeats lost transmissions.
class EmulatedRadio : public drivers::UsbRadio {
 public:
  struct Air {
    std::map<std::pair<int, std::array<std::uint8_t, 5>>, EmulatedPeer> peers;
    std::vector<RadioBytes> broadcasts;
    bool is_plugged = true;
    double loss = 0.0;  ///< share of transmissions, and of acknowledgements, that are lost
    int settings = 0;   ///< number of vendor requests
    std::mt19937_64 random{11};
  };
  explicit EmulatedRadio(Air& air) : air_(air) {}

  bool open() override { return is_open_ = air_.is_plugged; }
  void close() override { is_open_ = false; }
  [[nodiscard]] bool is_open() const override { return is_open_; }
  bool control(std::uint8_t request, std::uint16_t value,
               std::span<const std::uint8_t> data) override {
    namespace number = drivers::radio_request;
    if (!is_ready()) {
      return false;
    }
    ++air_.settings;
    if (request == number::kChannel) {
      channel_ = value;
    } else if (request == number::kAddress && data.size() == address_.size()) {
      std::ranges::copy(data, address_.begin());
    } else if (request == number::kAcknowledge) {
      acknowledges_ = value != 0;
    } else if (request == number::kRetries) {
      retries_ = value;
    }
    return true;
  }
  bool write(std::span<const std::uint8_t> packet) override {
    if (!is_ready()) {
      return false;
    }
    const RadioBytes bytes(packet.begin(), packet.end());
    if (!acknowledges_) {
      air_.broadcasts.push_back(bytes);
      return true;
    }
    const auto found = air_.peers.find({channel_, address_});
    answer_ = {0};
    for (int i = 0; i <= retries_; ++i) {
      if (found == air_.peers.end() || is_lost()) {
        continue;
      }
      const RadioBytes payload = found->second.take(bytes);
      if (is_lost()) {
        continue;
      }
      answer_ = {static_cast<std::uint8_t>(1 | i << 4)};
      answer_->insert(answer_->end(), payload.begin(), payload.end());
      break;
    }
    return true;
  }
  std::optional<std::size_t> read(std::span<std::uint8_t> buffer) override {
    if (!is_ready()) {
      return std::nullopt;
    }
    const RadioBytes bytes = std::exchange(answer_, std::nullopt).value_or(RadioBytes{});
    std::ranges::copy(bytes, buffer.begin());
    return bytes.size();
  }

 private:
  [[nodiscard]] bool is_ready() {
    is_open_ = is_open_ && air_.is_plugged;
    return is_open_;
  }
  bool is_lost() { return std::uniform_real_distribution<double>()(air_.random) < air_.loss; }

  Air& air_;
  bool is_open_ = false;
  int channel_ = 2;
  int retries_ = 3;
  bool acknowledges_ = true;
  std::array<std::uint8_t, 5> address_{0xE7, 0xE7, 0xE7, 0xE7, 0xE7};
  std::optional<RadioBytes> answer_;
};

}  // namespace vantage::test
