#include "drivers/crazyflie/radio_link.hpp"

#include <algorithm>
#include <utility>

namespace vantage::drivers {
namespace {

namespace crtp = wire::crtp;

constexpr std::array<std::uint8_t, 3> kSafeLinkRequest{0xFF, 0x05, 0x01};
constexpr std::uint8_t kNumberBits = 0x0C;
constexpr std::uint8_t kAcknowledged = 0x01;
// number of lost transmissions after which the vehicle may have restarted
constexpr int kLostMax = 100;
constexpr std::array<std::uint8_t, 5> kBroadcast{0xFF, 0xE7, 0xE7, 0xE7, 0xE7};

/// True for packets of which only the newest matters: external poses and set-points.
bool is_stream(const crtp::Encoded& packet) {
  const auto port = static_cast<crtp::Port>(packet.data[0] >> 4U);
  const unsigned channel = packet.data[0] & 3U;
  return (port == crtp::Port::kSetpoint && channel == 0) ||
         (port == crtp::Port::kLocalisation && packet.size > 2);
}

bool is_same_stream(const crtp::Encoded& a, const crtp::Encoded& b) {
  return is_stream(a) && is_stream(b) && (a.data[0] & 0xF3U) == (b.data[0] & 0xF3U);
}

}  // namespace

void RadioLink::write(std::span<const std::uint8_t> packet, Time now) {
  if (packet.empty() || packet.size() > crtp::kPacketMax) {
    ++counts_.dropped;
    return;
  }
  Waiting fresh{{}, now, false};
  std::ranges::copy(packet, fresh.packet.data.begin());
  fresh.packet.size = packet.size();
  // Keeps the order with other packets, because "set-points end" must follow the last set-point.
  if (!queue_.empty() && is_same_stream(queue_.back().packet, fresh.packet)) {
    queue_.back() = fresh;
    return;
  }
  if (queue_.size() >= kQueueMax) {
    queue_.pop_front();
    ++counts_.dropped;
  }
  queue_.push_back(fresh);
}

std::optional<std::vector<std::uint8_t>> RadioLink::read() {
  if (received_.empty()) {
    return std::nullopt;
  }
  std::vector<std::uint8_t> out = std::move(received_.front());
  received_.pop_front();
  return out;
}

RadioLink::Waiting RadioLink::without_content(Time now) {
  Waiting out{{}, now, true};
  out.packet.data[0] = crtp::kNullHeader;
  out.packet.size = 1;
  return out;
}

crtp::Encoded RadioLink::next(Time now) {
  crtp::Encoded out;
  is_asking_ = !is_safe_ && safe_link_tries_ < kSafeLinkTries;
  if (is_asking_) {
    ++safe_link_tries_;
    std::ranges::copy(kSafeLinkRequest, out.data.begin());
    out.size = kSafeLinkRequest.size();
    return out;
  }
  if (current_ && current_->is_empty && !is_safe_) {
    current_.reset();
  }
  if (!current_) {
    while (!queue_.empty() && is_stream(queue_.front().packet) &&
           now - queue_.front().since > kAgeMax) {
      queue_.pop_front();
      ++counts_.dropped;
    }
    if (!queue_.empty()) {
      current_ = queue_.front();
      queue_.pop_front();
      ++counts_.sent;
    }
  }
  if (current_ && is_stream(current_->packet) && now - current_->since > kAgeMax) {
    // The vehicle may have received the packet although its acknowledgement was lost. A packet
    // without content therefore uses up its number.
    current_ = without_content(now);
    ++counts_.dropped;
  }
  if (!current_) {
    // A packet without content also uses up a number, so it is repeated like any other packet.
    current_ = without_content(now);
  }
  out = current_->packet;
  if (is_safe_) {
    out.data[0] =
        static_cast<std::uint8_t>((out.data[0] & ~unsigned{kNumberBits}) | up_ << 3U | down_ << 2U);
  }
  return out;
}

void RadioLink::answer(std::span<const std::uint8_t> bytes, Time now) {
  const bool is_acknowledged = !bytes.empty() && (bytes[0] & kAcknowledged) != 0;
  counts_.retries += bytes.empty() ? 0 : bytes[0] >> 4U;
  if (!is_acknowledged) {
    ++counts_.lost;
    if (++lost_in_row_ >= kLostMax) {
      lost_in_row_ = 0;
      is_safe_ = false;
      safe_link_tries_ = 0;
      up_ = down_ = 0;
    }
    return;
  }
  lost_in_row_ = 0;
  const std::span<const std::uint8_t> payload = bytes.subspan(1);
  if (is_asking_) {
    if (std::ranges::equal(payload, kSafeLinkRequest)) {
      is_safe_ = true;
      up_ = down_ = 0;
    }
    return;
  }
  if (current_ && !current_->is_empty) {
    latency_ = now - current_->since;
  }
  current_.reset();
  if (is_safe_) {
    up_ ^= 1U;
    if (payload.empty() || (payload[0] >> 2U & 1U) != down_) {
      return;
    }
    down_ ^= 1U;
  }
  if (payload.empty() || payload.size() > crtp::kPacketMax) {
    return;
  }
  // Packets without content have port 15 and channel 3.
  if ((payload[0] & 0xF3U) != 0xF3U) {
    if (received_.size() >= kQueueMax) {
      ++counts_.dropped;
      return;
    }
    ++counts_.received;
    received_.emplace_back(payload.begin(), payload.end());
  } else if (received_.empty()) {
    received_.push_back({crtp::kNullHeader});  // shows that the vehicle answers
  }
}

bool RadioDongle::fail() {
  usb_->close();
  tuned_.reset();
  return false;
}

bool RadioDongle::open(Time now) {
  if (usb_->is_open()) {
    return true;
  }
  if (tried_at_ && now - *tried_at_ < kReopen) {
    return false;
  }
  tried_at_ = now;
  tuned_.reset();
  if (!usb_->open()) {
    return false;
  }
  constexpr std::uint16_t kFullPower = 3;
  constexpr std::uint16_t kRetries = 3;
  constexpr std::uint16_t kDelayFor32Bytes = 0x80 | 32;
  const bool is_ready = usb_->control(radio_request::kCarrier, 0, {}) &&
                        usb_->control(radio_request::kPower, kFullPower, {}) &&
                        usb_->control(radio_request::kRetries, kRetries, {}) &&
                        usb_->control(radio_request::kRetryDelay, kDelayFor32Bytes, {}) &&
                        usb_->control(radio_request::kAcknowledge, 1, {});
  if (!is_ready) {
    return fail();
  }
  has_acknowledgement_ = true;
  ++opened_;
  return true;
}

// Sends only the settings that have changed.
bool RadioDongle::tune(const crtp::RadioAddress& address, bool has_acknowledgement) {
  const auto request = [this](std::uint8_t number, unsigned value) {
    return usb_->control(number, static_cast<std::uint16_t>(value), {});
  };
  const bool is_new = !tuned_;
  if ((is_new || tuned_->channel != address.channel) &&
      !request(radio_request::kChannel, static_cast<unsigned>(address.channel))) {
    return fail();
  }
  if ((is_new || tuned_->rate != address.rate) &&
      !request(radio_request::kDataRate, static_cast<unsigned>(address.rate))) {
    return fail();
  }
  if ((is_new || tuned_->address != address.address) &&
      !usb_->control(radio_request::kAddress, 0, address.address)) {
    return fail();
  }
  if (has_acknowledgement != has_acknowledgement_ &&
      !request(radio_request::kAcknowledge, has_acknowledgement ? 1U : 0U)) {
    return fail();
  }
  tuned_ = address;
  has_acknowledgement_ = has_acknowledgement;
  return true;
}

bool RadioDongle::exchange(Time now) {
  if (links_.empty() || !open(now)) {
    return false;
  }
  RadioLink& link = *links_[turn_++ % links_.size()];
  if (!tune(link.address(), true)) {
    return false;
  }
  const crtp::Encoded packet = link.next(now);
  std::array<std::uint8_t, 64> buffer{};
  if (!usb_->write(packet.bytes())) {
    link.answer({}, now);
    return fail();
  }
  const auto got = usb_->read(buffer);
  link.answer(std::span(buffer).first(got.value_or(0)), now);
  return got ? true : fail();
}

bool RadioDongle::broadcast(const crtp::RadioAddress& on, std::span<const std::uint8_t> packet) {
  if (!usb_->is_open()) {
    return false;
  }
  crtp::RadioAddress to = on;
  to.address = kBroadcast;
  return tune(to, false) && (usb_->write(packet) || fail());
}

}  // namespace vantage::drivers
