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

// What processes tell each other, as values. bus/convert/convert turns them into wire messages and
// back; nothing else knows how they travel.

namespace vantage::models {

/// Names one message of one process run: together with the channel it is unique for ever.
struct InputRef {
  std::string channel;
  std::int64_t run_id = 0;
  std::int64_t sequence = 0;
  friend bool operator==(const InputRef&, const InputRef&) = default;
};

/// Where a message comes from and when its content is valid.
struct Stamp {
  Time time{};  ///< the instant that the content is valid for, not the instant of sending
  std::int64_t run_id = 0;
  std::int64_t sequence = 0;
};

/// One rigid body as the mocap system sees it.
struct MocapBody {
  std::string name;
  Pose3 world_from_body;
  bool occluded = false;  ///< then the pose means nothing
};

/// All bodies at one instant (VICON).
struct MocapFrame {
  Stamp stamp;  ///< time: capture
  Time arrival{};
  std::int64_t frame_number = 0;
  std::vector<MocapBody> bodies;

  [[nodiscard]] const MocapBody* find(const std::string& name) const;
  /// The same, of one that was at `hint` in a frame before: no search where it still is.
  [[nodiscard]] const MocapBody* find(const std::string& name, std::size_t hint) const;
};

/// Of a detection whose sensor does not say which target it is of, if of any.
inline constexpr int kNoTargetId = -1;
/// Ids from here on are labels of tracks, not of targets: where sensors tell no ids, nobody knows
/// which track is which target of the scenario.
inline constexpr int kTrackLabelMin = 1 << 30;

/// One target in view, or what a sensor takes for one.
struct Detection {
  int target_id = 0;  ///< or kNoTargetId
  Measurement measurement;
};

/// Everything that one robot's sensor saw at one instant (MEASUREMENT_R); empty when it looked
/// and saw nothing.
struct DetectionSet {
  Stamp stamp;
  std::string robot;
  Viewpoint viewpoint;  ///< from where it looked
  bool jammed = false;  ///< an attacked sensor did not look at all
  std::vector<Detection> detections;
  std::vector<InputRef> inputs;
};

/// One target as one robot knows it.
struct TargetBelief {
  int target_id = 0;        ///< or, from kTrackLabelMin on, a track's label
  Information information;  ///< at the message's time
  Time last_seen{};         ///< newest measurement of anyone that went into it
};

/// What one robot knows (BELIEF_R).
struct RobotBelief {
  Stamp stamp;
  std::string robot;
  std::int64_t step = 0;  ///< index of the estimator step that made it
  Viewpoint viewpoint;
  int degree = 0;                     ///< neighbours in range at this step
  std::vector<TargetBelief> targets;  ///< the discovered ones, by ascending target_id
  GridGeometry grid;
  std::vector<std::int64_t> last_seen_utime;  ///< per cell, VisibilityGrid::kNeverSeen for never
  std::vector<InputRef> inputs;               ///< what this step consumed, in that order
};

/// One target where one Gaussian says too little.
struct TargetMixture {
  int target_id = 0;       ///< as in the belief
  double existence = 1.0;  ///< probability that there is such a target, in (0, 1]
  Mixture components;      ///< one at least; weights add up to 1
};

/// What a robot's belief of the same instant has only the moments of (MIXTURE_R).
struct BeliefMixture {
  Stamp stamp;
  std::string robot;
  std::int64_t step = 0;               ///< as in the belief
  std::vector<TargetMixture> targets;  ///< by ascending target_id; of the others it says nothing
};

/// Whether the mixture is of this very belief.
bool is_of_belief(const BeliefMixture& mixture, const RobotBelief& belief);

/// One scan of a robot's range finder (SCAN_R).
struct RangeScan {
  Stamp stamp;
  std::string robot;
  Viewpoint viewpoint;             ///< where it is taken to have scanned from
  bool jammed = false;             ///< an attacked range finder did not scan: no ranges
  double field_of_view_rad = 0.0;  ///< in (0, 2π]; beams as BeamSensor has them
  double range_max_m = 0.0;        ///< a reading of about this much met nothing
  std::vector<double> ranges_m;    ///< by beam
  std::vector<InputRef> inputs;
};

/// What one robot knows of which cells are occupied (MAP_R). Looks of a cell: scans that met
/// something in it less scans that passed through it.
struct RobotMap {
  Stamp stamp;
  std::string robot;
  std::int64_t step = 0;  ///< index of the estimator step that made it
  Viewpoint viewpoint;
  GridGeometry grid;
  std::vector<std::int16_t> own_looks;   ///< per cell, by this run's own scans
  std::vector<std::int16_t> team_looks;  ///< per cell, own and of each teammate what was heard
  double entropy_nats = 0.0;             ///< of the map that team_looks makes
  std::vector<InputRef> inputs;          ///< belief (its pose), own map before, scans, team's maps
};

/// How a published plan came about; lower is better.
enum class PlanSource {
  kSearched = 0,  ///< the best complete plan of this slot's search
  kShifted = 1,   ///< last plan, shifted and checked again
  kBraking = 2,   ///< stop and hover
};

/// "searched", "shifted", "braking".
const char* name_of(PlanSource source);

/// One robot's committed motion and how good it is (PLAN_R).
struct RobotPlan {
  Stamp stamp;  ///< time: when the trajectory starts, t_{k+1}
  std::string robot;
  std::int64_t round = 0;
  PlanSource source = PlanSource::kBraking;
  Trajectory trajectory;
  int horizon_steps = 0;     ///< T
  double step_s = 0.5;       ///< τ
  double cost = 0.0;         ///< J_T of the search, nats; NaN without one
  double lower_bound = 0.0;  ///< on J_T; −∞ when nothing is proven
  double epsilon = 0.0;      ///< of the last finished pass; ∞ for the greedy one
  double delta_m = 0.0;
  std::int64_t passes = 0;  ///< finished
  std::int64_t nodes = 0;   ///< work done; the node budget that replays it exactly
  Time slot_start{};
  Time deadline{};    ///< end of the slot
  Time finish{};      ///< when the search had ended
  bool late = false;  ///< finish > deadline
  std::vector<InputRef> inputs;
};

/// What one robot would do if it were the only one that looks (PROPOSAL_R), in the first half of a
/// round of a team that expects attacks.
struct PlanProposal {
  Stamp stamp;              ///< time: when the plan would start, t_{k+1}
  double value_nats = 0.0;  ///< information that it alone gains; 0: nothing was found
  RobotPlan plan;
};

/// What one robot is to do in a solution of the team.
struct TeamChoice {
  std::string robot;
  Trajectory trajectory;
  double information_nats = 0.0;  ///< that it alone gains, as its own robot counts it
  double energy_nats = 0.0;       ///< what its motion costs
};

/// The team's solution after a local operation (TEAM_PROPOSAL_R), whole, so that it is understood
/// by whoever has missed those before it.
struct TeamProposal {
  Stamp stamp;        ///< time: when the trajectories would start, t_{k+1}
  std::string robot;  ///< who proposes
  std::int64_t round = 0;
  /// J = I − C: that of the solution improved on plus the rise as the proposer counts it.
  double value_nats = 0.0;
  std::vector<TeamChoice> choices;    ///< at most one a robot; who is not in it rests
  std::vector<std::int64_t> history;  ///< fingerprints of the solutions that led here, this last
  std::int64_t nodes = 0;             ///< the node budget that repeats the search for candidates
  /// What the candidates were made from; last the proposal that this one improves on, if any.
  std::vector<InputRef> inputs;

  [[nodiscard]] const TeamChoice* find(const std::string& of_robot) const;
};

enum class FlightState { kIdle, kFollow, kHold, kLand, kKilled };

/// "idle", "follow", "hold", "land", "killed".
const char* name_of(FlightState state);

/// What one vehicle does and why (VEHICLE_R).
struct VehicleStatus {
  Stamp stamp;
  std::string robot;
  FlightState state = FlightState::kIdle;
  double battery_share = 1.0;  ///< in [0, 1]
  Pose2 setpoint;
  double setpoint_height_m = 0.0;
  std::int64_t plan_round = -1;  ///< of the plan being followed
  std::vector<std::string> reasons;
};

enum class OperatorAction { kHeartbeat, kArm, kTakeOff, kFollow, kHold, kLand, kEmergencyStop };

/// What may be said by any station, at any time: hold, land, emergency stop.
constexpr bool makes_safer(OperatorAction action) {
  return action == OperatorAction::kHold || action == OperatorAction::kLand ||
         action == OperatorAction::kEmergencyStop;
}

/// From the operator's console (COMMAND).
struct OperatorCommand {
  Stamp stamp;
  OperatorAction action = OperatorAction::kHeartbeat;
  std::string robot;  ///< empty: all
};

/// One body of the simulated world.
struct TruthBody {
  std::string name;
  int target_id = -1;  ///< −1 for robots
  Pose3 world_from_body;
  Eigen::Vector3d velocity_world_mps = Eigen::Vector3d::Zero();
};

/// The simulated world at one instant (TRUTH).
struct TruthFrame {
  Stamp stamp;
  std::vector<TruthBody> bodies;
};

enum class ContactKind { kCollision, kNearMiss };

/// Two bodies, or a body and an obstacle, touched or came nearer than they may (COLLISION).
struct ContactReport {
  Stamp stamp;
  ContactKind kind = ContactKind::kNearMiss;
  std::string body_a;
  std::string body_b;       ///< a body, or "obstacle:<index>", or "bounds"
  double distance_m = 0.0;  ///< between surfaces; ≤ 0 for a collision
};

/// Which robots' sensors are jammed now (ATTACK).
struct AttackNotice {
  Stamp stamp;
  std::vector<std::string> jammed;
};

enum class ProcessState { kStarting, kRunning, kDegraded, kStopping };

struct NamedCount {
  std::string name;
  std::int64_t count = 0;
};

/// How one process is (HEALTH_<process>), 1 Hz and on change.
struct ProcessHealth {
  Stamp stamp;
  std::string process;
  ProcessState state = ProcessState::kStarting;
  std::vector<NamedCount> counters;  ///< every drop has one
  std::int64_t loops = 0;
  double loop_worst_s = 0.0;  ///< worst handling time since the last report
  std::int64_t deadlines_missed = 0;
};

enum class SupervisedPhase { kRunning, kWaiting, kGivenUp, kEnded };

/// "running", "waiting", "given up", "ended".
const char* name_of(SupervisedPhase phase);

/// One process as its supervisor knows it.
struct SupervisedProcess {
  std::string name;  ///< as `vantage up` calls it: "planner Q1"
  SupervisedPhase phase = SupervisedPhase::kRunning;
  int restarts = 0;
  double down_s = 0.0;     ///< not running, since its first start
  double cpu_share = 0.0;  ///< of one core, over the last second or so
  std::int64_t memory_bytes = 0;
  std::string last_end;  ///< "exit 1", "signal 9"; empty: it never ended
};

/// What one supervisor runs on its host (HOST_<host>), 1 Hz and on change.
struct HostReport {
  Stamp stamp;
  std::string host;
  std::vector<SupervisedProcess> processes;
};

/// The first event of every log (SCENARIO).
struct ScenarioNotice {
  Stamp stamp;
  std::string yaml;
  std::string version;
  std::string process;  ///< who publishes it
};

}  // namespace vantage::models
