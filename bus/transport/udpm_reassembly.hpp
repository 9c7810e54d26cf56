#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bus/transport/udpm_packet.hpp"

namespace vantage::bus::udpm {

/// Bounds on what strangers can make a Reassembler keep.
struct ReassemblyLimits {
  std::size_t message_bytes_max = std::size_t{4} << 20U;
  std::size_t source_bytes_max = std::size_t{8} << 20U;  ///< kept for one sender
  std::size_t total_bytes_max = std::size_t{32} << 20U;
  std::size_t messages_max = 256;           ///< unfinished ones
  std::int64_t age_max_ns = 1'000'000'000;  ///< since the newest fragment
};

struct ReassemblyCounts {
  std::int64_t completed = 0;
  std::int64_t incomplete = 0;          ///< given up: too old, or for want of room
  std::int64_t oversized = 0;           ///< fragments of messages above the cap, refused
  std::int64_t oversized_messages = 0;  ///< their first fragments
  std::int64_t duplicates = 0;   ///< fragments already there, or of a message already complete
  std::int64_t conflicting = 0;  ///< fragments and messages that contradict others of their number
};

/// Messages on one channel that were refused for their size.
struct OversizedChannel {
  std::int64_t messages = 0;
  std::uint32_t bytes_max = 0;  ///< of the largest
};

/// A whole message put together from fragments.
struct AssembledMessage {
  std::string channel;
  std::vector<std::uint8_t> payload;
  std::uint64_t source = 0;  ///< the sender's address and port
};

/// Puts fragments together, in whatever order and however often they come.
///
/// Only bytes that really arrived are kept, never what a header announces, so that empty claims are
/// cheap. When there is no room, the message of which least has arrived gives way, the oldest such
/// first, but none of the eighth that was added to last: a flood of first fragments displaces
/// itself rather than honest traffic, and so does one of nearly whole messages.
///
/// What one sender says is never mixed with another's. Who speaks in a sender's own name can spoil
/// the one message whose number, size and count he claims, not the others. Pure: no clock (times
/// are handed in), no socket.
class Reassembler {
 public:
  explicit Reassembler(const ReassemblyLimits& limits = {});

  /// Takes one fragment of `source` (an address and port as a number). The message if it is whole
  /// now. Precondition: packet.is_fragment, from parse_packet.
  std::optional<AssembledMessage> add(std::uint64_t source, const Packet& packet,
                                      std::int64_t now_ns);
  /// Gives up messages without a new fragment for age_max_ns.
  void expire(std::int64_t now_ns);

  [[nodiscard]] const ReassemblyCounts& counts() const { return counts_; }
  [[nodiscard]] const ReassemblyLimits& limits() const { return limits_; }
  /// Returns them by channel, for the first kOversizedKept channels.
  [[nodiscard]] const std::map<std::string, OversizedChannel, std::less<>>& oversized() const {
    return oversized_;
  }
  /// Memory held for unfinished messages, book-keeping included.
  [[nodiscard]] std::size_t bytes_kept() const { return bytes_kept_; }
  [[nodiscard]] std::size_t messages_kept() const { return partials_.size(); }

 private:
  struct Piece {
    std::uint16_t number = 0;
    std::uint32_t offset = 0;
    std::vector<std::uint8_t> bytes;
  };
  /// What all fragments of a message say alike.
  struct Identity {
    std::uint64_t source = 0;
    std::uint32_t sequence = 0;
    std::uint32_t message_bytes = 0;
    std::uint16_t fragment_count = 0;
    bool operator==(const Identity&) const = default;
  };
  struct Partial {
    Identity identity;
    std::int64_t newest_ns = 0;
    std::string channel;
    std::vector<bool> has_number;
    std::vector<Piece> pieces;
    std::size_t payload_bytes = 0;
    std::size_t kept_bytes = 0;
  };
  struct Finished {
    Identity identity;
    std::int64_t time_ns = 0;
  };
  using Partials = std::list<Partial>;

  Partials::iterator find(const Identity& identity);
  [[nodiscard]] bool is_disputed(const Identity& identity) const;
  [[nodiscard]] bool is_finished(const Identity& identity, std::int64_t now_ns) const;
  /// Evicts until `bytes` more fit into message `keep` (null: into a new one), never `keep` itself;
  /// false when that cannot be.
  bool make_room(std::uint64_t source, std::size_t bytes, const Partial* keep);
  bool evict(const std::optional<std::uint64_t>& source, const Partial* keep);
  void drop(Partials::iterator partial);
  static std::optional<AssembledMessage> assemble(Partial& partial);

  static constexpr std::size_t kFinishedKept = 256;
  static constexpr std::size_t kOversizedKept = 64;

  void note_oversized(const Packet& packet);

  ReassemblyLimits limits_;
  ReassemblyCounts counts_;
  std::map<std::string, OversizedChannel, std::less<>> oversized_;
  Partials partials_;  ///< in the order of their newest fragments
  std::size_t bytes_kept_ = 0;
  std::vector<Finished> finished_;  ///< a ring: late duplicates must not begin a message anew
  std::size_t finished_next_ = 0;
};

}  // namespace vantage::bus::udpm
