#pragma once

#include <deque>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bus/node/publisher_watch.hpp"
#include "core/time.hpp"
#include "logs/foxglove/scene.hpp"
#include "logs/foxglove/schema.hpp"
#include "logs/foxglove/session_watch.hpp"
#include "logs/foxglove/values.hpp"
#include "logs/metrics/origin_times.hpp"
#include "logs/metrics/team_estimate.hpp"
#include "logs/metrics/trial_metrics.hpp"
#include "models/exchange/compact_belief.hpp"
#include "models/exchange/messages.hpp"
#include "models/exchange/pose_messages.hpp"
#include "scenario/scenario.hpp"

namespace vantage::logs::foxglove {

/// Receiver of the records of a Stream, such as a viewer's server or an MCAP file.
class Sink {
 public:
  Sink() = default;
  virtual ~Sink() = default;
  Sink(const Sink&) = delete;
  Sink& operator=(const Sink&) = delete;
  Sink(Sink&&) = delete;
  Sink& operator=(Sink&&) = delete;

  /// Announces the topic, always with the same schema; called before each record. Returns false if
  /// the record should not be made. `is_state`: the newest record is the complete state of the
  /// topic and records are rare, so it should be kept for clients that connect later.
  virtual bool wants(const std::string& topic, Schema schema, bool is_state) = 0;
  /// Writes a record of a topic for which wants() has just returned true. `time`: time of
  /// reception.
  virtual void write(const std::string& topic, Time time, const Json& content) = 0;
  /// Sets the readable message type ("plan_t") of a known topic.
  virtual void name_type(const std::string& /*topic*/, const std::string& /*type*/) {}
};

/// Converter of a trial's messages, in order of reception, to records for viewers. It uses no clock
/// and no network. It keeps the state that drawings need: the scenario, the jammed robots, the last
/// 20 s of each body's path, the newest belief of each robot, and the inputs of plans.
///
/// Topics (P: name of a robot or process):
///   /scenario /attack /team       vantage.*           /team at each step of the estimators
///   /targets/status              vantage.Targets     state at each step of the estimators
///   /plan/P/status /vehicle/P /health/P   vantage.*
///   /events                       foxglove.Log        collisions, late plans, attacks, safety …
///   /transforms /truth/transforms foxglove.FrameTransforms   world → body, mocap and truth
///   /world /robots /views /targets   foxglove.SceneUpdate   once, and on change
///   /plan/P /proposal/P /measurement/P /belief/P /estimates /tracks   foxglove.SceneUpdate
///   /grid /belief/P/grid          foxglove.Grid       age of each cell's last scan, by all or by P
///   /map /map/P                   foxglove.Grid       occupancy: newest map of any robot, or of P
class Stream {
 public:
  explicit Stream(Sink& sink) : sink_(sink) {}

  /// `received_at`: time of reception (live) or of logging.
  void on(const models::ScenarioNotice& notice, Time received_at);
  void on(const models::MocapFrame& frame, Time received_at);
  void on(const models::TruthFrame& truth, Time received_at);
  void on(const models::RobotMeasurement& detections, Time received_at);
  void on(const models::RobotBelief& belief, Time received_at);
  void on(const models::BeliefMixture& /*mixture*/, Time /*received_at*/) {
  }  // beliefs are shown instead
  void on(const models::CompactBelief& /*belief*/, Time /*received_at*/) {
  }  // not drawn: the complete belief of the same step is drawn
  void on(const models::RangeScan& /*scan*/, Time /*received_at*/) {
  }  // not drawn: the map shows the content of the scans
  void on(const models::OdometryReport& /*odometry*/, Time /*received_at*/) {}
  void on(const models::SightingReport& /*sightings*/, Time /*received_at*/) {}
  void on(const models::PoseEstimate& /*estimate*/, Time /*received_at*/) {}
  void on(const models::RobotMap& map, Time received_at);
  void on(const models::RobotPlan& plan, Time received_at);
  void on(const models::PlanProposal& /*proposal*/, Time /*received_at*/) {
  }  // plans are shown instead
  void on(const models::TeamProposal& proposal, Time received_at);
  void on(const models::VehicleStatus& status, Time received_at);
  void on(const models::ProcessHealth& health, Time received_at);
  void on(const models::HostReport& report, Time received_at);
  void on(const models::CollisionReport& contact, Time received_at);
  void on(const models::AttackNotice& attack, Time received_at);
  /// Processes an operator command; heartbeats are ignored.
  void on(const models::OperatorCommand& command, Time received_at);
  /// Processes the publisher of a message of any type, also of messages that a Bus does not accept.
  /// Publishes an event when a channel has two publishers.
  void on_publisher(std::string_view channel, std::int64_t run_id, Time received_at);

 private:
  using Track = std::deque<std::pair<Time, Eigen::Vector3d>>;

  void put(const std::string& topic, Schema schema, Time received_at, const auto& make,
           bool is_state = false);
  void put_event(const std::optional<Event>& event, Time received_at);
  void put_robots(Time received_at, Time time);
  void put_estimates(const std::string& topic, const std::string& prefix,
                     const std::vector<EstimateView>& views, Time received_at);
  /// Publishes the team's estimates of the current step once, when the beliefs of this step have
  /// arrived.
  void flush_estimates(Time received_at);
  /// Publishes the state of each target, and an event for each change.
  void put_targets(Time received_at, Time time);
  /// Discards the state of the session that has ended.
  void begin_session(Time received_at, bool has_begun_before);
  void put_grid(const models::RobotBelief& belief, Time received_at);
  void extend_trail(const std::string& body, const Eigen::Vector3d& position_m, Time time);
  void put_tracks(Time received_at, Time time);
  /// Stores the capture time of the newest measurement that `plan` is based on.
  void trace(const models::RobotPlan& plan);
  /// Stores the age of the newest measurement of the followed plan if `status` is the first to
  /// report this plan.
  void note_latency(const models::VehicleStatus& status);
  /// Returns nullopt until a scenario is received, or if it does not contain the robot.
  [[nodiscard]] std::optional<Colour> colour_of(const std::string& robot) const;
  /// Precondition: a scenario was received.
  [[nodiscard]] std::string target_name(int target_id) const;

  Sink& sink_;
  SessionWatch sessions_;
  std::optional<scenario::Scenario> scenario_;
  std::optional<TrialMetrics> metrics_;  ///< set if scenario_ is set
  std::vector<TargetStory> stories_;     ///< one per target of scenario_
  std::map<int, Sighting> sightings_;    ///< last measurement of each target with an id
  /// s after the first message; a target found earlier may have been found before the first message
  double unknown_until_s_ = 0.0;
  std::optional<models::AttackNotice> attack_;
  std::map<std::string, models::VehicleStatus> vehicles_;
  std::map<std::string, HealthStory> processes_;
  bus::PublisherWatch publishers_;
  std::map<std::string, models::HostReport> hosts_;
  std::map<std::string, Track> tracks_;
  std::optional<Time> next_tracks_;
  OriginTimes captures_;             ///< capture times of measurements
  OriginTimes captures_of_beliefs_;  ///< capture times of each belief's newest measurement
  /// capture times of the plans' newest measurements, by robot and round
  std::map<std::string, std::map<std::int64_t, Time>> captures_of_plans_;
  /// latency of the plan that each robot follows
  std::map<std::string, Duration> capture_to_setpoint_;
  std::map<int, EstimateView> estimates_;  ///< best estimates of the newest step, by target
  std::optional<Time> estimates_time_;     ///< time of the estimates not yet shown
  std::optional<Time> last_mocap_;
  models::GridGeometry grid_;
  /// µs; time of the newest scan of each cell by any robot
  std::vector<std::int64_t> last_seen_utime_;
  std::int64_t grid_step_ = -1;
  std::int64_t newest_step_ = -1;
};

}  // namespace vantage::logs::foxglove
