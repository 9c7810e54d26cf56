#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "estimator/tracks/labelled/multi_target.hpp"
#include "estimator/tracks/labelled/track_labels.hpp"
#include "estimator/tracks/track_store.hpp"

namespace vantage::estimator {

/// Store of targets without ids: tracks of a MultiTargetFilter, named by labels from kTrackLabelMin
/// on (track_labels.hpp). Robots that have used the same observations have the same tracks, bit for
/// bit. A teammate's belief is reconciled with the robot's tracks, unless it is older than the
/// previous step.
class LabelledTracks : public TrackStore {
 public:
  /// @throws UsageError for a team of more than kLabelledRobots, a neighbourhood, or a model that
  /// MultiTargetFilter refuses.
  explicit LabelledTracks(const FilterSpec& spec);
  [[nodiscard]] std::unique_ptr<TrackStore> clone() const override;

  [[nodiscard]] int detections_reserved() const override { return kLabelledDetections; }
  [[nodiscard]] bool has_one_observation_per_instant() const override { return true; }
  void file(const models::Detection& detection, bool has_right_dimension, Observation& observation,
            FilterCounters& count) const override;

  void start(const Step& step) override;
  void receive(const models::RobotBelief& belief, const Step& step, FilterCounters& count) override;
  void save(int slot) override;
  void restore(int slot) override;

  /// Reconciles the tracks with the beliefs received for the same instant.
  void fuse(const Step& step, FusionPoint point, FilterCounters& count) override;
  void propagate(Time from, Time to, FilterCounters& count) override;
  void confine(FilterCounters& count) override;
  void use(const Observation& observation, const ObservationSource& source,
           FilterCounters& count) override;
  void forget_far(const Eigen::Vector2d& /*position_m*/) override {}

  [[nodiscard]] std::vector<models::TargetBelief> beliefs() const override;
  /// Returns the mixtures of all confirmed tracks.
  [[nodiscard]] std::vector<models::TargetMixture> mixtures() const override;
  void rebase(std::span<const models::TargetBelief> targets, FilterCounters& count) override;
  [[nodiscard]] const Track* find(int /*target_id*/) const override { return nullptr; }

 private:
  struct Record {
    std::vector<LabelledTrack> before;    ///< tracks at `from`
    std::vector<ReceivedLabel> received;  ///< teammates' tracks at `from` or `to`, by teammate
  };

  [[nodiscard]] Record& record(int slot) { return history_[static_cast<std::size_t>(slot)]; }

  MultiTargetFilter filter_;
  models::World free_space_;  ///< free space of the targets' centres
  std::size_t received_max_;  ///< number of tracks that the team can publish
  std::vector<LabelledTrack> tracks_;
  std::vector<Record> history_;
  std::vector<ReceivedLabel> received_;  ///< scratch of fuse()
};

}  // namespace vantage::estimator
