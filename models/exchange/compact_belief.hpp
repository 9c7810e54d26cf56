#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "models/exchange/messages.hpp"

// Beliefs in few bytes, for a network with a budget. Rounding never makes a belief more confident:
// the decoded covariance minus the true covariance, including the shift of the mean, is positive
// semidefinite, and the stated time of a cell is never later than the true time.

namespace vantage::models {

/// Rounded belief of one target: N(mean, D C D), with D = diag(σ) and C a correlation matrix.
struct CompactTarget {
  /// Number of correlations of a state with the largest dimension.
  static constexpr int kCorrelationsMax = kMaxTargetDim * (kMaxTargetDim - 1) / 2;

  int target_id = 0;
  int dim = kMinTargetDim;
  std::array<float, kMaxTargetDim> mean{};
  std::array<std::int16_t, kMaxTargetDim> sigma_code{};  ///< σ = 2^(code/1024)
  /// Entries of C below the diagonal, row by row, in units of 1/32767.
  std::array<std::int16_t, kCorrelationsMax> correlation_code{};
  std::int32_t unseen_ms = 0;  ///< ms; age of the newest measurement, rounded up

  friend bool operator==(const CompactTarget&, const CompactTarget&) = default;
};

/// Parts of one robot's belief (COMPACT_BELIEF_R): some targets and some cells of the grid. Each
/// message can be used without the others. Targets and cells that a message does not contain are
/// unchanged since an earlier message, or follow in a later one.
struct CompactBelief {
  Stamp stamp;
  std::string robot;
  std::int64_t step = 0;  ///< step of the BELIEF_R that contains the exact values
  Viewpoint viewpoint;
  std::vector<CompactTarget> targets;  ///< by ascending target_id
  GridGeometry grid;
  /// Runs of seen cells, see append_run(). Empty: the message has no cells.
  std::vector<std::uint8_t> runs;
};

/// Rounds a target's belief at time `at`. Returns nullopt if the covariance is not positive
/// definite, or a number is out of the format's range.
std::optional<CompactTarget> compact(const TargetBelief& belief, Time at);
/// Returns the rounded belief as a Gaussian; nullopt if it is not a valid belief.
std::optional<Gaussian> expand(const CompactTarget& target);

/// Largest age of a cell that runs can state. Older cells are not sent.
Duration cell_age_max();
/// Returns the code of the smallest representable age that is at least `age`; nullopt for a
/// negative age or above cell_age_max().
std::optional<std::uint8_t> cell_age_code(Duration age);
/// Returns the age that a code stands for: multiples of 0.5 s up to 64 s, then steps of 4.4 %.
Duration cell_age(std::uint8_t code);

/// Appends a run: `skip` cells that the message leaves out, then `length` > 0 cells with the age of
/// `age_code`. Format: skip and length as LEB128 (7 bits per byte, least significant first), then
/// the code.
void append_run(std::vector<std::uint8_t>& runs, int skip, int length, std::uint8_t age_code);

/// True if expand() succeeds. Does not allocate, so that a short message that announces a large
/// grid costs nothing.
[[nodiscard]] bool is_valid(const CompactBelief& compact);
/// Returns the belief that the message contains. Its `last_seen_utime` is empty if the message has
/// no cells; otherwise cells outside all runs are VisibilityGrid::kNeverSeen. Returns nullopt if a
/// target is invalid, ids do not ascend, or runs are malformed, exceed the grid or state times
/// before 1970.
std::optional<RobotBelief> expand(const CompactBelief& compact);

}  // namespace vantage::models
