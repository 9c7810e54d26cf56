#pragma once

#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/time.hpp"
#include "logs/foxglove/scene.hpp"
#include "logs/foxglove/schema.hpp"
#include "logs/foxglove/values.hpp"
#include "logs/metrics/origin_times.hpp"
#include "logs/metrics/team_estimate.hpp"
#include "logs/metrics/trial_metrics.hpp"
#include "models/exchange/messages.hpp"
#include "scenario/scenario.hpp"

namespace vantage::logs::foxglove {

/// Who takes what a Stream makes: a viewer's server, an MCAP file.
class Sink {
 public:
  Sink() = default;
  virtual ~Sink() = default;
  Sink(const Sink&) = delete;
  Sink& operator=(const Sink&) = delete;
  Sink(Sink&&) = delete;
  Sink& operator=(Sink&&) = delete;

  /// Asked before each record; makes the topic known, always with the same schema. False: nobody
  /// wants this one, do not make it. `is_state`: the newest record says all there is to know on
  /// the topic, and it comes seldom, so it is worth having for who asks later.
  virtual bool wants(const std::string& topic, Schema schema, bool is_state) = 0;
  /// A record of a topic that wants() just said true to. `time`: when it was heard.
  virtual void write(const std::string& topic, Time time, const Json& content) = 0;
  /// Of a topic that is known: what a message on it is, for people ("plan_t").
  virtual void name_type(const std::string& /*topic*/, const std::string& /*type*/) {}
};

/// Turns the messages of a trial, in the order heard, into records for viewers. Pure: no clock, no
/// network. Holds what a picture needs of the past: the scenario, who is jammed, the last 20 s of
/// each body's way, the newest belief of each robot, what plans were made from.
///
/// Topics (P: of the robot or process of that name):
///   /scenario /attack /team       vantage.*           state; team at each step of the estimators
///   /plan/P/status /vehicle/P /health/P   vantage.*
///   /events                       foxglove.Log        collisions, late plans, attacks, safety …
///   /transforms /truth/transforms foxglove.FrameTransforms   world → body, mocap and truth
///   /world /robots /views /targets   foxglove.SceneUpdate   once, and on change
///   /plan/P /proposal/P /measurement/P /belief/P /estimates /tracks   foxglove.SceneUpdate
///   /grid /belief/P/grid          foxglove.Grid       when each cell was last seen, by all and P
///   /map /map/P                   foxglove.Grid       occupancy, as the last heard and as P knows
///   it
class Stream {
 public:
  explicit Stream(Sink& sink) : sink_(sink) {}

  /// `heard`: when the message came in (live) or was logged.
  void on(const models::ScenarioNotice& notice, Time heard);
  void on(const models::MocapFrame& frame, Time heard);
  void on(const models::TruthFrame& truth, Time heard);
  void on(const models::DetectionSet& detections, Time heard);
  void on(const models::RobotBelief& belief, Time heard);
  void on(const models::BeliefMixture& /*mixture*/, Time /*heard*/) {}  // the beliefs are shown
  void on(const models::RangeScan& /*scan*/, Time /*heard*/) {}  // the map shows what it told
  void on(const models::RobotMap& map, Time heard);
  void on(const models::RobotPlan& plan, Time heard);
  void on(const models::PlanProposal& /*proposal*/, Time /*heard*/) {}  // the plans are shown
  void on(const models::TeamProposal& proposal, Time heard);
  void on(const models::VehicleStatus& status, Time heard);
  void on(const models::ProcessHealth& health, Time heard);
  void on(const models::HostReport& report, Time heard);
  void on(const models::ContactReport& contact, Time heard);
  void on(const models::AttackNotice& attack, Time heard);
  /// Commands of people (heartbeats are not worth a line).
  void on(const models::OperatorCommand& command, Time heard);

  /// Scenarios that could not be read, so far.
  [[nodiscard]] std::int64_t scenarios_refused() const { return scenarios_refused_; }

 private:
  using Track = std::deque<std::pair<Time, Eigen::Vector3d>>;

  void put(const std::string& topic, Schema schema, Time heard, const auto& make,
           bool is_state = false);
  void put_event(const std::optional<Event>& event, Time heard);
  void put_robots(Time heard, Time time);
  void put_estimates(const std::string& topic, const std::string& prefix,
                     const std::vector<EstimateView>& views, Time heard);
  /// The team's estimates of this step, once, when its beliefs have come.
  void flush_estimates(Time heard);
  void put_grid(const models::RobotBelief& belief, Time heard);
  void follow(const std::string& body, const Eigen::Vector3d& position_m, Time time);
  void put_tracks(Time heard, Time time);
  /// Remembers which measurement `plan` comes from.
  void trace(const models::RobotPlan& plan);
  /// Notes how old it was when `status` is the first to say that its plan is followed.
  void note_latency(const models::VehicleStatus& status);
  /// nullopt: no robot of the scenario, or none was heard.
  [[nodiscard]] std::optional<Colour> colour_of(const std::string& robot) const;
  /// Precondition: a scenario was heard.
  [[nodiscard]] std::string target_name(int target_id) const;

  Sink& sink_;
  std::optional<scenario::Scenario> scenario_;
  std::optional<TrialMetrics> metrics_;  ///< whenever scenario_ is
  std::optional<models::AttackNotice> attack_;
  std::map<std::string, models::VehicleStatus> vehicles_;
  std::map<std::string, HealthStory> processes_;
  std::map<std::string, models::HostReport> hosts_;
  std::map<std::string, Track> tracks_;
  std::optional<Time> next_tracks_;
  OriginTimes captures_;             ///< of measurements
  OriginTimes captures_of_beliefs_;  ///< of the newest that is in each
  std::map<std::string, std::map<std::int64_t, Time>> captures_of_plans_;  ///< by robot and round
  std::map<std::string, Duration> capture_to_setpoint_;  ///< of the plan it follows
  std::map<int, EstimateView> estimates_;                ///< best of the newest step, by target
  std::optional<Time> estimates_time_;                   ///< of those not yet shown
  std::optional<Time> last_mocap_;
  models::GridGeometry grid_;
  std::vector<std::int64_t> last_seen_utime_;  ///< newest of all robots
  std::int64_t grid_step_ = -1;
  std::int64_t newest_step_ = -1;
  std::int64_t scenarios_refused_ = 0;
};

}  // namespace vantage::logs::foxglove
