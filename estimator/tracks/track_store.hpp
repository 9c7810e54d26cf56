#pragma once

#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "core/time.hpp"
#include "estimator/tracks/filter_spec.hpp"
#include "estimator/tracks/observation.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::estimator {

struct Track;

/// One step of the filter.
struct Step {
  int slot = 0;  ///< place of the step in the history, in [0, FilterSpec::history_steps)
  Time from{};
  Time to{};
  bool is_first = false;  ///< true: the filter has no tracks at `from`
};

/// Point of a step at which received beliefs are fused.
enum class FusionPoint {
  kStart,   ///< instant `from`, before all observations
  kEnd,     ///< instant `to`, before the observations of that instant
  kFinish,  ///< instant `to`, after all observations
};

/// Tracks of all targets, with the history that is needed to repeat past steps. The filter decides
/// which inputs are used at which instant; a store decides how a belief is represented.
///
/// Functions that receive a FilterCounters count dropped inputs in it. Copies are independent. The
/// same calls give the same result.
class TrackStore {
 public:
  TrackStore() = default;
  TrackStore& operator=(const TrackStore&) = delete;
  virtual ~TrackStore() = default;
  [[nodiscard]] virtual std::unique_ptr<TrackStore> clone() const = 0;

  /// Returns the number of detections for which an observation reserves storage.
  [[nodiscard]] virtual int detections_reserved() const = 0;
  /// True if a second observation by a robot at one instant is assumed to be a repetition, also for
  /// this robot's own observations.
  [[nodiscard]] virtual bool has_one_observation_per_instant() const = 0;
  /// Appends a detection to `observation` if the store can use it; otherwise counts it.
  virtual void file(const models::Detection& detection, bool has_right_dimension,
                    Observation& observation, FilterCounters& count) const = 0;

  /// Begins a step. Deletes the beliefs received in the previous step that used the same slot.
  virtual void start(const Step& step) = 0;
  /// Stores a teammate's belief, for fuse().
  virtual void receive(const models::RobotBelief& belief, const Step& step,
                       FilterCounters& count) = 0;
  /// Stores the tracks in a slot of the history.
  virtual void save(int slot) = 0;
  /// Continues from the tracks stored in a slot.
  virtual void restore(int slot) = 0;

  /// Fuses the tracks with the beliefs received in `step` that belong to `point`.
  virtual void fuse(const Step& step, FusionPoint point, FilterCounters& count) = 0;
  /// Predicts the tracks from `from` to `to` ≥ `from`.
  virtual void propagate(Time from, Time to, FilterCounters& count) = 0;
  /// Conditions the beliefs on the free space of the targets' centres.
  virtual void confine(FilterCounters& count) = 0;
  /// Uses an observation made at the instant of the tracks.
  virtual void use(const Observation& observation, const ObservationSource& source,
                   FilterCounters& count) = 0;
  /// Deletes targets farther than FilterSpec::neighbourhood_m from `position_m`.
  virtual void forget_far(const Eigen::Vector2d& position_m) = 0;

  /// Returns the published beliefs, by ascending id.
  [[nodiscard]] virtual std::vector<models::TargetBelief> beliefs() const = 0;
  /// Returns the mixtures of the targets with a belief that is not Gaussian, by ascending id.
  [[nodiscard]] virtual std::vector<models::TargetMixture> mixtures() const = 0;
  /// Replaces all tracks by received beliefs.
  virtual void rebase(std::span<const models::TargetBelief> targets, FilterCounters& count) = 0;
  /// Returns the track of a target; null if the target is unknown or detections have no ids.
  [[nodiscard]] virtual const Track* find(int target_id) const = 0;

 protected:
  TrackStore(const TrackStore&) = default;
};

/// Owner of a store. A copy owns a copy of the store.
class OwnedTracks {
 public:
  explicit OwnedTracks(std::unique_ptr<TrackStore> store) : store_(std::move(store)) {}
  OwnedTracks(const OwnedTracks& other) : store_(other.store_->clone()) {}
  OwnedTracks(OwnedTracks&& other) noexcept = default;
  OwnedTracks& operator=(OwnedTracks other) noexcept {
    store_ = std::move(other.store_);
    return *this;
  }
  ~OwnedTracks() = default;

  TrackStore* operator->() { return store_.get(); }
  const TrackStore* operator->() const { return store_.get(); }

 private:
  std::unique_ptr<TrackStore> store_;
};

}  // namespace vantage::estimator
