#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/time.hpp"
#include "estimator/association.hpp"
#include "estimator/mixture.hpp"
#include "estimator/posterior_moments.hpp"
#include "models/exchange/messages.hpp"
#include "models/sensor/clutter.hpp"
#include "models/world/world.hpp"
#include "scenario/scenario.hpp"

namespace vantage::estimator {

/// How looks without ids become tracks.
enum class Tracker {
  /// Labelled multi-Bernoulli: each track exists with a probability that every look changes, and
  /// its belief is a mixture of what may have been seen; what no track explains is born with the
  /// probability that it is no false alarm.
  kLabelled,
  kJpda,     ///< joint probabilistic data association: one Gaussian; tracks live by counts of hits
  kNearest,  ///< global nearest neighbour: the likeliest association alone; tracks live by counts
};

struct MultiTargetSpec {
  scenario::EstimatorSpec estimator;
  models::World world;
  models::DetectionModel detection;  ///< of looks that do not say theirs
  double step_s = 0.5;
  int targets = 5;          ///< how many there are in the world, found or not
  int tracks_max = 10;      ///< more than targets: some are in doubt
  int detections_max = 32;  ///< of one look; the rest is not used
  int components_max = 6;   ///< of a track's mixture; with kJpda and kNearest 1
  Tracker tracker = Tracker::kLabelled;
  double gate_sigma = 4.0;  ///< a detection farther than this from what was expected is another's
};

/// A target that there may be.
struct LabelledTrack {
  double existence = 0.0;  ///< probability that it is there; 0: room for another
  Mixture mixture;         ///< where, if it is; weights add up to 1, the heaviest first
  Time last_seen{};        ///< newest look that is likelier to have seen it than not
  int label = 0;           ///< what its first look calls the detection that it was born of
  int hits = 0;            ///< looks that saw it
  int misses = 0;          ///< looks that should have seen it and did not, since the last hit
};

/// From where, with what and when one look was made.
struct Glance {
  const models::SensorModel& sensor;
  const models::DetectionModel& detection;
  const models::Viewpoint& from;
  Time at;
  /// Label of what its first detection founds; that of the next is one more, in an order that is
  /// the detections' own.
  int first_label = 0;
};

/// What happened to detections, since construction.
struct MultiTargetCounters {
  std::int64_t births = 0;
  std::int64_t deaths = 0;
  std::int64_t beyond_capacity = 0;  ///< detections or births that there was no room for
  std::int64_t malformed = 0;        ///< of the wrong dimension, or that nothing explains
};

/// Filters several targets by looks that do not say which detection is of which target, or of any.
///
/// A look at tracks i of existence r_i and belief p_i: w_i0 = 1 − r_i p_D P_i(in view) that i is
/// not reported, w_ij = r_i p_D p(z_j | p_i) that it is as detection j, over the intensity of what
/// else is reported: false alarms (uniform over the area in view) and targets not tracked yet
/// (uniform over the world, as many as the tracks leave of `targets`). From the joint association
/// probabilities β of these (class Association) r_i ← Σ_j β_ij + β_i0 r_i (1 − p_D P_i) / w_i0,
/// given that no more than `targets` exist; belief i becomes the mixture of its posteriors by each
/// detection and by none, reduced; and 1 − Σ_i β_ij of detection j founds a track. Weights see a
/// detection as the Gaussian of its position with nothing known before; posteriors that count are
/// measure()'s, empty looks missed_detection()'s, motion is propagate()'s.
///
/// kLabelled first gives each detection to at most one track, by the likeliest association; only
/// tracks that got none may be seen as what nobody got. Without it, two tracks that are both lost
/// share the one target that is found again, and neither lets go of it.
///
/// Pure: tracks are the caller's, the rest is scratch. The order of detections changes no bit.
/// Allocates nothing. Planar targets; sensors that tell where a target is (not range or bearing
/// alone).
/// Source: Reuter, Vo, Vo, Dietmayer, The labeled multi-Bernoulli filter (2014); Williams, Marginal
/// multi-Bernoulli filters: RFS derivation of MHT, JIPDA and association-based MeMBer (2015); JPDA:
/// Bar-Shalom, Fortmann, Scheffe (1980).
class MultiTargetFilter {
 public:
  /// @throws UsageError for a spec that makes no sense.
  explicit MultiTargetFilter(MultiTargetSpec spec);

  /// As many tracks as there is room for, of existence 0.
  [[nodiscard]] std::vector<LabelledTrack> no_tracks() const;
  /// Brings the tracks of `from` to `to` ≥ `from`.
  void propagate(std::vector<LabelledTrack>& tracks, Time from, Time to);
  /// One look, of the instant that `tracks` are of. Precondition: as many as no_tracks() has.
  void look(std::vector<LabelledTrack>& tracks, const Glance& glance,
            std::span<const models::Detection> detections);
  /// The same, of a sensor that detects as the spec says.
  void look(std::vector<LabelledTrack>& tracks, const models::SensorModel& sensor,
            const models::Viewpoint& from, Time at, std::span<const models::Detection> detections,
            int first_label = 0) {
    look(tracks, {sensor, spec_.detection, from, at, first_label}, detections);
  }
  /// Whether to tell of it: likelier there than not, or seen often enough.
  [[nodiscard]] bool is_confirmed(const LabelledTrack& track) const;

  [[nodiscard]] const MultiTargetSpec& spec() const { return spec_; }
  [[nodiscard]] const MultiTargetCounters& counters() const { return counters_; }

 private:
  struct Look;
  /// Detections that can be used, in an order that is theirs alone.
  void sort_detections(const Look& look, std::span<const models::Detection> detections);
  void expect_misses(const std::vector<LabelledTrack>& tracks, const Look& look);
  void weigh(const std::vector<LabelledTrack>& tracks, const Look& look);
  /// Leaves each detection to the track that it is given to in the likeliest association.
  void share_out(bool is_exclusive);
  void mix(std::size_t i, LabelledTrack& track, const Look& look);
  /// What detection j makes of component k of track i.
  [[nodiscard]] models::Gaussian seen_as(const models::Gaussian& belief, std::size_t j,
                                         double weight, const Look& look) const;
  void count_hits(std::vector<LabelledTrack>& tracks, const Look& look);
  /// Existences given that there are no more than so many targets.
  void keep_to_number(std::vector<LabelledTrack>& tracks);
  void bear(std::vector<LabelledTrack>& tracks, const Look& look);
  void bury(std::vector<LabelledTrack>& tracks);
  [[nodiscard]] double existence_of(const LabelledTrack& track) const;
  [[nodiscard]] std::size_t at(std::size_t i, std::size_t k) const;

  MultiTargetSpec spec_;
  MultiTargetCounters counters_;
  double world_area_m2_;
  Association association_;
  // By detection: itself, its position's moments with nothing known before.
  std::vector<models::Measurement> seen_;
  std::vector<PositionMoments> found_;
  // By track and component: belief and weight if not reported.
  std::vector<Component> missed_;
  std::vector<double> missed_probability_;  ///< by track
  std::vector<double> fit_per_m2_;  ///< p(z_j | component) over p(z_j) if anywhere; by at(i, k), j
  Mixture mixture_;                 ///< before it is reduced
  std::vector<double> before_;      ///< P(n of the tracks up to one exist)
  std::vector<double> after_;       ///< P(at most n of those from one on exist)
};

}  // namespace vantage::estimator
