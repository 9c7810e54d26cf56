#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <vector>

#include "core/index.hpp"
#include "models/exchange/compact_belief.hpp"
#include "models/exchange/messages.hpp"
#include "models/exchange/pose_messages.hpp"

// Content of a message as a flat list of bits. Lists compare two messages exactly (NaN included)
// and reveal a field that both directions of a conversion omit.

namespace vantage::test {

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
