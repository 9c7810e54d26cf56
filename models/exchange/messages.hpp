#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
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
// messages; no other code depends on the wire format.

namespace vantage::models {

/// Reference to one message; run id and sequence number together are unique on a channel.
struct InputRef {
  std::string channel;
  std::int64_t run_id = 0;
  std::int64_t sequence = 0;
  friend bool operator==(const InputRef&, const InputRef&) = default;
};

/// The origin of a message and the time of its content.
struct Stamp {
  Time time{};  ///< time at which the content is valid, not the time of sending
  std::int64_t run_id = 0;
  std::int64_t sequence = 0;
};

/// Returns the reference to the message with `stamp` on `channel`.
inline InputRef ref_to(std::string channel, const Stamp& stamp) {
  return {std::move(channel), stamp.run_id, stamp.sequence};
}

/// One rigid body in a frame of the mocap system.
struct MocapBody {
  std::string name;
  Pose3 world_from_body;
  bool occluded = false;  ///< true: the pose is meaningless
};

/// The poses of all bodies at one time (VICON).
struct MocapFrame {
  Stamp stamp;     ///< stamp.time: capture time
  Time arrival{};  ///< time at which the publisher received the frame
  std::int64_t frame_number = 0;
  std::vector<MocapBody> bodies;

  [[nodiscard]] const MocapBody* find(const std::string& name) const;
  /// As find(name), but first checks index `hint`, at which a previous frame contained the body.
  [[nodiscard]] const MocapBody* find(const std::string& name, std::size_t hint) const;
};

/// Id of a detection from a sensor that does not identify targets.
inline constexpr int kNoTargetId = -1;
/// Smallest label of a track. Ids from this value on are labels, not target ids. When sensors do
/// not identify targets, it is unknown which track is which target of the scenario.
inline constexpr int kTrackLabelMin = 1 << 30;

/// One detected target, or a false alarm.
struct Detection {
  int target_id = 0;  ///< kNoTargetId if the sensor does not identify targets
  Measurement measurement;
};

/// The detections of one robot's sensor at one time (MEASUREMENT_R); empty when nothing was
/// detected.
struct RobotMeasurement {
  Stamp stamp;
  std::string robot;
  Viewpoint viewpoint;  ///< pose of the sensor at the time of measurement
  bool jammed = false;  ///< true: the sensor was attacked and made no measurement
  std::vector<Detection> detections;
  std::vector<InputRef> inputs;
};

/// One robot's belief of one target.
struct TargetBelief {
  int target_id = 0;        ///< target id, or a track's label (≥ kTrackLabelMin)
  Information information;  ///< the target's state at the message's time
  Time last_seen{};         ///< time of the newest measurement in this belief, from any robot
};

/// All beliefs of one robot (BELIEF_R).
struct RobotBelief {
  Stamp stamp;
  std::string robot;
  std::int64_t step = 0;  ///< index of the estimator step
  Viewpoint viewpoint;
  int degree = 0;                     ///< number of neighbours in communication range at this step
  std::vector<TargetBelief> targets;  ///< discovered targets, by ascending target_id
  GridGeometry grid;
  /// time at which each cell was last seen; VisibilityGrid::kNeverSeen: never
  std::vector<std::int64_t> last_seen_utime;
  std::vector<InputRef> inputs;  ///< inputs of this step in the order of use
};

/// The belief of one target as a mixture, when one Gaussian is not sufficient.
struct TargetMixture {
  int target_id = 0;       ///< id of the target in the belief
  double existence = 1.0;  ///< probability that the target exists, in (0, 1]
  Mixture components;      ///< at least one; weights sum to 1
};

/// The mixtures of one robot (MIXTURE_R). Their means and covariances are in the robot's belief of
/// the same time.
struct BeliefMixture {
  Stamp stamp;
  std::string robot;
  std::int64_t step = 0;               ///< index of the estimator step
  std::vector<TargetMixture> targets;  ///< by ascending target_id; other targets have no mixture
};

/// True if the mixture belongs to this belief.
bool is_of_belief(const BeliefMixture& mixture, const RobotBelief& belief);

/// One scan of a robot's range finder (channel SCAN_R).
struct RangeScan {
  Stamp stamp;
  std::string robot;
  Viewpoint viewpoint;             ///< assumed viewpoint of the scan
  bool jammed = false;             ///< true: the range finder was attacked; there are no ranges
  double field_of_view_rad = 0.0;  ///< in (0, 2π]; beams are spaced as in BeamSensor
  double range_max_m = 0.0;        ///< m; a reading near this value means that the beam hit nothing
  std::vector<double> ranges_m;    ///< by beam
  std::vector<InputRef> inputs;
};

/// One robot's occupancy map (MAP_R). The looks of a cell are the number of scans that hit
/// something in the cell minus the number of scans that passed through it.
struct RobotMap {
  Stamp stamp;
  std::string robot;
  std::int64_t step = 0;  ///< index of the estimator step
  Viewpoint viewpoint;
  GridGeometry grid;
  std::vector<std::int16_t>
      own_looks;  ///< looks per cell, from scans of this robot since the start of this process
  std::vector<std::int16_t>
      team_looks;  ///< looks per cell, from this robot's scans and those received from teammates
  double entropy_nats = 0.0;  ///< entropy of the map from team_looks
  std::vector<InputRef>
      inputs;  ///< belief (for the pose), this robot's previous map, scans, teammates' maps
};

/// The origin of a published plan. Lower values are better.
enum class PlanSource {
  kSearched = 0,  ///< the best complete plan of this slot's search
  kShifted = 1,   ///< the remaining part of the previous plan, after a new check
  kBraking = 2,   ///< stop and hover
};

/// Returns "searched", "shifted" or "braking".
const char* name_of(PlanSource source);

/// One robot's committed motion and its quality (PLAN_R).
struct RobotPlan {
  Stamp stamp;  ///< time: start of the trajectory, t_{k+1}
  std::string robot;
  std::int64_t round = 0;
  PlanSource source = PlanSource::kBraking;
  Trajectory trajectory;
  int horizon_steps = 0;     ///< T; number of steps
  double step_s = 0.5;       ///< τ; duration of a step
  double cost = 0.0;         ///< J_T of the search, nats; NaN without a search
  double lower_bound = 0.0;  ///< proven lower bound of J_T, nats; −∞ without one
  double epsilon = 0.0;      ///< ε of the last completed pass; ∞ for the greedy pass
  double delta_m = 0.0;
  std::int64_t passes = 0;  ///< completed passes of the search
  std::int64_t nodes = 0;   ///< expanded nodes; this node budget reproduces the search exactly
  Time slot_start{};
  Time deadline{};    ///< end of the slot
  Time finish{};      ///< end of the search
  bool late = false;  ///< finish > deadline
  std::vector<InputRef> inputs;
};

/// The plan that one robot computes as if no other robot had sensors (PROPOSAL_R). Teams that
/// expect attacks send proposals in the first half of a round.
struct PlanProposal {
  Stamp stamp;              ///< time: start of the plan, t_{k+1}
  double value_nats = 0.0;  ///< information gain of this robot alone, nats; 0: no plan was found
  RobotPlan plan;
};

/// The motion of one robot in a solution of the team.
struct TeamChoice {
  std::string robot;
  Trajectory trajectory;
  double information_nats = 0.0;  ///< information gain of this robot alone, computed by that robot
  double energy_nats = 0.0;       ///< energy cost of this robot's motion
};

/// The team's solution after a local operation (TEAM_PROPOSAL_R). Each message contains the
/// complete solution, so a receiver does not need earlier messages.
struct TeamProposal {
  Stamp stamp;        ///< time: start of the trajectories, t_{k+1}
  std::string robot;  ///< sender of the proposal
  std::int64_t round = 0;
  /// J = I − C, nats: the value of the previous solution plus the improvement computed by the
  /// sender.
  double value_nats = 0.0;
  std::vector<TeamChoice> choices;    ///< at most one per robot; robots without an entry hover
  std::vector<std::int64_t> history;  ///< fingerprints of all earlier solutions and of this one
  std::int64_t nodes = 0;             ///< node budget that reproduces the search for candidates
  /// Inputs of the candidates; the last input is the proposal that this proposal improves, if any.
  std::vector<InputRef> inputs;

  [[nodiscard]] const TeamChoice* find(const std::string& of_robot) const;
};

/// Returns the number of a planning round as shown in all programs: only the last five digits,
/// because rounds are counted from 1970. Returns "-" for a negative number, which means no round.
std::string round_text(std::int64_t round);

enum class FlightState { kIdle, kFollow, kHold, kLand, kKilled };

/// Returns "idle", "follow", "hold", "land" or "killed".
const char* name_of(FlightState state);

/// The state of one vehicle and the reasons for it (VEHICLE_R).
struct VehicleStatus {
  Stamp stamp;
  std::string robot;
  FlightState state = FlightState::kIdle;
  double battery_share = 1.0;  ///< in [0, 1]
  Pose2 setpoint;
  double setpoint_height_m = 0.0;
  std::int64_t plan_round = -1;  ///< round of the plan being followed
  std::vector<std::string> reasons;
};

enum class OperatorAction { kHeartbeat, kArm, kTakeOff, kFollow, kHold, kLand, kEmergencyStop };

/// True for the commands that any console may send at any time: hold, land, emergency stop.
constexpr bool makes_safer(OperatorAction action) {
  return action == OperatorAction::kHold || action == OperatorAction::kLand ||
         action == OperatorAction::kEmergencyStop;
}

/// A command from an operator's console (COMMAND).
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

/// The simulated world at one time (TRUTH).
struct TruthFrame {
  Stamp stamp;
  std::vector<TruthBody> bodies;
};

enum class CollisionKind { kCollision, kNearMiss };

/// A contact, or a distance below the limit, between two bodies or a body and an obstacle
/// (COLLISION).
struct CollisionReport {
  Stamp stamp;
  CollisionKind kind = CollisionKind::kNearMiss;
  std::string body_a;
  std::string body_b;       ///< a body, or "obstacle:<index>", or "bounds"
  double distance_m = 0.0;  ///< m, between the surfaces; ≤ 0 for a collision
};

/// The robots with sensors that are jammed at present (ATTACK).
struct AttackNotice {
  Stamp stamp;
  std::vector<std::string> jammed;
};

enum class ProcessState { kStarting, kRunning, kDegraded, kStopping };

struct NamedCount {
  std::string name;
  std::int64_t count = 0;
};

/// The health of one process (HEALTH_<process>), published at 1 Hz and on change.
struct ProcessHealth {
  Stamp stamp;
  std::string process;
  ProcessState state = ProcessState::kStarting;
  std::vector<NamedCount>
      counters;  ///< counters of the process, including one per reason for dropped messages
  std::int64_t loops = 0;
  double loop_worst_s = 0.0;  ///< longest handling time since the last report
  std::int64_t deadlines_missed = 0;
};

enum class SupervisedPhase { kRunning, kWaiting, kGivenUp, kEnded };

/// Returns "running", "waiting", "given up" or "ended".
const char* name_of(SupervisedPhase phase);

/// The state of one process in its supervisor.
struct SupervisedProcess {
  std::string name;  ///< name in `vantage up`, such as "planner Q1"
  SupervisedPhase phase = SupervisedPhase::kRunning;
  int restarts = 0;
  double down_s = 0.0;     ///< total time without running since the first start, s
  double cpu_share = 0.0;  ///< share of one core used during about the last second
  std::int64_t memory_bytes = 0;
  std::string last_end;  ///< "exit 1", "signal 9"; empty: the process never ended
};

/// All processes of one supervisor on its host (HOST_<host>), published at 1 Hz and on change.
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
  std::string process;  ///< name of the publisher
};

}  // namespace vantage::models
