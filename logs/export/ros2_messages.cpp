#include "logs/export/ros2_messages.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Eigenvalues>

#include "logs/export/cdr.hpp"
#include "logs/export/ros2_definitions.hpp"
#include "models/belief/gaussian.hpp"
#include "models/mapping/beam.hpp"
#include "models/plan/plan.hpp"

namespace vantage::logs::ros2 {
namespace {

constexpr double kUnknownVariance = 1e6;  // m² and rad²; for quantities without an estimate

// Clamps the time to the range of 32-bit seconds (1901 to 2038).
Cdr& add_time(Cdr& out, Time time) {
  constexpr std::int64_t kPerSecond = 1'000'000;
  constexpr std::int64_t kLeast = kPerSecond * std::numeric_limits<std::int32_t>::min();
  constexpr std::int64_t kMost = kPerSecond * std::numeric_limits<std::int32_t>::max();
  const std::int64_t utime = std::clamp(to_utime(time), kLeast, kMost);
  const std::int64_t seconds = (utime >= 0 ? utime : utime - kPerSecond + 1) / kPerSecond;
  return out.number(static_cast<std::int32_t>(seconds))
      .number(static_cast<std::uint32_t>((utime - seconds * kPerSecond) * 1'000));
}

Cdr& add_header(Cdr& out, Time time, std::string_view frame) {
  return add_time(out, time).text(frame);
}

Cdr& add_place(Cdr& out, double x_m, double y_m, double z_m) {
  return out.number(x_m).number(y_m).number(z_m);
}

// Appends x, y, z, w as in geometry_msgs; vantage's messages use w, x, y, z.
Cdr& add_yaw(Cdr& out, double yaw_rad) {
  return out.number(0.0)
      .number(0.0)
      .number(std::sin(yaw_rad / 2.0))
      .number(std::cos(yaw_rad / 2.0));
}

void add_pose(Cdr& out, const Pose3& pose) {
  const auto& place_m = pose.translation_m;
  add_place(out, place_m.x(), place_m.y(), place_m.z());
  const auto& turn = pose.rotation;
  out.number(turn.x()).number(turn.y()).number(turn.z()).number(turn.w());
}

template <class Bodies, class IsKnown>
Message transforms(const std::string& topic, Time time, std::string_view world,
                   const Bodies& bodies, const IsKnown& is_known) {
  Cdr out;
  out.count(static_cast<std::size_t>(std::count_if(bodies.begin(), bodies.end(), is_known)));
  for (const auto& body : bodies) {
    if (is_known(body)) {
      add_header(out, time, world).text(body.name);
      add_pose(out, body.world_from_body);
    }
  }
  return {topic, "tf2_msgs/msg/TFMessage", time, out.bytes()};
}

Eigen::Index position_dim_of(const models::Gaussian& known) {
  return known.mean.size() == 3 ? 3 : 2;
}

Message pose_of(const models::RobotBelief& belief, const models::TargetBelief& target,
                const models::Gaussian& known, std::string_view world) {
  constexpr int kPoseDim = 6;
  const Eigen::Index position_dim = position_dim_of(known);
  Cdr out;
  add_header(out, belief.stamp.time, world);
  add_place(out, known.mean(0), known.mean(1), position_dim == 3 ? known.mean(2) : 0.0);
  add_yaw(out, 0.0);
  for (Eigen::Index i = 0; i < kPoseDim; ++i) {
    for (Eigen::Index j = 0; j < kPoseDim; ++j) {
      const bool is_known = i < position_dim && j < position_dim;
      out.number(is_known ? known.covariance(i, j) : (i == j ? kUnknownVariance : 0.0));
    }
  }
  return {"/" + belief.robot + "/target_" + std::to_string(target.target_id),
          "geometry_msgs/msg/PoseWithCovarianceStamped", belief.stamp.time, out.bytes()};
}

/// s; after this time the markers of a silent robot disappear
constexpr std::int32_t kMarkerLifetime_s = 2;
constexpr std::int32_t kAddMarker = 0;
constexpr std::int32_t kDeleteAllMarkers = 3;
constexpr std::int32_t kSphere = 2;

struct MarkerHead {
  Time time;
  std::string_view frame;
  std::string group;
  std::int32_t id = 0;
  std::int32_t action = kAddMarker;
};

/// Returns the ellipsoid with semi-axes of 2σ: its pose, and its diameters.
std::pair<Pose3, Eigen::Vector3d> ellipsoid_of(const models::Gaussian& known) {
  constexpr double kDiameterPerSigma = 4.0;
  constexpr double kFlatSigma_m = 0.01;  // assumed 1σ along z of a planar belief
  const Eigen::Index dim = position_dim_of(known);
  Eigen::Matrix3d covariance_m2 = Eigen::Matrix3d::Identity() * (kFlatSigma_m * kFlatSigma_m);
  covariance_m2.topLeftCorner(dim, dim) = known.covariance.topLeftCorner(dim, dim);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(covariance_m2);
  Eigen::Matrix3d rotation = axes.eigenvectors();
  rotation.col(2) *= rotation.determinant() < 0.0 ? -1.0 : 1.0;
  Pose3 pose;
  pose.translation_m.head(dim) = known.mean.head(dim);
  pose.rotation = Eigen::Quaterniond(rotation);
  return {pose, kDiameterPerSigma * axes.eigenvalues().cwiseMax(0.0).cwiseSqrt()};
}

/// Appends a marker without points, textures and meshes.
void add_marker(Cdr& out, const MarkerHead& head, const Pose3& pose,
                const Eigen::Vector3d& scale_m) {
  constexpr float kRed = 0.2F;
  constexpr float kGreen = 0.6F;
  constexpr float kBlue = 1.0F;
  constexpr float kAlpha = 0.5F;
  add_header(out, head.time, head.frame).text(head.group);
  out.number(head.id).number(kSphere).number(head.action);
  add_pose(out, pose);
  add_place(out, scale_m.x(), scale_m.y(), scale_m.z());
  out.number(kRed).number(kGreen).number(kBlue).number(kAlpha);
  out.number(kMarkerLifetime_s).number(std::uint32_t{0});  // seconds, nanoseconds
  out.number(std::uint8_t{0}).count(0).count(0).text("");  // frame_locked … texture_resource
  add_time(out, Time{}).text("").text("").count(0);        // texture: header, format, data
  out.count(0).text("").text("").text("").count(0);        // uv_coordinates … mesh_file
  out.number(std::uint8_t{0});                             // mesh_use_embedded_materials
}

std::string_view fields_of(std::string_view type) {
  const auto found = std::find_if(kDefinitions.begin(), kDefinitions.end(),
                                  [&](const Definition& each) { return each.type == type; });
  return found->fields;
}

/// Appends the definition of each message type in `fields` that is not yet in `appended`, each
/// followed by the definitions of the types that it contains.
void append_parts(std::string_view fields, std::vector<std::string_view>& appended,
                  std::string& text) {
  while (!fields.empty()) {
    const std::string_view type = fields.substr(0, fields.find_first_of(" ["));
    const bool is_message = type.find('/') != std::string_view::npos;
    if (is_message && std::find(appended.begin(), appended.end(), type) == appended.end()) {
      appended.push_back(type);
      text += std::string(80, '=') + "\nMSG: " + std::string(type) + "\n";
      text += fields_of(type);
      append_parts(fields_of(type), appended, text);
    }
    fields.remove_prefix(fields.find('\n') + 1);
  }
}

}  // namespace

std::string definition_of(std::string_view type) {
  const std::size_t package = type.find("/msg/");
  const std::string name = std::string(type.substr(0, package)) + "/" +
                           std::string(type.substr(package + std::string_view("/msg/").size()));
  std::string text{fields_of(name)};
  std::vector<std::string_view> appended;
  append_parts(fields_of(name), appended, text);
  return text;
}

std::vector<Message> to_ros2(const models::MocapFrame& frame, std::string_view world) {
  return {transforms("/tf", frame.stamp.time, world, frame.bodies,
                     [](const models::MocapBody& body) { return !body.occluded; })};
}

std::vector<Message> to_ros2(const models::TruthFrame& truth, std::string_view world) {
  return {transforms("/truth/tf", truth.stamp.time, world, truth.bodies,
                     [](const models::TruthBody&) { return true; })};
}

std::vector<Message> to_ros2(const models::RobotBelief& belief, std::string_view world) {
  std::vector<Message> out;
  for (const models::TargetBelief& target : belief.targets) {
    if (const auto known = models::to_gaussian(target.information)) {
      out.push_back(pose_of(belief, target, *known, world));
    }
  }
  return out;
}

Message markers_of(const models::RobotBelief& belief, std::string_view world) {
  std::vector<std::pair<int, models::Gaussian>> known;
  for (const models::TargetBelief& target : belief.targets) {
    if (const auto gaussian = models::to_gaussian(target.information)) {
      known.emplace_back(target.target_id, *gaussian);
    }
  }
  MarkerHead head{belief.stamp.time, world, belief.robot + "/beliefs"};
  Cdr out;
  out.count(known.size() + 1);
  head.action = kDeleteAllMarkers;
  add_marker(out, head, Pose3{}, Eigen::Vector3d::Zero());
  head.action = kAddMarker;
  for (const auto& [id, gaussian] : known) {
    head.id = id;
    const auto [pose, diameters_m] = ellipsoid_of(gaussian);
    add_marker(out, head, pose, diameters_m);
  }
  return {"/" + belief.robot + "/beliefs", "visualization_msgs/msg/MarkerArray", belief.stamp.time,
          out.bytes()};
}

std::vector<Message> poses_of(const models::MocapFrame& frame,
                              const std::vector<std::string>& robots, std::string_view world) {
  std::vector<Message> out;
  for (const std::string& robot : robots) {
    const models::MocapBody* const body = frame.find(robot);
    if (body != nullptr && !body->occluded) {
      Cdr cdr;
      add_header(cdr, frame.stamp.time, world);
      add_pose(cdr, body->world_from_body);
      out.push_back(
          {"/" + robot + "/pose", "geometry_msgs/msg/PoseStamped", frame.stamp.time, cdr.bytes()});
    }
  }
  return out;
}

std::vector<Message> to_ros2(const models::RangeScan& scan, std::string_view /*world*/) {
  if (scan.jammed || scan.ranges_m.empty()) {
    return {};
  }
  models::BeamSensor sensor;
  sensor.beams = static_cast<int>(scan.ranges_m.size());
  sensor.field_of_view_rad = scan.field_of_view_rad;
  const bool is_all_round = scan.field_of_view_rad > 2.0 * kPi - 1e-9;
  const double gaps = sensor.beams - (is_all_round ? 0 : 1);
  const double step_rad = gaps > 0.0 ? scan.field_of_view_rad / gaps : 0.0;
  // Bearings beyond ±π continue to increase, as LaserScan requires.
  const double first_rad = sensor.bearing_rad(0);
  Cdr out;
  add_header(out, scan.stamp.time, scan.robot);
  for (const double value : {first_rad, first_rad + (sensor.beams - 1) * step_rad, step_rad, 0.0,
                             0.0, 0.0, scan.range_max_m}) {
    out.number(static_cast<float>(value));
  }
  out.count(scan.ranges_m.size());
  for (const double range_m : scan.ranges_m) {
    out.number(static_cast<float>(range_m));
  }
  out.count(0);  // number of intensities
  return {{"/" + scan.robot + "/scan", "sensor_msgs/msg/LaserScan", scan.stamp.time, out.bytes()}};
}

std::vector<Message> to_ros2(const models::RobotMap& map, std::string_view world) {
  constexpr std::int8_t kFree = 0;
  constexpr std::int8_t kOccupied = 100;
  Cdr out;
  add_header(out, map.stamp.time, world);
  add_time(out, map.stamp.time).number(static_cast<float>(map.grid.resolution_m));
  out.number(static_cast<std::uint32_t>(map.grid.columns));
  out.number(static_cast<std::uint32_t>(map.grid.rows));
  add_place(out, map.grid.origin_m.x(), map.grid.origin_m.y(), 0.0);
  add_yaw(out, 0.0).count(map.team_looks.size());
  for (const std::int16_t looks : map.team_looks) {
    out.number(looks == 0 ? std::int8_t{-1} : (looks > 0 ? kOccupied : kFree));
  }
  return {{"/" + map.robot + "/map", "nav_msgs/msg/OccupancyGrid", map.stamp.time, out.bytes()}};
}

std::vector<Message> to_ros2(const models::RobotPlan& plan, std::string_view world) {
  const Time start = plan.trajectory.start_time;
  const Duration step = from_seconds(plan.step_s);
  constexpr int kPosesMax = 1'000;
  std::vector<Time> times{start};
  const Time end = models::end_time(plan.trajectory);
  while (times.back() < end && std::ssize(times) < kPosesMax) {
    times.push_back(std::min(times.back() + step, end));
  }
  Cdr out;
  add_header(out, start, world).count(times.size());
  for (const Time time : times) {
    const Pose2 pose = models::at(plan.trajectory, time).world_from_body;
    add_header(out, time, world);
    add_place(out, pose.x_m, pose.y_m, plan.trajectory.height_m);
    add_yaw(out, pose.yaw_rad);
  }
  return {{"/" + plan.robot + "/plan", "nav_msgs/msg/Path", start, out.bytes()}};
}

std::vector<Message> to_ros2(const models::VehicleStatus& status, std::string_view /*world*/) {
  constexpr auto kNan = std::numeric_limits<float>::quiet_NaN();
  Cdr out;
  add_header(out, status.stamp.time, status.robot);
  // unknown: voltage, temperature, current, charge, capacity, design_capacity
  for (int i = 0; i < 6; ++i) {
    out.number(kNan);
  }
  out.number(static_cast<float>(status.battery_share));
  // unknown: status, health, technology
  out.number(std::uint8_t{0}).number(std::uint8_t{0}).number(std::uint8_t{0});
  out.number(std::uint8_t{1}).count(0).count(0).text("").text("");
  return {{"/" + status.robot + "/battery", "sensor_msgs/msg/BatteryState", status.stamp.time,
           out.bytes()}};
}

std::vector<Message> to_ros2(const models::ProcessHealth& health, std::string_view /*world*/) {
  constexpr std::uint8_t kOk = 0;
  constexpr std::uint8_t kWarning = 1;
  const bool is_degraded = health.state == models::ProcessState::kDegraded;
  static constexpr std::array kStates{"starting", "running", "degraded", "stopping"};
  Cdr out;
  add_header(out, health.stamp.time, "").count(1);
  out.number(is_degraded ? kWarning : kOk).text(health.process);
  out.text(kStates[static_cast<std::size_t>(health.state)]).text("");
  out.count(health.counters.size());
  for (const models::NamedCount& counter : health.counters) {
    out.text(counter.name).text(std::to_string(counter.count));
  }
  return {{"/diagnostics", "diagnostic_msgs/msg/DiagnosticArray", health.stamp.time, out.bytes()}};
}

}  // namespace vantage::logs::ros2
