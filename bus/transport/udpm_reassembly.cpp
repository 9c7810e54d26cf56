#include "bus/transport/udpm_reassembly.hpp"

#include <algorithm>
#include <utility>

namespace vantage::bus::udpm {
namespace {

/// Overhead of allocator and containers that is added to the memory of each stored message and
/// piece, bytes.
constexpr std::size_t kMessageOverheadBytes = 256;
// Twice sizeof(Piece), which is 64, because the vector grows by doubling.
constexpr std::size_t kPieceOverheadBytes = 128;

/// 1 / kSparedShare of the messages, those with the newest fragments, are not evicted.
constexpr std::size_t kSparedShare = 8;

}  // namespace

Reassembler::Reassembler(const ReassemblyLimits& limits) : limits_(limits) {}

// Long function: it checks a fragment against all limits in order. Each check may refuse it.
std::optional<AssembledMessage> Reassembler::add(std::uint64_t source, const Packet& packet,
                                                 std::int64_t now_ns) {
  if (packet.message_bytes > limits_.message_bytes_max) {
    note_oversized(packet);
    return std::nullopt;
  }
  const Identity identity{source, packet.sequence, packet.message_bytes, packet.fragment_count};
  if (is_finished(identity, now_ns)) {
    ++counts_.duplicates;
    return std::nullopt;
  }
  auto partial = find(identity);
  const bool is_new = partial == partials_.end();
  if (!is_new && partial->has_number[packet.fragment_number]) {
    const Piece& held =
        *std::find_if(partial->pieces.begin(), partial->pieces.end(),
                      [&](const Piece& piece) { return piece.number == packet.fragment_number; });
    const bool is_same = held.offset == packet.fragment_offset &&
                         std::equal(held.bytes.begin(), held.bytes.end(), packet.payload.begin(),
                                    packet.payload.end());
    ++(is_same ? counts_.duplicates : counts_.conflicting);
    return std::nullopt;
  }
  counts_.conflicting += is_new && is_disputed(identity) ? 1 : 0;
  const std::size_t cost =
      packet.payload.size() + kPieceOverheadBytes +
      (is_new ? kMessageOverheadBytes + std::size_t{packet.fragment_count} / 8 : 0);
  if (!make_room(source, cost, is_new ? nullptr : &*partial)) {
    if (is_new) {
      ++counts_.incomplete;
    } else {
      drop(partial);
    }
    return std::nullopt;
  }
  if (is_new) {
    partials_.emplace_back();
    partial = std::prev(partials_.end());
    partial->identity = identity;
    partial->has_number.resize(packet.fragment_count);
  }
  partials_.splice(partials_.end(), partials_, partial);
  partial->newest_ns = now_ns;
  partial->has_number[packet.fragment_number] = true;
  partial->pieces.push_back(
      {packet.fragment_number, packet.fragment_offset,
       std::vector<std::uint8_t>(packet.payload.begin(), packet.payload.end())});
  partial->payload_bytes += packet.payload.size();
  partial->kept_bytes += cost;
  bytes_kept_ += cost;
  if (packet.fragment_number == 0) {
    partial->channel = packet.channel;
  }
  if (partial->pieces.size() < partial->has_number.size()) {
    return std::nullopt;
  }

  std::optional<AssembledMessage> message = assemble(*partial);
  if (message) {
    ++counts_.completed;
    const Finished finished{identity, now_ns};
    if (finished_.size() < kFinishedKept) {
      finished_.push_back(finished);
    } else {
      finished_[finished_next_] = finished;
      finished_next_ = (finished_next_ + 1) % kFinishedKept;
    }
  } else {
    ++counts_.conflicting;
  }
  bytes_kept_ -= partial->kept_bytes;
  partials_.erase(partial);
  return message;
}

// Only the first fragment of a message carries its channel.
void Reassembler::note_oversized(const Packet& packet) {
  ++counts_.oversized;
  if (packet.fragment_number != 0) {
    return;
  }
  ++counts_.oversized_messages;
  auto channel = oversized_.find(packet.channel);
  if (channel == oversized_.end() && oversized_.size() < kOversizedKept) {
    channel = oversized_.emplace(packet.channel, OversizedChannel{}).first;
  }
  if (channel != oversized_.end()) {
    ++channel->second.messages;
    channel->second.bytes_max = std::max(channel->second.bytes_max, packet.message_bytes);
  }
}

void Reassembler::expire(std::int64_t now_ns) {
  for (auto partial = partials_.begin(); partial != partials_.end();) {
    const auto next = std::next(partial);
    if (now_ns - partial->newest_ns > limits_.age_max_ns) {
      drop(partial);
    }
    partial = next;
  }
}

Reassembler::Partials::iterator Reassembler::find(const Identity& identity) {
  return std::find_if(partials_.begin(), partials_.end(),
                      [&](const Partial& partial) { return partial.identity == identity; });
}

bool Reassembler::is_disputed(const Identity& identity) const {
  return std::any_of(partials_.begin(), partials_.end(), [&](const Partial& partial) {
    return partial.identity.source == identity.source &&
           partial.identity.sequence == identity.sequence;
  });
}

bool Reassembler::is_finished(const Identity& identity, std::int64_t now_ns) const {
  return std::any_of(finished_.begin(), finished_.end(), [&](const Finished& finished) {
    return finished.identity == identity && now_ns - finished.time_ns <= limits_.age_max_ns;
  });
}

// Evicts one message of `source`; nullopt: of any source.
bool Reassembler::evict(const std::optional<std::uint64_t>& source, const Partial* keep) {
  const std::size_t spared = std::min(limits_.messages_max / kSparedShare, partials_.size());
  auto least = partials_.end();
  std::size_t index = 0;
  for (auto each = partials_.begin(); each != partials_.end(); ++each, ++index) {
    // Does not evict the newest messages, which are probably still arriving, if there are others.
    if (least != partials_.end() && index >= partials_.size() - spared) {
      break;
    }
    if (&*each == keep || (source && each->identity.source != *source)) {
      continue;
    }
    if (least == partials_.end() || each->payload_bytes < least->payload_bytes) {
      least = each;
    }
  }
  if (least == partials_.end()) {
    return false;
  }
  drop(least);
  return true;
}

bool Reassembler::make_room(std::uint64_t source, std::size_t bytes, const Partial* keep) {
  std::size_t own_bytes = 0;
  for (const Partial& partial : partials_) {
    own_bytes += partial.identity.source == source ? partial.kept_bytes : 0;
  }
  while (own_bytes + bytes > limits_.source_bytes_max) {
    const std::size_t kept_before = bytes_kept_;
    if (!evict(source, keep)) {
      return false;
    }
    own_bytes -= kept_before - bytes_kept_;
  }
  while (bytes_kept_ + bytes > limits_.total_bytes_max ||
         (keep == nullptr && partials_.size() >= limits_.messages_max)) {
    if (!evict(std::nullopt, keep)) {
      return false;
    }
  }
  return true;
}

void Reassembler::drop(Partials::iterator partial) {
  ++counts_.incomplete;
  bytes_kept_ -= partial->kept_bytes;
  partials_.erase(partial);
}

// Assembles the message from its pieces, which must cover it in the order of their numbers without
// gap or overlap.
std::optional<AssembledMessage> Reassembler::assemble(Partial& partial) {
  std::sort(partial.pieces.begin(), partial.pieces.end(),
            [](const Piece& a, const Piece& b) { return a.number < b.number; });
  AssembledMessage message{std::move(partial.channel), {}, partial.identity.source};
  message.payload.reserve(partial.identity.message_bytes);
  for (const Piece& piece : partial.pieces) {
    if (piece.offset != message.payload.size()) {
      return std::nullopt;
    }
    message.payload.insert(message.payload.end(), piece.bytes.begin(), piece.bytes.end());
  }
  if (message.payload.size() != partial.identity.message_bytes) {
    return std::nullopt;
  }
  return message;
}

}  // namespace vantage::bus::udpm
