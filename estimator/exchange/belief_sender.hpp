#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/time.hpp"
#include "estimator/tracks/filter_spec.hpp"
#include "models/exchange/compact_belief.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::estimator {

/// Selects the parts of a robot's belief that teammates need most, for a network with a budget.
///
/// For each target, the sender keeps the beliefs that teammates can be assumed to have: the last
/// two beliefs that it sent and the best belief that it received, all predicted to the present. The
/// expected information gain of a target is the weighted mean of its gains over these beliefs. The
/// weights are the probabilities that teammates have each of them. Targets are sent in the order of
/// this gain. A target that was not sent for kWholePeriod is sent next, so a teammate that missed
/// messages knows all targets after that time. When a teammate comes into range, all targets are
/// sent again.
///
/// A cell of the visibility grid is sent if it was seen at least kCellStep after the time that
/// teammates know. The record of what teammates know is deleted row by row, so that every cell is
/// sent again within kGridPeriodSteps calls.
///
/// Copies are independent. The same calls give the same result. The cost of a call is linear in the
/// number of targets, of cells, and of received messages.
class BeliefSender {
 public:
  static constexpr Duration kWholePeriod{10'000'000};
  static constexpr Duration kSilenceMax{5'000'000};
  static constexpr Duration kCellStep{2'000'000};
  static constexpr int kGridPeriodSteps = 60;
  static constexpr double kGainMin_nats = 0.1;  ///< smaller gains are not sent
  /// Smallest payload that is used. The fixed fields would be most of a smaller message.
  static constexpr std::size_t kPayloadMin = 256;

  explicit BeliefSender(const FilterSpec& spec) : spec_(spec) {}

  /// Uses a belief received from a teammate in range.
  void receive(const models::RobotBelief& belief);
  /// Returns the message to send at the step of `own`, with at most `payload_max` bytes; nullopt if
  /// nothing is worth sending. The result is considered sent. Stamp: only the time is set.
  /// @param observed ids of the targets that were observed in this step; teammates in range have
  ///                 received these observations, too, unless they were lost
  std::optional<models::CompactBelief> select(const models::RobotBelief& own,
                                              std::span<const int> observed,
                                              std::size_t payload_max);
  /// Returns the number of targets whose beliefs could not be rounded to the compact format.
  [[nodiscard]] std::int64_t unsendable() const { return unsendable_; }

 private:
  /// Beliefs of one target that teammates can be assumed to have.
  struct Known {
    models::Information sent;      ///< last sent belief; empty matrix: none
    models::Information previous;  ///< belief sent before `sent`; empty matrix: none
    models::Information received;  ///< best received belief; empty matrix: none
    Time last_seen{};              ///< time of the newest measurement in these beliefs
    Time sent_at{};
    bool is_present = false;  ///< true: the robot's current belief contains the target
  };
  struct Candidate {
    double gain = 0.0;
    std::size_t index = 0;  ///< index of the target in the robot's belief
  };
  void predict(Time now);
  /// Moves the record of the cells that teammates know to the grid of `own`, and deletes some rows
  /// of the record.
  void follow_grid(const models::RobotBelief& own);
  /// Returns the targets that are worth sending, by descending gain.
  std::vector<Candidate> candidates(const models::RobotBelief& own, std::span<const int> observed);
  [[nodiscard]] double gain_of(const models::TargetBelief& own, const Known& known,
                               bool is_observed, Time now) const;
  [[nodiscard]] double gain_over(const models::Gaussian& own,
                                 const models::Information& theirs) const;
  void add_targets(const models::RobotBelief& own, std::span<const Candidate> order,
                   std::size_t bytes_max, models::CompactBelief& out);
  void add_cells(const models::RobotBelief& own, std::size_t bytes_max, models::CompactBelief& out);

  FilterSpec spec_;
  std::map<int, Known> known_;
  std::map<std::string, Time> heard_;  ///< time of the newest message, by teammate
  Time now_{};                         ///< time of the beliefs in known_
  models::GridGeometry grid_;
  std::vector<std::int64_t> cells_utime_;  ///< observation time that teammates know, by cell
  int next_row_ = 0;                       ///< row at which the next message's cells begin
  int forget_row_ = 0;
  Time sent_at_{};
  std::int64_t unsendable_ = 0;
};

}  // namespace vantage::estimator
