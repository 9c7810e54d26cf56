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

/// Limits on the memory that untrusted senders can make a Reassembler use.
struct ReassemblyLimits {
  std::size_t message_bytes_max = std::size_t{4} << 20U;
  std::size_t source_bytes_max = std::size_t{8} << 20U;  ///< limit per sender
  std::size_t total_bytes_max = std::size_t{32} << 20U;
  std::size_t messages_max = 256;           ///< maximum number of incomplete messages
  std::int64_t age_max_ns = 1'000'000'000;  ///< ns; maximum age of a message's newest fragment
};

struct ReassemblyCounts {
  std::int64_t completed = 0;
  std::int64_t incomplete = 0;          ///< messages discarded because of age or memory limits
  std::int64_t oversized = 0;           ///< refused fragments of messages above the size limit
  std::int64_t oversized_messages = 0;  ///< number of messages above the size limit
  std::int64_t duplicates = 0;          ///< fragments already stored, or of a completed message
  std::int64_t conflicting = 0;  ///< fragments that contradict other fragments of the message
};

/// Messages on one channel that were refused because of their size.
struct OversizedChannel {
  std::int64_t messages = 0;
  std::uint32_t bytes_max = 0;  ///< size of the largest refused message
};

/// A complete message assembled from fragments.
struct AssembledMessage {
  std::string channel;
  std::vector<std::uint8_t> payload;
  std::uint64_t source = 0;  ///< the sender's address and port
};

/// Assembler of fragments that arrive in any order and any number of times.
///
/// Memory is only used for bytes that have arrived, not for sizes that a header announces, so false
/// sizes cost little memory. When the memory is full, the message with the fewest bytes is evicted;
/// among messages of equal size, the oldest. One eighth of the messages, those with the newest
/// fragments, is not evicted. So in a flood of first fragments, or of nearly complete messages, the
/// messages of the flood are evicted rather than honest messages.
///
/// Fragments of different senders are never combined. A sender that forges an address can damage a
/// message only if it also copies the sequence number, size and fragment count of the message. Uses
/// no clock and no socket; times are parameters.
class Reassembler {
 public:
  explicit Reassembler(const ReassemblyLimits& limits = {});

  /// Adds one fragment from `source` (address and port as a number). Returns the message if this
  /// fragment completes it. Precondition: parse_packet() returned `packet`, and packet.is_fragment.
  std::optional<AssembledMessage> add(std::uint64_t source, const Packet& packet,
                                      std::int64_t now_ns);
  /// Discards messages without a new fragment for age_max_ns.
  void expire(std::int64_t now_ns);

  [[nodiscard]] const ReassemblyCounts& counts() const { return counts_; }
  /// Returns the refused messages by channel, for the first kOversizedKept channels.
  [[nodiscard]] const std::map<std::string, OversizedChannel, std::less<>>& oversized() const {
    return oversized_;
  }
  /// Returns the memory used for incomplete messages, overhead included.
  [[nodiscard]] std::size_t bytes_kept() const { return bytes_kept_; }
  [[nodiscard]] std::size_t messages_kept() const { return partials_.size(); }

 private:
  struct Piece {
    std::uint16_t number = 0;
    std::uint32_t offset = 0;
    std::vector<std::uint8_t> bytes;
  };
  /// Header fields that all fragments of a message share.
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
  /// Evicts messages until `bytes` more fit into message `keep` (null: into a new message). Never
  /// evicts `keep`. Returns false when the limits do not permit this.
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
  Partials partials_;  ///< ordered by their newest fragment
  std::size_t bytes_kept_ = 0;
  std::vector<Finished> finished_;  ///< ring buffer of completed messages; detects late duplicates
  std::size_t finished_next_ = 0;
};

}  // namespace vantage::bus::udpm
