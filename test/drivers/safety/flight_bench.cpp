#include "test/drivers/safety/flight_bench.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/angle.hpp"

namespace vantage::test {
namespace {

using models::FlightState;
using models::OperatorAction;

constexpr Time kStart = from_utime(1'700'000'000'000'000);
constexpr auto kLeadTicks = static_cast<std::int64_t>(FlightBench::kLeadS / FlightBench::kTickS);
static_assert(kLeadTicks % 100 == 0);
constexpr double kLaneHalfM = 2.6;
constexpr double kSpeedMps = 1.0;
constexpr double kBrakeMps2 = 2.0;
constexpr double kTurnRadps = 2.5;
constexpr std::int64_t kRoundTicks = 100;
constexpr std::int64_t kPublishTick = 90;  // tick of the round at which plans are published
constexpr std::int64_t kPlannerRun = 100;
constexpr std::int64_t kOtherPlannerRun = 500;
constexpr std::int64_t kStationRun = 7;
constexpr std::int64_t kOtherStationRun = 8;

bool has(const VehicleKnobs& knobs, BodyFault fault) {
  return std::find(knobs.body.begin(), knobs.body.end(), fault) != knobs.body.end();
}

}  // namespace

scenario::Scenario FlightBench::scenario(double stagger_m) {
  scenario::Scenario out;
  out.name = "bench";
  out.world.bounds = {{-4.0, -2.2}, {4.0, 2.2}};
  out.world.ceiling_m = 3.0;
  out.planner.execute_steps = 2;
  out.world.obstacles = {{{{-0.3, 0.5}, {0.3, 0.8}}, 2.5}};
  for (int i = 0; i < 3; ++i) {
    scenario::RobotSpec robot;
    robot.name = std::string("Q") + std::to_string(i + 1);
    robot.start = {-2.0 + i, -1.3 + 1.3 * i, 0.0};
    robot.height_m = 1.0 + i * stagger_m;
    robot.limits = {1.0, 3.0, kBrakeMps2, 0.25};
    out.robots.push_back(robot);
  }
  for (int i = 1; i <= 9; ++i) {
    out.targets.emplace_back().name = std::string("W") + std::to_string(i);
  }
  return out;
}

FlightBench::FlightBench(std::uint64_t seed, bool trusts_plans, double stagger_m)
    : FlightBench(seed, scenario(stagger_m), kLeadS) {
  trusts_plans_ = trusts_plans;
  for (Vehicle& vehicle : vehicles_) {
    restart_driver(vehicle);
  }
}

FlightBench::FlightBench(std::uint64_t seed, scenario::Scenario scenario, double lead_s)
    : scenario_(std::move(scenario)), lead_s_(lead_s), random_(seed) {
  for (const scenario::RobotSpec& robot : scenario_.robots) {
    Vehicle vehicle;
    vehicle.name = robot.name;
    vehicle.lane_y_m = robot.start.y_m;
    vehicle.position_m = {robot.start.x_m, robot.start.y_m, 0.0};
    vehicle.yaw_rad = robot.start.yaw_rad;
    vehicles_.push_back(std::move(vehicle));
  }
}

void FlightBench::restart_driver(Vehicle& vehicle) {
  drivers::SafetyLimits limits = drivers::limits_for(scenario_, vehicle.name);
  limits.plan_separation_m = trusts_plans_ ? 0.01 : limits.plan_separation_m;
  vehicle.guard = std::make_unique<drivers::FlightGuard>(scenario_, vehicle.name, limits);
  vehicle.out = {};
}

Time FlightBench::now() const { return kStart + from_seconds(time_s()); }

Vehicle& FlightBench::vehicle(const std::string& name) {
  return *std::find_if(vehicles_.begin(), vehicles_.end(),
                       [&](const Vehicle& each) { return each.name == name; });
}

void FlightBench::fly_up(double until_s) {
  while (time_s() < until_s) {
    if (ticks_ == 80) {
      room_.command = OperatorAction::kArm;
    } else if (ticks_ == 90) {
      room_.command = OperatorAction::kTakeOff;
    } else if (ticks_ == kLeadTicks + 350) {
      room_.command = OperatorAction::kFollow;
    }
    tick();
  }
}

void FlightBench::tick() {
  mocap();
  plan();
  operate();
  move();
  check();
  for (Vehicle& vehicle : vehicles_) {
    vehicle.knobs = {};
  }
  room_ = {};
  ++ticks_;
}

void FlightBench::move() {
  for (Vehicle& vehicle : vehicles_) {
    autopilot(vehicle);
  }
  for (Vehicle& vehicle : vehicles_) {
    if (!vehicle.knobs.is_stalled) {
      vehicle.guard->on_map(!vehicle.knobs.map_differs);
      vehicle.guard->on_processor_wait(vehicle.knobs.processor_wait_s);
      if (vehicle.knobs.is_ending) {
        vehicle.guard->on_end_request();
      }
      vehicle.out = vehicle.guard->tick(now());
    }
  }
  for (Vehicle& vehicle : vehicles_) {
    fly(vehicle);
  }
}

void FlightBench::run(double seconds, const std::function<void()>& set_knobs) {
  for (const double end_s = time_s() + seconds - 0.5 * kTickS; time_s() < end_s;) {
    set_knobs();
    tick();
  }
}

void FlightBench::send_command(OperatorAction action, const std::string& addressee) {
  room_.command = action;
  room_.command_recipient = addressee;
}

bool FlightBench::has_reason(const Vehicle& vehicle, const std::string& reason, Time now) {
  const auto reasons = vehicle.guard->status(now).reasons;
  return std::find(reasons.begin(), reasons.end(), reason) != reasons.end();
}

void FlightBench::mocap() {
  const bool is_due = ticks_ % room_.mocap_every == 0 && !room_.mocap_dead &&
                      random_.uniform(0.0, 1.0) >= room_.frame_loss;
  if (is_due) {
    models::MocapFrame frame;
    frame.stamp.time = now() + room_.mocap_clock;
    frame.stamp.sequence = frame_number_;
    frame.frame_number = frame_number_++;
    for (const Vehicle& vehicle : vehicles_) {
      models::MocapBody body;
      body.name = vehicle.name;
      const Eigen::Vector3d noise_m = 0.0005 * random_.vector<3>(-1.0, 1.0);
      body.world_from_body = shown_pose(shown_vehicle(vehicle));
      body.world_from_body.translation_m += noise_m;
      frame.bodies.push_back(body);
    }
    corrupt(frame);
    const Time arrives = now() + from_seconds(room_.mocap_latency_s +
                                              random_.uniform(0.0, 1.0) * room_.mocap_jitter_s);
    newest_arrival_ = std::max(newest_arrival_, arrives);  // the network preserves order
    frame.arrival = newest_arrival_;
    frames_.push_back({newest_arrival_, frame});
  }
  while (!frames_.empty() && frames_.front().arrives <= now()) {
    deliver(frames_.front().frame);
    frames_.erase(frames_.begin());
  }
}

void FlightBench::deliver(const models::MocapFrame& frame) {
  for (Vehicle& vehicle : vehicles_) {
    if (!vehicle.knobs.is_stalled) {
      (void)vehicle.guard->on_mocap(frame, now() - 1'000 * Duration{room_.mocap_age_ms});
    }
  }
}

bool FlightBench::deliver(Vehicle& vehicle, const models::RobotPlan& plan) {
  const bool is_taken = vehicle.guard->on_plan(plan, now()) == drivers::PlanVerdict::kAccepted;
  for (Vehicle& teammate : vehicles_) {
    if (teammate.name != vehicle.name && !teammate.knobs.drops_teammate_plans) {
      teammate.guard->on_teammate_plan(plan, now());
    }
  }
  return is_taken;
}

void FlightBench::deliver(const models::OperatorCommand& command) {
  for (Vehicle& vehicle : vehicles_) {
    if (!vehicle.knobs.is_stalled) {
      (void)vehicle.guard->on_command(command, now());
    }
  }
}

std::int64_t FlightBench::count_of(const Vehicle& vehicle, const std::string& counter) const {
  for (const models::NamedCount& each : vehicle.guard->counters()) {
    if (each.name == counter) {
      return each.count;
    }
  }
  return -1;
}

Vehicle& FlightBench::connected_driver(const Vehicle& vehicle) {
  const bool is_swapped = wiring_.swaps_addresses && vehicle.name != "Q3";
  return this->vehicle(!is_swapped ? vehicle.name : vehicle.name == "Q1" ? "Q2" : "Q1");
}

Vehicle& FlightBench::shown_vehicle(const Vehicle& named) {
  const bool is_swapped = wiring_.swaps_names && named.name != "Q3";
  return vehicle(!is_swapped ? named.name : named.name == "Q1" ? "Q2" : "Q1");
}

Pose3 FlightBench::shown_pose(const Vehicle& vehicle) const {
  const Eigen::Matrix3d& turn = wiring_.mocap_from_world;
  Pose3 pose = lift({vehicle.position_m.x(), vehicle.position_m.y(), vehicle.yaw_rad},
                    vehicle.position_m.z());
  pose.translation_m = turn * pose.translation_m;
  if (turn.determinant() > 0.0) {
    pose.rotation = Eigen::Quaterniond(turn) * pose.rotation;
  } else if (wiring_.mirrors_attitude) {
    pose.rotation = Eigen::Quaterniond(turn * pose.rotation.toRotationMatrix() * turn);
  }
  return pose;
}

void FlightBench::corrupt(models::MocapFrame& frame) {
  const std::vector<models::MocapBody> honest = frame.bodies;
  for (std::size_t i = 0; i < vehicles_.size(); ++i) {
    Vehicle& vehicle = vehicles_[i];
    const VehicleKnobs& knobs = vehicle.knobs;
    Pose3& pose = frame.bodies[i].world_from_body;
    for (const models::MocapBody& other : honest) {
      if (other.name == knobs.swapped_with) {
        pose = other.world_from_body;
      }
    }
    pose.translation_m.x() += knobs.offset_m;
    pose.rotation = pose.rotation * Eigen::Quaterniond(Eigen::AngleAxisd(knobs.body_tilt_rad,
                                                                         Eigen::Vector3d::UnitX()));
    if (!has(knobs, BodyFault::kFrozen) && !has(knobs, BodyFault::kForeign)) {
      vehicle.frozen = pose;
    }
    for (const BodyFault fault : knobs.body) {
      switch (fault) {
        case BodyFault::kNone:
        case BodyFault::kAbsent:
        case BodyFault::kDuplicated:
          break;
        case BodyFault::kOccluded:
          frame.bodies[i].occluded = true;
          break;
        case BodyFault::kFrozen:
          pose = vehicle.frozen;
          break;
        case BodyFault::kForeign:
          pose = vehicle.frozen;
          pose.translation_m += Eigen::Vector3d(1e-6 * static_cast<double>(ticks_ % 7), 0.24, 0.0);
          break;
        case BodyFault::kNotANumber:
          pose.translation_m.y() = std::nan("");
          break;
        case BodyFault::kZeroQuaternion:
          pose.rotation.coeffs().setZero();
          break;
        case BodyFault::kLongQuaternion:
          pose.rotation.coeffs() *= 1.5;
          break;
        case BodyFault::kMillimetres:
          pose.translation_m *= 1000.0;
          break;
        case BodyFault::kMirrored:
          pose.translation_m.y() = -pose.translation_m.y() - 0.7;
          break;
        case BodyFault::kUpsideDown:
          pose.rotation = pose.rotation * Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0);
          break;
      }
    }
  }
  for (std::size_t i = vehicles_.size(); i-- > 0;) {
    if (has(vehicles_[i].knobs, BodyFault::kAbsent)) {
      frame.bodies.erase(frame.bodies.begin() + static_cast<std::ptrdiff_t>(i));
    } else if (has(vehicles_[i].knobs, BodyFault::kDuplicated)) {
      models::MocapBody twin = frame.bodies[i];
      twin.world_from_body.translation_m.x() += 0.4;
      frame.bodies.push_back(twin);
    }
  }
  for (std::size_t i = 0; i < room_.target_positions_m.size(); ++i) {
    models::MocapBody walker;
    walker.name = scenario_.targets.at(i).name;
    walker.world_from_body.translation_m = room_.target_positions_m[i];
    frame.bodies.push_back(walker);
  }
  if (room_.unknown_body_m) {
    models::MocapBody stranger;
    stranger.name = "STRANGER";
    stranger.world_from_body.translation_m = *room_.unknown_body_m;
    frame.bodies.push_back(stranger);
  }
  if (room_.ghost_body) {
    models::MocapBody ghost = honest[0];
    ghost.name = "GHOST";
    ghost.world_from_body.translation_m.x() += 0.1;
    frame.bodies.push_back(ghost);
  }
}

// Returns a plan along the lane to its end, a turn, and back. The plan starts at the vehicle's
// predicted position if the vehicle tracks its present plan, otherwise at its current position.
models::RobotPlan FlightBench::nominal_plan(Vehicle& vehicle, Time start) {
  models::RobotPlan plan;
  plan.robot = vehicle.name;
  plan.stamp.run_id = kPlannerRun;
  plan.stamp.sequence = vehicle.sequence++;
  plan.stamp.time = start;
  plan.round = vehicle.round++;
  Pose2 from{vehicle.position_m.x(), vehicle.position_m.y(), vehicle.yaw_rad};
  if (!vehicle.sent.empty()) {
    const Pose2 expected = models::at(vehicle.sent.back().trajectory, start).world_from_body;
    const Pose2 now_expected = models::at(vehicle.sent.back().trajectory, now()).world_from_body;
    if ((now_expected.position_m() - from.position_m()).norm() < 0.3) {
      from = expected;
    }
  }
  plan.trajectory.start_time = start;
  plan.trajectory.start = from;
  plan.trajectory.height_m = scenario_.find_robot(vehicle.name)->height_m;
  const double end_m = vehicle.heads_east ? kLaneHalfM : -kLaneHalfM;
  if (std::abs(end_m - from.x_m) < 0.4) {
    vehicle.heads_east = !vehicle.heads_east;
  }
  const double goal_yaw_rad = vehicle.heads_east ? 0.0 : kPi;
  const double turn_rad = wrap_to_pi(goal_yaw_rad - from.yaw_rad);
  auto& segments = plan.trajectory.segments;
  if (std::abs(turn_rad) > 1e-3) {
    segments.push_back(
        {{0.0, std::copysign(kTurnRadps, turn_rad)}, std::abs(turn_rad) / kTurnRadps, 0.0});
  }
  const double goal_m = vehicle.heads_east ? kLaneHalfM : -kLaneHalfM;
  const double room_m = std::abs(goal_m - from.x_m) - kSpeedMps * kSpeedMps / (2 * kBrakeMps2);
  if (room_m > 0.0) {
    segments.push_back({{kSpeedMps, 0.0}, std::min(room_m / kSpeedMps, 1.5), 0.0});
    segments.push_back(models::brake(kSpeedMps, kBrakeMps2).front());
  }
  return plan;
}

void FlightBench::corrupt(models::RobotPlan& plan, Vehicle& vehicle) {
  models::Trajectory& way = plan.trajectory;
  const Pose2 from = way.start;
  const auto turn_to = [&](const Eigen::Vector2d& goal_m) {
    return wrap_to_pi(std::atan2(goal_m.y() - from.y_m, goal_m.x() - from.x_m) - from.yaw_rad);
  };
  const auto straight_to = [&](double x_m, double y_m) {
    const double turn_rad = turn_to({x_m, y_m});
    way.segments = {
        {{0.0, std::copysign(kTurnRadps, turn_rad)}, std::abs(turn_rad) / kTurnRadps, 0.0},
        {{kSpeedMps, 0.0}, std::hypot(x_m - from.x_m, y_m - from.y_m), 0.0},
        models::brake(kSpeedMps, kBrakeMps2).front()};
  };
  switch (vehicle.knobs.plan) {
    case PlanFault::kNone:
    case PlanFault::kDropped:
      break;
    case PlanFault::kNotANumber:
      way.segments = {{{std::nan(""), 0.0}, 1.0, 0.0}};
      break;
    case PlanFault::kTooFast:
      way.segments = {{{3.0, 0.0}, 0.3, 0.0}, models::brake(3.0, kBrakeMps2).front()};
      break;
    case PlanFault::kTooTight:
      way.segments = {{{1.0, 20.0}, 0.5, 0.0}, models::brake(1.0, kBrakeMps2).front()};
      break;
    case PlanFault::kNoStop:
      way.segments = {{{1.0, 0.0}, 1.0, 0.0}};
      break;
    case PlanFault::kJumps:
      way.start.x_m += way.start.x_m > 0.0 ? -1.0 : 1.0;
      break;
    case PlanFault::kLeavesFence:
      straight_to(from.x_m, vehicle.lane_y_m < 0.0 ? -3.0 : 3.0);
      break;
    case PlanFault::kMeetsObstacle:
      straight_to(0.0, 0.65);
      break;
    case PlanFault::kMeetsTeammate: {
      // Finds the meeting point by iteration: the predicted position of the other vehicle at the
      // time at which this vehicle arrives at the point.
      const Vehicle& other = vehicles_[vehicle.name == "Q1" ? 1 : 0];
      Eigen::Vector2d meeting_m = other.position_m.head<2>();
      for (int i = 0; i < 10; ++i) {
        const double way_s = std::abs(turn_to(meeting_m)) / kTurnRadps +
                             (meeting_m - from.position_m()).norm() / kSpeedMps;
        meeting_m = models::at(other.sent.back().trajectory, way.start_time + from_seconds(way_s))
                        .world_from_body.position_m();
      }
      straight_to(meeting_m.x(), meeting_m.y());
      break;
    }
    case PlanFault::kHeadOn: {
      const Vehicle& other = vehicles_[vehicle.name == "Q1" ? 1 : 0];
      straight_to(other.position_m.x(), other.position_m.y());
      break;
    }
    case PlanFault::kWrongVehicle:
      plan.robot = "Q9";
      break;
    case PlanFault::kEmpty:
      way = {};
      break;
    case PlanFault::kHalfASecondOld:
      way.start_time -= from_seconds(1.0);
      break;
    case PlanFault::kReplayed:
      plan = vehicle.sent[vehicle.sent.size() - std::min<std::size_t>(vehicle.sent.size(), 4)];
      break;
  }
}

void FlightBench::plan() {
  if (ticks_ % kRoundTicks != kPublishTick) {
    return;
  }
  const Time start = now() + from_seconds(0.1);
  for (Vehicle& vehicle : vehicles_) {
    if (vehicle.knobs.planner_dead) {
      continue;
    }
    models::RobotPlan plan = nominal_plan(vehicle, start);
    const models::RobotPlan honest = plan;
    if (vehicle.knobs.plan != PlanFault::kNone) {
      corrupt(plan, vehicle);
    }
    plan.late = plan.late || vehicle.knobs.plan_late;
    const bool is_heard = vehicle.knobs.plan != PlanFault::kDropped && !vehicle.knobs.is_stalled;
    const bool is_taken = is_heard && deliver(vehicle, plan);
    if (is_taken || vehicle.sent.empty()) {
      vehicle.sent.push_back(honest);
    }
    if (vehicle.knobs.second_planner) {
      models::RobotPlan other = honest;
      other.stamp.run_id = kOtherPlannerRun;
      other.trajectory.segments.clear();
      deliver(vehicle, other);
    }
  }
}

void FlightBench::send_command(OperatorAction action, std::int64_t run_id, std::int64_t& sequence) {
  models::OperatorCommand command;
  command.stamp = {now(), run_id, sequence++};
  command.action = action;
  command.robot = run_id == kStationRun ? room_.command_recipient : "";
  deliver(command);
}

void FlightBench::operate() {
  if (ticks_ % 20 == 0 && !room_.operator_silent) {
    const std::string addressee = std::exchange(room_.command_recipient, "");
    send_command(OperatorAction::kHeartbeat, kStationRun, command_sequence_);
    room_.command_recipient = addressee;
  }
  if (room_.command) {
    send_command(*room_.command, kStationRun, command_sequence_);
  }
  if (room_.second_station && ticks_ % 20 == 5) {
    send_command(OperatorAction::kHeartbeat, kOtherStationRun, other_sequence_);
    if (room_.second_arms) {
      send_command(OperatorAction::kArm, kOtherStationRun, other_sequence_);
    }
    send_command(OperatorAction::kFollow, kOtherStationRun, other_sequence_);
  }
  if (room_.second_command) {
    send_command(*room_.second_command, kOtherStationRun, other_sequence_);
  }
}

}  // namespace vantage::test
