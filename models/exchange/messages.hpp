#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/pose.hpp"
#include "core/time.hpp"
#include "models/belief/gaussian.hpp"
#include "models/belief/mixture.hpp"
#include "models/plan/plan.hpp"
#include "models/sensor/sensor.hpp"
#include "models/world/grid.hpp"

// Messages between processes, as values. bus/convert/convert translates them to and from wire
// messages; no other code knows the wire format.

namespace vantage::models {

/// Reference to one message: channel, process run and sequence number identify it uniquely.
struct InputRef {
  std::string channel;
  std::int64_t run_id = 0;
  std::int64_t sequence = 0;
  friend bool operator==(const InputRef&, const InputRef&) = default;
};

/// Origin of a message and time for which its content is valid.
struct Stamp {
  Time time{};  ///< for which the content is valid, not the time of sending
  std::int64_t run_id = 0;
  std::int64_t sequence = 0;
};

/// One rigid body as observed by the mocap system.
struct MocapBody {
  std::string name;
  Pose3 world_from_body;
  bool occluded = false;  ///< true: the pose is meaningless
};

/// All bodies at one instant (channel VICON).
struct MocapFrame {
  Stamp stamp;     ///< stamp.time: capture time
  Time arrival{};  ///< at the publisher
  std::int64_t frame_number = 0;
  std::vector<MocapBody> bodies;

  [[nodiscard]] const MocapBody* find(const std::string& name) const;
  /// Finds a body that was at index `hint` in an earlier frame; no search if it still is.
  [[nodiscard]] const MocapBody* find(const std::string& name, std::size_t hint) const;
};

/// Target id of a detection from a sensor that does not identify targets; it may be a false alarm.
inline constexpr int kNoTargetId = -1;
/// Smallest track label. Ids from here on label tracks, not targets: without target ids from the
/// sensors, the assignment of tracks to the scenario's targets is unknown.
inline constexpr int kTrackLabelMin = 1 << 30;

/// One detection: a target in view, or a false alarm.
struct Detection {
  int target_id = 0;  ///< or kNoTargetId
  Measurement measurement;
};

/// All detections of one robot's sensor at one instant (channel MEASUREMENT_R); empty if it
/// detected nothing.
struct DetectionSet {
  Stamp stamp;
  std::string robot;
  Viewpoint viewpoint;  ///< of the sensor at that instant
  bool jammed = false;  ///< true: the sensor was attacked and did not measure
  std::vector<Detection> detections;
  std::vector<InputRef> inputs;
};

/// One robot's belief of one target.
struct TargetBelief {
  int target_id = 0;        ///< or, from kTrackLabelMin on, the label of a track
  Information information;  ///< at stamp.time of the message
  Time last_seen{};         ///< newest measurement of any robot that was fused
};

/// One robot's belief of all targets and of the explored ground (channel BELIEF_R).
struct RobotBelief {
  Stamp stamp;
  std::string robot;
  std::int64_t step = 0;  ///< index of the estimator step that made it
  Viewpoint viewpoint;
  int degree = 0;                     ///< number of neighbours in communication range at this step
  std::vector<TargetBelief> targets;  ///< discovered targets, by ascending target_id
  GridGeometry grid;
  std::vector<std::int64_t> last_seen_utime;  ///< per cell; VisibilityGrid::kNeverSeen: never
  std::vector<InputRef> inputs;               ///< messages that this step used, in order of use
};

/// Mixture belief of one target that a single Gaussian does not describe well.
struct TargetMixture {
  int target_id = 0;       ///< as in the belief
  double existence = 1.0;  ///< probability that there is such a target, in (0, 1]
  Mixture components;      ///< at least one; weights add up to 1
};

/// Mixtures whose moments are in the robot's belief of the same instant (channel MIXTURE_R).
struct BeliefMixture {
  Stamp stamp;
  std::string robot;
  std::int64_t step = 0;  ///< as in the belief
  /// By ascending target_id; the others are only in the belief.
  std::vector<TargetMixture> targets;
};

/// True if `mixture` belongs to `belief`: same robot, run, step and time.
bool is_of_belief(const BeliefMixture& mixture, const RobotBelief& belief);

/// One scan of a robot's range finder (channel SCAN_R).
struct RangeScan {
  Stamp stamp;
  std::string robot;
  Viewpoint viewpoint;  ///< assumed pose of the scanner at that instant
  bool jammed = false;  ///< true: the range finder was attacked and did not scan; no ranges
  double field_of_view_rad = 0.0;  ///< in (0, 2π]; beams are spaced as in BeamSensor
  double range_max_m = 0.0;        ///< a reading of about this value means no hit
  std::vector<double> ranges_m;    ///< one per beam
  std::vector<InputRef> inputs;
};

/// One robot's occupancy map (channel MAP_R). Looks of a cell: number of scans that hit something
/// in it minus the number that passed through it.
struct RobotMap {
  Stamp stamp;
  std::string robot;
  std::int64_t step = 0;  ///< index of the estimator step that made it
  Viewpoint viewpoint;
  GridGeometry grid;
  std::vector<std::int16_t> own_looks;   ///< per cell, from this run's own scans
  std::vector<std::int16_t> team_looks;  ///< per cell, own plus received teammates' own_looks
  double entropy_nats = 0.0;             ///< entropy of the map from team_looks
  std::vector<InputRef> inputs;  ///< belief (for the pose), own last map, scans, teammates' maps
};

/// Origin of a published plan; a lower value is better.
enum class PlanSource {
  kSearched = 0,  ///< best complete plan of this slot's search
  kShifted = 1,   ///< remainder of the previous plan, checked again
  kBraking = 2,   ///< stop and hover
};

/// Returns "searched", "shifted" or "braking".
const char* name_of(PlanSource source);

/// One robot's committed motion and its quality (channel PLAN_R).
struct RobotPlan {
  Stamp stamp;  ///< stamp.time: start of the trajectory, t_{k+1}
  std::string robot;
  std::int64_t round = 0;
  PlanSource source = PlanSource::kBraking;
  Trajectory trajectory;
  int horizon_steps = 0;     ///< T: number of steps of a plan
  double step_s = 0.5;       ///< τ: duration of one control
  double cost = 0.0;         ///< J_T of the search, nats; NaN if nothing was searched
  double lower_bound = 0.0;  ///< proven bound on J_T, nats; −∞ if none
  double epsilon = 0.0;      ///< ε of the last finished pass; ∞ for the greedy pass
  double delta_m = 0.0;
  std::int64_t passes = 0;  ///< number of finished passes
  std::int64_t nodes = 0;   ///< work done; as node budget it reproduces the plan exactly
  Time slot_start{};
  Time deadline{};    ///< end of the slot
  Time finish{};      ///< end of the search
  bool late = false;  ///< true: finish > deadline
  std::vector<InputRef> inputs;
};

/// Plan of one robot as if no other robot observed (channel PROPOSAL_R). Published in the first
/// half of a round by teams that expect attacks.
struct PlanProposal {
  Stamp stamp;              ///< stamp.time: start of the plan, t_{k+1}
  double value_nats = 0.0;  ///< information gain of this robot alone; 0: no plan was found
  RobotPlan plan;
};

/// Trajectory of one robot in a team solution.
struct TeamChoice {
  std::string robot;
  Trajectory trajectory;
  double information_nats = 0.0;  ///< gain of this robot alone, computed by the robot itself
  double energy_nats = 0.0;       ///< cost of its motion
};

/// Complete team solution after a local operation (channel TEAM_PROPOSAL_R). It is complete so that
/// a robot that missed earlier proposals can use it.
struct TeamProposal {
  Stamp stamp;        ///< stamp.time: start of the trajectories, t_{k+1}
  std::string robot;  ///< robot that proposes the solution
  std::int64_t round = 0;
  /// J = I − C, nats: value of the solution that this one improves plus the increase computed by
  /// the proposer.
  double value_nats = 0.0;
  std::vector<TeamChoice> choices;    ///< at most one per robot; robots without one hover
  std::vector<std::int64_t> history;  ///< fingerprints of the successive solutions up to this one
  std::int64_t nodes = 0;             ///< node budget that reproduces the candidate search exactly
  /// Messages that the candidates depend on; the last one is the improved proposal, if any.
  std::vector<InputRef> inputs;

  [[nodiscard]] const TeamChoice* find(const std::string& of_robot) const;
};

enum class FlightState { kIdle, kFollow, kHold, kLand, kKilled };

/// Returns "idle", "follow", "hold", "land" or "killed".
const char* name_of(FlightState state);

/// State of one vehicle and the reasons for it (channel VEHICLE_R).
struct VehicleStatus {
  Stamp stamp;
  std::string robot;
  FlightState state = FlightState::kIdle;
  double battery_share = 1.0;  ///< in [0, 1]
  Pose2 setpoint;
  double setpoint_height_m = 0.0;
  std::int64_t plan_round = -1;  ///< round of the plan being followed; −1: none
  std::vector<std::string> reasons;
};

enum class OperatorAction { kHeartbeat, kArm, kTakeOff, kFollow, kHold, kLand, kEmergencyStop };

/// True for commands that any station may send at any time: hold, land, emergency stop.
constexpr bool makes_safer(OperatorAction action) {
  return action == OperatorAction::kHold || action == OperatorAction::kLand ||
         action == OperatorAction::kEmergencyStop;
}

/// Command from an operator's console (channel COMMAND).
struct OperatorCommand {
  Stamp stamp;
  OperatorAction action = OperatorAction::kHeartbeat;
  std::string robot;  ///< addressee; empty: all vehicles
};

/// One body of the simulated world.
struct TruthBody {
  std::string name;
  int target_id = -1;  ///< −1 for robots
  Pose3 world_from_body;
  Eigen::Vector3d velocity_world_mps = Eigen::Vector3d::Zero();
};

/// State of the simulated world at one instant (channel TRUTH).
struct TruthFrame {
  Stamp stamp;
  std::vector<TruthBody> bodies;
};

enum class ContactKind { kCollision, kNearMiss };

/// Contact of two bodies or of a body and an obstacle, or a violated separation distance (channel
/// COLLISION).
struct ContactReport {
  Stamp stamp;
  ContactKind kind = ContactKind::kNearMiss;
  std::string body_a;
  std::string body_b;       ///< a body, or "obstacle:<index>", or "bounds"
  double distance_m = 0.0;  ///< between surfaces; collision: ≤ 0
};

/// Robots whose sensors are jammed now (channel ATTACK).
struct AttackNotice {
  Stamp stamp;
  std::vector<std::string> jammed;
};

enum class ProcessState { kStarting, kRunning, kDegraded, kStopping };

struct NamedCount {
  std::string name;
  std::int64_t count = 0;
};

/// State of one process (channel HEALTH_<process>), published at 1 Hz and on change.
struct ProcessHealth {
  Stamp stamp;
  std::string process;
  ProcessState state = ProcessState::kStarting;
  std::vector<NamedCount> counters;  ///< named counts; every kind of dropped message has one
  std::int64_t loops = 0;
  double loop_worst_s = 0.0;  ///< longest handling time of one loop since the last report
  std::int64_t deadlines_missed = 0;
};

enum class SupervisedPhase { kRunning, kWaiting, kGivenUp, kEnded };

/// Returns "running", "waiting", "given up" or "ended".
const char* name_of(SupervisedPhase phase);

/// State of one process as recorded by its supervisor.
struct SupervisedProcess {
  std::string name;  ///< name used by `vantage up`, for example "planner Q1"
  SupervisedPhase phase = SupervisedPhase::kRunning;
  int restarts = 0;
  double down_s = 0.0;     ///< total time not running since the first start
  double cpu_share = 0.0;  ///< share of one core over about the last second
  std::int64_t memory_bytes = 0;
  std::string last_end;  ///< "exit 1", "signal 9"; empty: never ended
};

/// Processes that one supervisor runs on its host (channel HOST_<host>), published at 1 Hz and on
/// change.
struct HostReport {
  Stamp stamp;
  std::string host;
  std::vector<SupervisedProcess> processes;
};

/// Scenario and software version; the first event of every log (channel SCENARIO).
struct ScenarioNotice {
  Stamp stamp;
  std::string yaml;
  std::string version;
  std::string process;  ///< name of the publishing process
};

}  // namespace vantage::models
