#pragma once

#include <cstdint>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "models/exchange/messages.hpp"
#include "models/exchange/pose_messages.hpp"

// Random valid messages with every field set.

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

}  // namespace vantage::test
