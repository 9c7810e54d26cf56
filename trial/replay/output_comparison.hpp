#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/time.hpp"

namespace vantage::trial {

/// First difference between a logged and a replayed output.
struct OutputDifference {
  std::int64_t index = 0;  ///< round of a plan or step of a belief
  Time time{};             ///< time for which the message is valid
  std::string member;      ///< "segments[2].speed_mps"; "(bits)" if only the bits differ
  std::string logged;      ///< logged value as JSON text
  std::string replayed;
  int members_different = 0;
  std::vector<std::string> inputs;  ///< inputs of the logged output: "CHANNEL run/sequence"
};

/// Comparison of a node's logged outputs with the outputs that a replay computes from the same
/// inputs. Plans are matched by round, beliefs and maps by step, proposals of a local search by
/// round and solution. Every byte is compared except the run id and the sequence number.
class OutputComparison {
 public:
  /// Adds an encoded message, signed or not; only its payload is compared. Messages of other types
  /// are counted as unreadable.
  void add_logged(std::span<const std::uint8_t> signed_message);
  void add_replayed(std::span<const std::uint8_t> signed_message);
  /// True if a logged output that was added has the same key (type, index, solution) as the
  /// message.
  [[nodiscard]] bool has_logged(std::span<const std::uint8_t> signed_message) const;

  [[nodiscard]] std::int64_t logged() const { return logged_count_; }
  [[nodiscard]] std::int64_t replayed() const { return replayed_; }
  [[nodiscard]] std::int64_t different() const { return different_; }
  /// Returns the number of replayed outputs without a counterpart in the log.
  [[nodiscard]] std::int64_t unexpected() const { return unexpected_; }
  [[nodiscard]] std::int64_t unreadable() const { return unreadable_; }
  /// Returns the difference with the smallest index; nullopt if there is none.
  [[nodiscard]] const std::optional<OutputDifference>& first_difference() const { return first_; }
  [[nodiscard]] bool is_exact() const {
    return replayed_ > 0 && different_ == 0 && unexpected_ == 0 && unreadable_ == 0;
  }

 private:
  using Bytes = std::vector<std::uint8_t>;
  struct Key {
    std::uint64_t type = 0;  ///< fingerprint of the message type
    std::int64_t index = 0;
    std::int64_t solution = 0;  ///< fingerprint of a proposal's solution, otherwise 0
    friend auto operator<=>(const Key&, const Key&) = default;
  };
  static std::optional<Key> key_of(std::span<const std::uint8_t> message);
  std::map<Key, Bytes> logged_;  ///< newest output per key; a restarted node repeats keys
  std::int64_t logged_count_ = 0;
  std::int64_t replayed_ = 0;
  std::int64_t different_ = 0;
  std::int64_t unexpected_ = 0;
  std::int64_t unreadable_ = 0;
  std::optional<OutputDifference> first_;
};

/// Returns the difference as lines of text.
std::vector<std::string> describe(const OutputDifference& difference);

}  // namespace vantage::trial
