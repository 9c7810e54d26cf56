#pragma once

#include <cstdint>
#include <vector>

#include "core/time.hpp"
#include "estimator/posterior/posterior_moments.hpp"
#include "estimator/tracks/labelled/association.hpp"
#include "estimator/tracks/labelled/mixture.hpp"
#include "estimator/tracks/observation.hpp"
#include "models/exchange/messages.hpp"
#include "models/sensor/clutter.hpp"
#include "models/world/world.hpp"
#include "scenario/scenario.hpp"

namespace vantage::estimator {

/// Tracking methods for detections without target ids.
enum class Tracker {
  /// Labelled multi-Bernoulli filter. Each track has an existence probability that every
  /// observation updates, and a mixture over its possible associations. A detection that no track
  /// explains starts a track with the probability that it is not a false alarm.
  kLabelled,
  kJpda,     ///< joint probabilistic data association: one Gaussian per track, hit counts
  kNearest,  ///< global nearest neighbour: uses only the most likely association, and hit counts
};

/// Existence probability from which a track is confirmed.
inline constexpr double kConfirmed = 0.5;

struct MultiTargetSpec {
  scenario::EstimatorSpec estimator;
  models::World world;
  models::DetectionModel detection;  ///< detection model of update() without this argument
  double step_s = 0.5;
  int targets = 5;  ///< number of targets in the world, found or not
  /// maximum number of tracks, greater than `targets` because some tracks are false
  int tracks_max = 10;
  /// maximum number of detections per observation; further detections are not used
  int detections_max = 32;
  int components_max = 6;  ///< maximum number of Gaussians per track; 1 for kJpda and kNearest
  Tracker tracker = Tracker::kLabelled;
  /// Gate, in σ: a detection farther than this from a track's prediction is not associated with it.
  double gate_sigma = 4.0;
};

/// A possible target: existence probability and mixture.
struct LabelledTrack {
  double existence = 0.0;  ///< probability of existence; 0: unused slot
  Mixture mixture;         ///< state if the target exists; weights sum to 1, the heaviest first
  Time last_seen{};  ///< time of the newest observation that detected it with probability > 0.5
  int label = 0;     ///< label of the detection that started the track, see first_label()
  int hits = 0;      ///< number of observations that detected the target
  /// Number of observations since the last hit in which a detection was expected but missing.
  int misses = 0;
};

/// Counts of events since construction.
struct MultiTargetCounters {
  std::int64_t births = 0;
  std::int64_t deaths = 0;
  std::int64_t beyond_capacity = 0;  ///< detections or births beyond the capacity
  std::int64_t malformed = 0;        ///< detections of wrong dimension or with no possible position
};

/// Multi-target filter for detections without target ids, with false alarms.
///
/// Track i has existence probability r_i and belief p_i. For one observation, track i has the
/// weight w_i0 = 1 − r_i p_D P_i(in view) for no detection, and w_ij = r_i p_D p(z_j | p_i) / λ_j
/// for detection j. λ_j is the intensity of other detections: false alarms (uniform over the area
/// in view) and targets without a track (uniform over the world; their number is `targets` minus
/// the sum of r_i). The joint association probabilities β (class Association) update existence: r_i
/// ← Σ_j β_ij + β_i0 r_i (1 − p_D P_i) / w_i0, conditioned on at most `targets` targets. Belief i
/// becomes the reduced mixture of its posteriors for each detection and for none. Detection j
/// starts a track in proportion to 1 − Σ_i β_ij. For the weights, a detection is the Gaussian of
/// its position without prior. Posteriors of relevant weight are computed by measure(), missed
/// detections by missed_detection() and motion by propagate().
///
/// kLabelled first assigns each detection to at most one track, by the most likely association.
/// Without this, two lost tracks would permanently share one target that is detected again. A
/// detection that remains unassigned can belong to any track.
///
/// The caller owns the tracks; the members are scratch only. The order of detections does not
/// change the result. Nothing is allocated. Requires planar targets and a sensor that measures
/// position (not range or bearing alone).
/// Source: Reuter, Vo, Vo, Dietmayer, The labeled multi-Bernoulli filter (2014); Williams, Marginal
/// multi-Bernoulli filters: RFS derivation of MHT, JIPDA and association-based MeMBer (2015); JPDA:
/// Bar-Shalom, Fortmann, Scheffe (1980).
class MultiTargetFilter {
 public:
  /// @throws UsageError for an invalid spec.
  explicit MultiTargetFilter(MultiTargetSpec spec);

  /// Returns tracks_max tracks of existence 0.
  [[nodiscard]] std::vector<LabelledTrack> no_tracks() const;
  /// Predicts the tracks from `from` to `to` ≥ `from`.
  void propagate(std::vector<LabelledTrack>& tracks, Time from, Time to);
  /// Updates the tracks with one observation made at the instant of the tracks. The labels of new
  /// tracks begin with first_label() of the observation, in an order that depends only on the
  /// content of the detections.
  /// Precondition: the size of `tracks` is that of no_tracks().
  void update(std::vector<LabelledTrack>& tracks, const Observation& observation,
              const models::SensorModel& sensor, const models::DetectionModel& detection);
  /// Calls update() above with the detection model of the spec.
  void update(std::vector<LabelledTrack>& tracks, const Observation& observation,
              const models::SensorModel& sensor) {
    update(tracks, observation, sensor, spec_.detection);
  }
  /// True if the track is to be reported: existence of at least 0.5 (kLabelled), or at least three
  /// hits (kJpda, kNearest).
  [[nodiscard]] bool is_confirmed(const LabelledTrack& track) const;

  [[nodiscard]] const MultiTargetSpec& spec() const { return spec_; }
  [[nodiscard]] const MultiTargetCounters& counters() const { return counters_; }

 private:
  /// Input of one update: the observation, its sensor and the expected rates of detections.
  struct Input;
  /// Fills seen_ and found_ with the usable detections, in an order that depends only on these
  /// detections.
  void sort_detections(const Input& input);
  void expect_misses(const std::vector<LabelledTrack>& tracks, const Input& input);
  void weigh(const std::vector<LabelledTrack>& tracks, const Input& input);
  /// Assigns each detection to the track that has it in the most likely association.
  void share_out(bool is_exclusive);
  void mix(std::size_t i, LabelledTrack& track, const Input& input);
  /// Returns the posterior of a component's belief given detection j.
  [[nodiscard]] models::Gaussian posterior_given(const models::Gaussian& belief, std::size_t j,
                                                 double weight, const Input& input) const;
  void count_hits(std::vector<LabelledTrack>& tracks, const Input& input);
  /// Conditions the existence probabilities on at most spec_.targets targets.
  void keep_to_number(std::vector<LabelledTrack>& tracks);
  void start_tracks(std::vector<LabelledTrack>& tracks, const Input& input);
  void delete_tracks(std::vector<LabelledTrack>& tracks);
  [[nodiscard]] double existence_of(const LabelledTrack& track) const;
  [[nodiscard]] std::size_t at(std::size_t i, std::size_t k) const;

  MultiTargetSpec spec_;
  MultiTargetCounters counters_;
  double world_area_m2_;
  Association association_;
  // Measurement of each detection, and moments of the position given this measurement alone.
  std::vector<models::Measurement> seen_;
  std::vector<PositionMoments> found_;
  // Belief and weight, by track and component, if the track is not detected.
  std::vector<Component> missed_;
  std::vector<double> missed_probability_;  ///< probability of no detection, by track
  std::vector<double> fit_per_m2_;  ///< density of detection j given a component, by at(i, k), j
  Mixture mixture_;                 ///< a track's posterior before reduction
  std::vector<double> before_;      ///< P(n of the tracks before i exist), by i and n
  std::vector<double> after_;       ///< P(at most n of the tracks from i on exist), by i and n
};

}  // namespace vantage::estimator
