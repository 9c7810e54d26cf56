#pragma once

#include <bit>
#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "models/exchange/compact_belief.hpp"
#include "models/exchange/messages.hpp"
#include "models/exchange/pose_messages.hpp"

// Random valid messages with every field set, and their content as a flat list of bits. The lists
// compare two messages exactly (NaN included) and reveal a field that both directions of a
// conversion omit.

namespace vantage::test {

class Sampler {
 public:
  explicit Sampler(std::uint64_t seed) : rng_(seed) {}

  double real(double min = -50.0, double max = 50.0) {
    return std::uniform_real_distribution<double>(min, max)(rng_);
  }
  std::int64_t whole(std::int64_t min, std::int64_t max) {
    return std::uniform_int_distribution<std::int64_t>(min, max)(rng_);
  }
  int small(int min, int max) { return static_cast<int>(whole(min, max)); }
  bool coin() { return whole(0, 1) == 1; }
  Time time() { return from_utime(whole(0, 2'000'000'000'000'000)); }
  std::string text(const std::string& stem) { return stem + std::to_string(whole(0, 999)); }
  models::Stamp stamp() { return {time(), whole(1, std::int64_t{1} << 62), whole(0, 1'000'000)}; }
  Pose2 pose2() { return {real(), real(), real(-3.14, 3.14)}; }
  Pose3 pose3() {
    const Eigen::Quaterniond q(real(), real(), real(), real());
    return {{real(), real(), real()}, q.normalized()};
  }
  models::Viewpoint viewpoint() { return {pose2(), real(0, 3)}; }
  /// Returns the random positive definite matrix G Gᵀ + I, symmetrised exactly.
  Eigen::MatrixXd definite(int dim) {
    Eigen::MatrixXd G(dim, dim);
    for (int i = 0; i < dim * dim; ++i) {
      G(i) = real(-2, 2);
    }
    const Eigen::MatrixXd M = G * G.transpose() + Eigen::MatrixXd::Identity(dim, dim);
    return 0.5 * (M + M.transpose());
  }
  Eigen::VectorXd vector(int dim) {
    Eigen::VectorXd v(dim);
    for (int i = 0; i < dim; ++i) {
      v(i) = real();
    }
    return v;
  }
  std::vector<models::InputRef> inputs() {
    std::vector<models::InputRef> refs;
    for (int i = small(0, 4); i > 0; --i) {
      refs.push_back({text("BELIEF_Q"), whole(1, 1'000'000), whole(0, 1'000'000)});
    }
    return refs;
  }
  /// Returns a message with only the robot's name set.
  template <class Content>
  Content of_robot() {
    Content content;
    content.stamp = stamp();
    content.robot = text("Q");
    return content;
  }
  template <class Content>
  Content round_of() {
    auto content = of_robot<Content>();
    content.round = whole(0, 1000);
    return content;
  }
  template <class Content>
  Content step_of() {
    auto content = of_robot<Content>();
    content.step = whole(0, 1000);
    content.viewpoint = viewpoint();
    return content;
  }

 private:
  std::mt19937_64 rng_;
};

template <class Message>
Message sample(Sampler& s);

template <>
inline models::MocapFrame sample(Sampler& s) {
  models::MocapFrame frame{s.stamp(), s.time(), s.whole(0, 1'000'000), {}};
  for (int i = s.small(0, 5); i > 0; --i) {
    frame.bodies.push_back({s.text("rover"), s.pose3(), s.coin()});
  }
  return frame;
}

template <>
inline models::RobotMeasurement sample(Sampler& s) {
  models::RobotMeasurement set{s.stamp(), s.text("Q"), s.viewpoint(), s.coin(), {}, s.inputs()};
  for (int i = s.small(0, 5); i > 0; --i) {
    models::Detection detection;
    const int dim = s.small(1, 3);
    detection.target_id = s.small(models::kNoTargetId, 9);
    detection.measurement.z = s.vector(dim);
    detection.measurement.V = s.definite(dim);
    set.detections.push_back(detection);
  }
  return set;
}

template <>
inline models::RobotBelief sample(Sampler& s) {
  auto belief = s.step_of<models::RobotBelief>();
  belief.degree = s.small(0, 5);
  for (int i = 0, id = 0; i < s.small(0, 6); ++i, id += s.small(1, 3)) {
    const int dim = s.small(2, 4);
    models::TargetBelief target;
    target.target_id = id;
    target.information.vector = s.vector(dim);
    target.information.matrix = s.definite(dim);
    target.last_seen = s.time();
    belief.targets.push_back(target);
  }
  belief.grid = {{s.real(), s.real()}, s.real(0.1, 1.0), s.small(1, 9), s.small(1, 9)};
  for (int i = 0; i < belief.grid.size(); ++i) {
    belief.last_seen_utime.push_back(s.coin() ? 0 : to_utime(s.time()));
  }
  belief.inputs = s.inputs();
  return belief;
}

template <>
inline models::BeliefMixture sample(Sampler& s) {
  models::BeliefMixture mixture{s.stamp(), s.text("Q"), s.whole(0, 1'000'000), {}};
  for (int i = 0, id = 0; i < s.small(0, 6); ++i, id += s.small(1, 3)) {
    const int dim = s.small(2, 4);
    const int components = s.small(1, 8);
    models::TargetMixture target{id, s.real(0.1, 1.0), {}};
    for (int k = 0; k < components; ++k) {
      target.components.push_back({1.0 / components, {s.vector(dim), s.definite(dim)}});
    }
    mixture.targets.push_back(target);
  }
  return mixture;
}

template <>
inline models::OdometryReport sample(Sampler& s) {
  auto odometry = s.of_robot<models::OdometryReport>();
  odometry.kind = static_cast<models::OdometryKind>(s.small(0, 1));
  if (odometry.kind == models::OdometryKind::kIncrement) {
    odometry.interval = Duration{s.whole(1, 1'000'000)};
  }
  odometry.motion_body = s.vector(3);
  odometry.covariance = s.definite(3);
  return odometry;
}

template <>
inline models::PoseEstimate sample(Sampler& s) {
  auto estimate = s.of_robot<models::PoseEstimate>();
  estimate.source = static_cast<models::PoseSource>(s.small(0, 2));
  estimate.world_from_body = s.pose2();
  estimate.covariance = s.definite(3);
  estimate.age_s = s.real(0.0, 9.0);
  estimate.increments_from = s.time();
  estimate.increment = Duration{s.whole(1, 1'000'000)};
  for (int i = s.small(0, 5); i > 0; --i) {
    estimate.increments.emplace_back(s.vector(3));
  }
  Time time = s.time();
  for (int i = s.small(0, 5); i > 0; --i) {
    time += Duration{s.whole(0, 1'000'000)};
    estimate.sightings.push_back({time, s.small(0, 99), s.real(0.1, 9.0), s.real(-3.0, 3.0)});
  }
  estimate.step = s.whole(0, 99);
  estimate.inputs = s.inputs();
  return estimate;
}

template <>
inline models::SightingReport sample(Sampler& s) {
  auto report = s.of_robot<models::SightingReport>();
  Time time = s.time();
  for (int i = s.small(0, 5); i > 0; --i) {
    time += Duration{s.whole(0, 1'000'000)};
    report.sightings.push_back({time, s.small(0, 99), s.real(0.1, 9.0), s.real(-3.0, 3.0)});
  }
  return report;
}

template <>
inline models::RangeScan sample(Sampler& s) {
  models::RangeScan scan{s.stamp(),        s.text("Q"), s.viewpoint(), s.coin(), s.real(0.1, 6.28),
                         s.real(0.5, 9.0), {},          s.inputs()};
  for (int i = scan.jammed ? 0 : s.small(1, 9); i > 0; --i) {
    scan.ranges_m.push_back(s.real(-0.1, 9.0));
  }
  return scan;
}

template <>
inline models::RobotMap sample(Sampler& s) {
  auto map = s.step_of<models::RobotMap>();
  map.grid = {{s.real(), s.real()}, s.real(0.1, 1.0), s.small(1, 9), s.small(1, 9)};
  for (int i = 0; i < map.grid.size(); ++i) {
    map.own_looks.push_back(static_cast<std::int16_t>(s.small(-32768, 32767)));
    map.team_looks.push_back(static_cast<std::int16_t>(s.small(-32768, 32767)));
  }
  map.entropy_nats = s.real(0, 999);
  map.inputs = s.inputs();
  return map;
}

template <>
inline models::RobotPlan sample(Sampler& s) {
  auto plan = s.round_of<models::RobotPlan>();
  plan.source = static_cast<models::PlanSource>(s.small(0, 2));
  plan.trajectory.start_time = plan.stamp.time;
  plan.trajectory.start = s.pose2();
  plan.trajectory.height_m = s.real(0, 3);
  for (int i = s.small(0, 14); i > 0; --i) {
    plan.trajectory.segments.push_back({{s.real(), s.real()}, s.real(0, 2), s.real(0, 3)});
  }
  plan.horizon_steps = s.small(1, 20);
  plan.step_s = s.real(0.1, 1.0);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  plan.cost = s.coin() ? s.real() : std::numeric_limits<double>::quiet_NaN();
  plan.lower_bound = s.coin() ? s.real() : -kInfinity;
  plan.epsilon = s.coin() ? s.real(0, 4) : kInfinity;
  plan.delta_m = s.coin() ? s.real(0, 4) : kInfinity;
  plan.passes = s.whole(0, 20);
  plan.nodes = s.whole(0, 1'000'000'000);
  plan.slot_start = s.time();
  plan.deadline = s.time();
  plan.finish = s.time();
  plan.late = s.coin();
  plan.inputs = s.inputs();
  return plan;
}

template <>
inline models::PlanProposal sample(Sampler& s) {
  return {s.stamp(), s.real(0, 99), sample<models::RobotPlan>(s)};
}

template <>
inline models::TeamProposal sample(Sampler& s) {
  auto proposal = s.round_of<models::TeamProposal>();
  proposal.value_nats = s.real();
  for (int i = s.small(0, 4); i > 0; --i) {
    models::TeamChoice choice;
    choice.robot = "Q" + std::to_string(i);
    choice.trajectory = {proposal.stamp.time, s.pose2(), s.real(0, 3), {}};
    for (int k = s.small(0, 4); k > 0; --k) {
      choice.trajectory.segments.push_back({{s.real(), s.real()}, s.real(0, 2), s.real(0, 3)});
    }
    choice.information_nats = s.real(0, 99);
    choice.energy_nats = s.real(0, 99);
    proposal.choices.push_back(choice);
  }
  for (int i = s.small(0, 5); i > 0; --i) {
    proposal.history.push_back(s.whole(0, std::int64_t{1} << 62));
  }
  proposal.nodes = s.whole(0, 1'000'000'000);
  proposal.inputs = s.inputs();
  return proposal;
}

template <>
inline models::VehicleStatus sample(Sampler& s) {
  models::VehicleStatus status{
      s.stamp(),       s.text("Q"), static_cast<models::FlightState>(s.small(0, 4)),
      s.real(0, 1),    s.pose2(),   s.real(0, 3),
      s.whole(-1, 99), {}};
  for (int i = s.small(0, 3); i > 0; --i) {
    status.reasons.push_back(s.text("pose älter als "));
  }
  return status;
}

template <>
inline models::OperatorCommand sample(Sampler& s) {
  return {s.stamp(), static_cast<models::OperatorAction>(s.small(0, 6)), s.coin() ? "" : "Q1"};
}

template <>
inline models::TruthFrame sample(Sampler& s) {
  models::TruthFrame truth{s.stamp(), {}};
  for (int i = s.small(0, 5); i > 0; --i) {
    truth.bodies.push_back({s.text("rover"), s.small(-1, 9), s.pose3(), s.vector(3)});
  }
  return truth;
}

template <>
inline models::CollisionReport sample(Sampler& s) {
  return {s.stamp(), static_cast<models::CollisionKind>(s.small(0, 1)), s.text("Q"),
          s.text("obstacle:"), s.real()};
}

template <>
inline models::AttackNotice sample(Sampler& s) {
  models::AttackNotice attack{s.stamp(), {}};
  for (int i = s.small(0, 3); i > 0; --i) {
    attack.jammed.push_back(s.text("Q"));
  }
  return attack;
}

template <>
inline models::ProcessHealth sample(Sampler& s) {
  models::ProcessHealth health{s.stamp(),
                               s.text("PLANNER_Q"),
                               static_cast<models::ProcessState>(s.small(0, 3)),
                               {},
                               s.whole(0, 999),
                               s.real(0, 1),
                               s.whole(0, 99)};
  for (int i = s.small(0, 5); i > 0; --i) {
    health.counters.push_back({s.text("VICON.lost"), s.whole(-5, 999)});
  }
  return health;
}

template <>
inline models::HostReport sample(Sampler& s) {
  models::HostReport report{s.stamp(), s.text("LAB"), {}};
  for (int i = s.small(0, 5); i > 0; --i) {
    report.processes.push_back(
        {s.text("planner Q"), static_cast<models::SupervisedPhase>(s.small(0, 3)), s.small(0, 9),
         s.real(0, 60), s.real(0, 2), s.whole(0, 1'000'000'000), s.text("signal ")});
  }
  return report;
}

template <>
inline models::ScenarioNotice sample(Sampler& s) {
  return {s.stamp(), s.text("name: two rovers\nseed: "), s.text("0.1."), s.text("demo")};
}

/// The exact content of a message, field by field.
class Flat {
 public:
  template <class Message>
  static std::vector<std::string> of(const Message& message) {
    Flat flat;
    flat.add(message.stamp);
    flat.fields(message);
    return flat.list_;
  }

 private:
  void add(double x) { list_.push_back(std::to_string(std::bit_cast<std::uint64_t>(x))); }
  void add(std::int64_t x) { list_.push_back(std::to_string(x)); }
  void add(int x) { add(std::int64_t{x}); }
  void add(std::uint8_t x) { add(std::int64_t{x}); }
  void add(std::int16_t x) { add(std::int64_t{x}); }
  void add(bool x) { list_.emplace_back(x ? "yes" : "no"); }
  void add(Time x) { add(to_utime(x)); }
  void add(const std::string& x) { list_.push_back(x); }
  void add(const models::Stamp& x) { all(x.time, x.run_id, x.sequence); }
  void add(const Pose2& x) { all(x.x_m, x.y_m, x.yaw_rad); }
  void add(const Pose3& x) {
    add_matrix(x.translation_m);
    add_matrix(x.rotation.coeffs());
  }
  void add(const models::Viewpoint& x) { all(x.world_from_body, x.height_m); }
  void add(const models::InputRef& x) { all(x.channel, x.run_id, x.sequence); }
  void add(const models::NamedCount& x) { all(x.name, x.count); }
  void add(const models::SupervisedProcess& x) {
    all(x.name, static_cast<int>(x.phase), x.restarts, x.down_s, x.cpu_share, x.memory_bytes,
        x.last_end);
  }
  void add(const models::MocapBody& x) { all(x.name, x.world_from_body, x.occluded); }
  void add(const models::PlanSegment& x) {
    all(x.control.speed_mps, x.control.yaw_rate_radps, x.duration_s, x.brake_mps2);
  }
  void add(const models::TeamChoice& x) {
    all(x.robot, x.trajectory.start_time, x.trajectory.start, x.trajectory.height_m,
        x.trajectory.segments, x.information_nats, x.energy_nats);
  }
  void add(const models::Detection& x) {
    add(x.target_id);
    add_matrix(x.measurement.z);
    add_matrix(x.measurement.V);
  }
  void add(const models::Sighting& x) { all(x.time, x.id, x.range_m, x.bearing_rad); }
  void add(const models::TargetBelief& x) {
    all(x.target_id, x.last_seen);
    add_matrix(x.information.vector);
    add_matrix(x.information.matrix);
  }
  void add(const models::CompactTarget& x) {
    all(x.target_id, x.dim, static_cast<std::int64_t>(x.unseen_ms));
    for (int i = 0; i < models::kMaxTargetDim; ++i) {
      all(static_cast<double>(x.mean[index(i)]), x.sigma_code[index(i)]);
    }
    for (const std::int16_t code : x.correlation_code) {
      add(code);
    }
  }
  void add(const models::Component& x) {
    all(x.weight);
    add_matrix(x.belief.mean);
    add_matrix(x.belief.covariance);
  }
  void add(const models::TargetMixture& x) { all(x.target_id, x.existence, x.components); }
  void add(const models::TruthBody& x) {
    all(x.name, x.target_id, x.world_from_body);
    add_matrix(x.velocity_world_mps);
  }
  template <class T>
  void add(const std::vector<T>& x) {
    add(static_cast<std::int64_t>(x.size()));
    for (const T& each : x) {
      add(each);
    }
  }
  template <class M>
  void add_matrix(const M& x) {
    all(static_cast<std::int64_t>(x.rows()), static_cast<std::int64_t>(x.cols()));
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      add(double{x(i)});
    }
  }
  template <class... T>
  void all(const T&... x) {
    (add(x), ...);
  }

  void fields(const models::MocapFrame& x) { all(x.arrival, x.frame_number, x.bodies); }
  void fields(const models::RobotMeasurement& x) {
    all(x.robot, x.viewpoint, x.jammed, x.detections, x.inputs);
  }
  void fields(const models::RobotBelief& x) {
    all(x.robot, x.step, x.viewpoint, x.degree, x.targets);
    add_matrix(x.grid.origin_m);
    all(x.grid.resolution_m, x.grid.columns, x.grid.rows, x.last_seen_utime, x.inputs);
  }
  void fields(const models::CompactBelief& x) {
    all(x.robot, x.step, x.viewpoint, x.targets);
    add_matrix(x.grid.origin_m);
    all(x.grid.resolution_m, x.grid.columns, x.grid.rows, x.runs);
  }
  void fields(const models::BeliefMixture& x) { all(x.robot, x.step, x.targets); }
  void fields(const models::OdometryReport& x) {
    all(x.robot, static_cast<int>(x.kind), to_seconds(x.interval));
    add_matrix(x.motion_body);
    add_matrix(x.covariance);
  }
  void fields(const models::PoseEstimate& x) {
    all(x.robot, static_cast<int>(x.source), x.world_from_body);
    add_matrix(x.covariance);
    all(x.age_s, x.increments_from, to_seconds(x.increment), x.sightings, x.step, x.inputs);
    for (const Eigen::Vector3d& increment : x.increments) {
      add_matrix(increment);
    }
  }
  void fields(const models::SightingReport& x) { all(x.robot, x.sightings); }
  void fields(const models::RangeScan& x) {
    all(x.robot, x.viewpoint, x.jammed, x.field_of_view_rad, x.range_max_m, x.ranges_m, x.inputs);
  }
  void fields(const models::RobotMap& x) {
    all(x.robot, x.step, x.viewpoint);
    add_matrix(x.grid.origin_m);
    all(x.grid.resolution_m, x.grid.columns, x.grid.rows, x.own_looks, x.team_looks, x.entropy_nats,
        x.inputs);
  }
  void fields(const models::RobotPlan& x) {
    all(x.robot, x.round, static_cast<int>(x.source), x.trajectory.start_time, x.trajectory.start,
        x.trajectory.height_m, x.trajectory.segments, x.horizon_steps, x.step_s, x.cost,
        x.lower_bound, x.epsilon, x.delta_m, x.passes, x.nodes, x.slot_start, x.deadline, x.finish,
        x.late, x.inputs);
  }
  void fields(const models::PlanProposal& x) {
    all(x.value_nats, x.plan.stamp.time);
    fields(x.plan);
  }
  void fields(const models::TeamProposal& x) {
    all(x.robot, x.round, x.value_nats, x.choices, x.history, x.nodes, x.inputs);
  }
  void fields(const models::VehicleStatus& x) {
    all(x.robot, static_cast<int>(x.state), x.battery_share, x.setpoint, x.setpoint_height_m,
        x.plan_round, x.reasons);
  }
  void fields(const models::OperatorCommand& x) { all(static_cast<int>(x.action), x.robot); }
  void fields(const models::TruthFrame& x) { all(x.bodies); }
  void fields(const models::CollisionReport& x) {
    all(static_cast<int>(x.kind), x.body_a, x.body_b, x.distance_m);
  }
  void fields(const models::AttackNotice& x) { all(x.jammed); }
  void fields(const models::ProcessHealth& x) {
    all(x.process, static_cast<int>(x.state), x.counters, x.loops, x.loop_worst_s,
        x.deadlines_missed);
  }
  void fields(const models::HostReport& x) { all(x.host, x.processes); }
  void fields(const models::ScenarioNotice& x) { all(x.yaml, x.version, x.process); }

  std::vector<std::string> list_;
};

}  // namespace vantage::test
