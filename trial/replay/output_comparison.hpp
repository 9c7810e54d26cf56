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

/// Where a replayed output is not the logged one.
struct OutputDifference {
  std::int64_t index = 0;  ///< round of a plan, step of a belief
  Time time{};             ///< what the message is valid for
  std::string member;      ///< "segments[2].speed_mps"; "(bits)" when only the bits differ
  std::string logged;      ///< its value, JSON
  std::string replayed;
  int members_different = 0;
  std::vector<std::string>
      inputs;  ///< what the logged output was made from: "CHANNEL run/sequence"
};

/// Compares what a node said in a flight with what it says of the same inputs: plans by round,
/// beliefs and maps by step, proposals of a local search by round and solution, every byte of the
/// message except who published it when (run id and sequence).
class OutputComparison {
 public:
  /// Messages as they travel, signed or not: the payload is compared. Others than these are counted
  /// as unreadable.
  void add_logged(std::span<const std::uint8_t> signed_message);
  void add_replayed(std::span<const std::uint8_t> signed_message);
  /// Whether the log has a counterpart of it, so far.
  [[nodiscard]] bool has_logged(std::span<const std::uint8_t> signed_message) const;

  [[nodiscard]] std::int64_t logged() const { return logged_count_; }
  [[nodiscard]] std::int64_t replayed() const { return replayed_; }
  [[nodiscard]] std::int64_t different() const { return different_; }
  /// Replayed outputs that the log has no counterpart of.
  [[nodiscard]] std::int64_t unexpected() const { return unexpected_; }
  [[nodiscard]] std::int64_t unreadable() const { return unreadable_; }
  /// The one with the least index.
  [[nodiscard]] const std::optional<OutputDifference>& first_difference() const { return first_; }
  [[nodiscard]] bool is_exact() const {
    return replayed_ > 0 && different_ == 0 && unexpected_ == 0 && unreadable_ == 0;
  }

 private:
  using Bytes = std::vector<std::uint8_t>;
  struct Key {
    std::uint64_t type = 0;  ///< fingerprint
    std::int64_t index = 0;
    std::int64_t solution = 0;  ///< fingerprint of the one that a proposal is of, else 0
    friend auto operator<=>(const Key&, const Key&) = default;
  };
  static std::optional<Key> key_of(std::span<const std::uint8_t> message);
  std::map<Key, Bytes> logged_;  ///< newest of that key (a node may be started anew)
  std::int64_t logged_count_ = 0;
  std::int64_t replayed_ = 0;
  std::int64_t different_ = 0;
  std::int64_t unexpected_ = 0;
  std::int64_t unreadable_ = 0;
  std::optional<OutputDifference> first_;
};

/// Lines that say it, for people.
std::vector<std::string> describe(const OutputDifference& difference);

}  // namespace vantage::trial
