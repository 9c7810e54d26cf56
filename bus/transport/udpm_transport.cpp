#include "bus/transport/udpm_transport.hpp"

#include <algorithm>
#include <utility>

#include "bus/transport/channel_filter.hpp"
#include "bus/transport/channel_pattern.hpp"
#include "core/check.hpp"
#include "core/deadline.hpp"

namespace vantage::bus::udpm {
namespace {

constexpr int kMessagesPerHandle = 4096;
constexpr int kDatagramsPerTaking = 256;         // limit of one read; a flood cannot delay handlers
constexpr std::int64_t kOvertimeNs = 5'000'000;  // ns; time allowed beyond the caller's timeout
constexpr std::int64_t kTakePeriodNs = 100'000;  // ns; longest time between reads from the kernel
constexpr std::size_t kQueuedOverheadBytes = 128;

std::size_t cost_of(const AssembledMessage& message) {
  return message.payload.size() + kQueuedOverheadBytes;
}

ReassemblyLimits limits_for(std::size_t message_bytes_max) {
  ReassemblyLimits limits;
  limits.message_bytes_max = message_bytes_max;
  limits.source_bytes_max = std::max(limits.source_bytes_max, 2 * message_bytes_max);
  limits.total_bytes_max = std::max(limits.total_bytes_max, 4 * message_bytes_max);
  return limits;
}

/// Guard that sets the flag and resets it on destruction, even when a handler throws.
class Handling {
 public:
  explicit Handling(bool& flag) : flag_(flag) { flag_ = true; }
  ~Handling() { flag_ = false; }
  Handling(const Handling&) = delete;
  Handling& operator=(const Handling&) = delete;
  Handling(Handling&&) = delete;
  Handling& operator=(Handling&&) = delete;

 private:
  bool& flag_;
};

}  // namespace

UdpmTransport::UdpmTransport(const UdpmAddress& address, ReportNetwork report)
    : message_bytes_max_(static_cast<std::size_t>(address.message_bytes_max)),
      receive_buffer_requested_bytes_(address.recv_buf_bytes),
      arrived_bytes_max_(
          static_cast<std::size_t>(std::max(address.recv_buf_bytes, address.message_bytes_max))),
      socket_(address, report ? MulticastSocket::Absence::kWait : MulticastSocket::Absence::kError),
      report_(std::move(report)),
      reassembler_(limits_for(message_bytes_max_)) {
  if (!address.peers.empty()) {
    relay_.emplace(address);
  }
  keep_network();
}

// Reports the loss and return of the network. A loss that ends before the next attempt to join is
// not reported.
void UdpmTransport::keep_network() {
  const bool is_up = socket_.keep_joined(monotonic_ns());
  if (relay_) {
    relay_->keep(monotonic_ns());
  }
  if (report_ && is_up == is_loss_reported_) {
    is_loss_reported_ = !is_up;
    report_(is_up ? "the network is back" : socket_.fault() + ": waiting for the network");
  }
}

void UdpmTransport::reset_filter() {
  if (is_filter_current_) {
    socket_.set_filter({});
    is_filter_current_ = false;
  }
}

void UdpmTransport::apply_filter() {
  if (is_filter_current_) {
    return;
  }
  std::vector<std::string_view> patterns;
  for (const Subscription& each : subscriptions_) {
    if (!each.pattern.empty()) {
      patterns.push_back(each.pattern);
    }
  }
  std::sort(patterns.begin(), patterns.end());
  patterns.erase(std::unique(patterns.begin(), patterns.end()), patterns.end());
  const auto filter = channel_filter(patterns);
  socket_.set_filter(filter ? std::span<const sock_filter>(*filter)
                            : std::span<const sock_filter>());
  is_filter_current_ = true;
}

void UdpmTransport::subscribe(const std::string& channel, Handler handler) {
  reset_filter();
  const auto spare = std::find_if(subscriptions_.begin(), subscriptions_.end(),
                                  [](const Subscription& each) { return each.pattern.empty(); });
  if (spare != subscriptions_.end()) {
    *spare = {channel, std::move(handler)};
  } else {
    subscriptions_.push_back({channel, std::move(handler)});
  }
}

// The entry stays for reuse, because dispatch() may be iterating over the entries.
void UdpmTransport::unsubscribe(const std::string& channel) {
  for (Subscription& each : subscriptions_) {
    if (each.pattern == channel) {
      each = {};
    }
  }
  reset_filter();
}

bool UdpmTransport::publish(const std::string& channel, std::span<const std::uint8_t> bytes) {
  return publish_to(channel, bytes, Reach::kAll);
}

bool UdpmTransport::publish_on_host(const std::string& channel,
                                    std::span<const std::uint8_t> bytes) {
  return publish_to(channel, bytes, Reach::kHost);
}

bool UdpmTransport::send(std::span<const std::uint8_t> head, std::span<const std::uint8_t> payload,
                         Reach reach) {
  const bool is_sent = socket_.send(head, payload, reach == Reach::kHost);
  if (relay_ && reach == Reach::kAll) {
    is_sent_to_peers_ = relay_->send(head, payload) && is_sent_to_peers_;
  }
  return is_sent;
}

bool UdpmTransport::publish_to(const std::string& channel, std::span<const std::uint8_t> bytes,
                               Reach reach) {
  // Refuses messages that receivers of this class would refuse, so that the caller receives an
  // error.
  const bool is_possible = is_channel_name(channel) && bytes.size() <= message_bytes_max_;
  const auto cut = is_possible ? cut_message(channel.size(), bytes.size()) : std::nullopt;
  if (!cut) {
    ++stats_.send_errors;
    return false;
  }
  const std::uint32_t sequence = next_sequence_++;
  is_sent_to_peers_ = true;
  const bool is_sent_here =
      cut->fragments == 1 ? send(PacketHead::of_short(sequence, channel).bytes(), bytes, reach)
                          : send_fragments(channel, bytes, *cut, sequence, reach);
  const bool is_sent = is_sent_here && is_sent_to_peers_;
  ++(is_sent ? stats_.messages_sent : stats_.send_errors);
  return is_sent;
}

bool UdpmTransport::send_fragments(const std::string& channel, std::span<const std::uint8_t> bytes,
                                   const Cut& cut, std::uint32_t sequence, Reach reach) {
  std::size_t offset = 0;
  for (std::size_t i = 0; i < cut.fragments; ++i) {
    const std::size_t size =
        std::min(i == 0 ? cut.first_bytes : kFragmentBytesMax, bytes.size() - offset);
    const PacketHead head = PacketHead::of_fragment(
        sequence, static_cast<std::uint32_t>(bytes.size()), static_cast<std::uint32_t>(offset),
        static_cast<std::uint16_t>(i), static_cast<std::uint16_t>(cut.fragments), channel);
    if (!send(head.bytes(), bytes.subspan(offset, size), reach)) {
      return false;  // the remaining fragments would be useless
    }
    offset += size;
  }
  return true;
}

int UdpmTransport::handle(std::chrono::microseconds timeout) {
  if (is_handling_) {
    throw UsageError("Transport::handle() called from a handler");
  }
  const Handling handling(is_handling_);
  keep_network();
  apply_filter();
  const std::int64_t deadline_ns =
      monotonic_ns() + std::chrono::nanoseconds(std::max(timeout, {})).count();
  int handled = 0;
  while (handled < kMessagesPerHandle) {
    if (arrived_.empty() || monotonic_ns() - taken_at_ns_ > kTakePeriodNs) {
      take_arrived();
    }
    if (arrived_.empty()) {
      const std::int64_t left_ns = deadline_ns - monotonic_ns();
      // Malformed datagrams and channels without a subscription must not end the wait.
      if (handled > 0 || left_ns <= 0 || !socket_.wait(std::chrono::nanoseconds(left_ns))) {
        break;
      }
      continue;
    }
    const AssembledMessage message = std::move(arrived_.front());
    arrived_.pop_front();
    arrived_bytes_ -= cost_of(message);
    ++handled;
    dispatch(message);
    // A flood of messages must not block the caller.
    if (monotonic_ns() - deadline_ns > kOvertimeNs) {
      break;
    }
  }
  reassembler_.expire(monotonic_ns());
  return handled;
}

void UdpmTransport::take_arrived() {
  socket_.begin_receiving();
  for (int i = 0; i < kDatagramsPerTaking; ++i) {
    const auto datagram = socket_.receive();
    if (!datagram) {
      break;
    }
    take(*datagram);
  }
  taken_at_ns_ = monotonic_ns();
}

void UdpmTransport::take(const Datagram& datagram) {
  const std::optional<Packet> packet = parse_packet(datagram.bytes);
  if (!packet) {
    ++stats_.malformed_datagrams;
    return;
  }
  if (!packet->is_fragment) {
    if (is_wanted(packet->channel)) {
      enqueue({std::string(packet->channel),
               {packet->payload.begin(), packet->payload.end()},
               datagram.source});
    }
    return;
  }
  auto message = reassembler_.add(datagram.source, *packet, monotonic_ns());
  if (message && is_wanted(message->channel)) {
    enqueue(std::move(*message));
  }
}

void UdpmTransport::enqueue(AssembledMessage message) {
  arrived_bytes_ += cost_of(message);
  arrived_.push_back(std::move(message));
  while (arrived_bytes_ > arrived_bytes_max_ && arrived_.size() > 1) {
    arrived_bytes_ -= cost_of(arrived_.front());
    arrived_.pop_front();
    ++stats_.queue_overflows;
  }
}

bool UdpmTransport::is_wanted(std::string_view channel) const {
  return std::any_of(subscriptions_.begin(), subscriptions_.end(),
                     [channel](const Subscription& subscription) {
                       return channel_matches(subscription.pattern, channel);
                     });
}

void UdpmTransport::dispatch(const AssembledMessage& message) {
  ++stats_.messages_received;
  Payload payload(message.payload);
  payload.source = message.source;
  for (std::size_t i = 0; i < subscriptions_.size(); ++i) {
    if (channel_matches(subscriptions_[i].pattern, message.channel)) {
      subscriptions_[i].handler(message.channel, payload);
    }
  }
}

TransportStats UdpmTransport::stats() const {
  TransportStats stats = stats_;
  const ReassemblyCounts& fragments = reassembler_.counts();
  stats.malformed_datagrams += fragments.conflicting + (relay_ ? relay_->refused() : 0);
  stats.incomplete_messages = fragments.incomplete;
  stats.oversized_messages = fragments.oversized_messages;
  stats.duplicate_fragments = fragments.duplicates;
  stats.kernel_drops = socket_.kernel_drops();
  stats.network_losses = socket_.network_losses();
  stats.receive_buffer_bytes = socket_.receive_buffer_bytes();
  stats.receive_buffer_short_bytes =
      std::max<std::int64_t>(0, receive_buffer_requested_bytes_ - stats.receive_buffer_bytes);
  return stats;
}

}  // namespace vantage::bus::udpm
