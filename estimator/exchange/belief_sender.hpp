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
/// expected information gain of a target weighs its gain against these beliefs, because each
/// message may have been lost, and a teammate's message may not have reached all others. Targets
/// are sent in the order of this gain. A target that was not sent for kWholePeriod is sent next, so
/// a teammate that missed messages has all targets after that time. When a teammate appears
/// (again), all targets are sent again.
///
/// Cells of the visibility grid are sent if they were seen kCellStep later than teammates know. The
/// grid is forgotten part by part and thus sent again within kGridPeriodSteps calls.
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
  /// Bytes below which nothing is sent: the fixed part of a message would be most of it.
  static constexpr std::size_t kPayloadMin = 256;

  explicit BeliefSender(const FilterSpec& spec) : spec_(spec) {}

  /// Considers a teammate's belief, of a robot in range.
  void receive(const models::RobotBelief& belief);
  /// Returns the message to send at the step of `own`, with at most `payload_max` bytes; nullopt if
  /// nothing is worth sending. The result is considered sent. Stamp: only the time is set.
  /// @param observed ids of the targets that were observed in this step; teammates in range have
  ///                 received these observations, too, unless they were lost
  std::optional<models::CompactBelief> select(const models::RobotBelief& own,
                                              std::span<const int> observed,
                                              std::size_t payload_max);
  /// Returns the number of targets that could not be rounded.
  [[nodiscard]] std::int64_t unsendable() const { return unsendable_; }

 private:
  /// Beliefs of one target that teammates can be assumed to have.
  struct Known {
    models::Information sent;      ///< last sent belief; empty matrix: none
    models::Information previous;  ///< belief sent before; empty matrix: none
    models::Information received;  ///< best received belief; empty matrix: none
    Time last_seen{};              ///< newest measurement in any of these
    Time sent_at{};
    bool is_present = false;  ///< in the own belief of the present call
  };
  struct Candidate {
    double gain = 0.0;
    std::size_t index = 0;  ///< in the own belief
  };
  void predict(Time now);
  /// Moves the cells that teammates know to the grid of `own`, and forgets some rows.
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
  std::vector<std::int64_t> cells_utime_;  ///< stamps that teammates can be assumed to know
  int next_row_ = 0;                       ///< row at which the next message's cells begin
  int forget_row_ = 0;
  Time sent_at_{};
  std::int64_t unsendable_ = 0;
};

}  // namespace vantage::estimator
