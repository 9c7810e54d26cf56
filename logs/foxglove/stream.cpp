#include "logs/foxglove/stream.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "bus/convert/channels.hpp"
#include "core/check.hpp"
#include "logs/foxglove/scene.hpp"
#include "scenario/reader/scenario_yaml.hpp"

namespace vantage::logs::foxglove {
namespace {

constexpr Duration kTrackLength = std::chrono::seconds(20);
constexpr Duration kTrackPeriod = std::chrono::milliseconds(500);
constexpr Duration kTrackPointPeriod = std::chrono::milliseconds(200);
constexpr double kTrackPoint_m = 0.02;
constexpr double kTrackBend_m = 0.01;
constexpr Duration kTrackPieceMax = std::chrono::seconds(2);
constexpr Duration kMocapSilence = std::chrono::seconds(1);
constexpr std::size_t kPlansTraced = 16;  // newest plans kept per robot

const char* name_of(models::OperatorAction action) {
  constexpr const char* kNames[] = {"heartbeat", "arm",  "take off",      "follow",
                                    "hold",      "land", "emergency stop"};
  return kNames[static_cast<int>(action)];
}

}  // namespace

void Stream::put(const std::string& topic, Schema schema, Time received_at, const auto& make,
                 bool is_state) {
  if (sink_.wants(topic, schema, is_state)) {
    sink_.write(topic, received_at, make());
  }
}

void Stream::put_event(const std::optional<Event>& event, Time received_at) {
  if (event) {
    put("/events", Schema::kLog, received_at, [&] { return log_json(*event); });
  }
}

void Stream::on_publisher(std::string_view channel, std::int64_t run_id, Time received_at) {
  if (publishers_.on_run(channel, run_id)) {
    put_event(Event{received_at, LogLevel::kError, "two_publishers",
                    fmt::format(
                        "{}: two processes publish this channel; only the messages of one are used",
                        channel)},
              received_at);
  }
}

void Stream::on(const models::ScenarioNotice& notice, Time received_at) {
  if (!sessions_.on(notice, received_at)) {
    return;
  }
  try {
    scenario_ = scenario::parse_scenario(notice.yaml, "SCENARIO");
  } catch (const StartupError& error) {
    put_event(Event{received_at, LogLevel::kError, "scenario", error.what()}, received_at);
    return;
  }
  scenario_->source_text = notice.yaml;
  begin_session(received_at, notice.stamp.sequence > 0);
  const Time time = notice.stamp.time;
  put(
      "/scenario", Schema::kScenario, received_at,
      [&] { return scenario_json(notice, *scenario_); }, true);
  put(
      "/world", Schema::kSceneUpdate, received_at,
      [&] { return world_scene(scenario_->world, time); }, true);
  put(
      "/targets", Schema::kSceneUpdate, received_at,
      [&] { return targets_scene(*scenario_, time); }, true);
  put_robots(received_at, time);
}

void Stream::begin_session(Time received_at, bool has_begun_before) {
  constexpr double kKnownAtFirst_s = 2.0;
  metrics_.emplace(*scenario_, received_at);
  const double prior_nats =
      isotropic_entropy_nats(scenario_->estimator.undiscovered_position_sigma_m,
                             scenario_->estimator.target_model.position_dim);
  stories_.assign(scenario_->targets.size(), TargetStory(prior_nats));
  sightings_.clear();
  unknown_until_s_ = has_begun_before ? kKnownAtFirst_s : 0.0;
  estimates_.clear();
  estimates_time_.reset();
  newest_step_ = -1;
  grid_ = {};
  grid_step_ = -1;
}

void Stream::put_robots(Time received_at, Time time) {
  if (!scenario_) {
    return;
  }
  const std::set<std::string> jammed =
      attack_ ? std::set(attack_->jammed.begin(), attack_->jammed.end()) : std::set<std::string>{};
  put(
      "/robots", Schema::kSceneUpdate, received_at,
      [&] { return robots_scene(*scenario_, jammed, time); }, true);
  put(
      "/views", Schema::kSceneUpdate, received_at,
      [&] { return views_scene(*scenario_, jammed, time); }, true);
}

void Stream::on(const models::MocapFrame& frame, Time received_at) {
  last_mocap_ = frame.stamp.time;
  put("/transforms", Schema::kFrameTransforms, received_at,
      [&] { return frame_transforms(frame); });
  for (const models::MocapBody& body : frame.bodies) {
    if (!body.occluded) {
      extend_trail(body.name, body.world_from_body.translation_m, frame.stamp.time);
    }
  }
  put_tracks(received_at, frame.stamp.time);
  flush_estimates(received_at);
}

void Stream::on(const models::TruthFrame& truth, Time received_at) {
  if (metrics_) {
    metrics_->on_truth(truth);
  }
  put("/truth/transforms", Schema::kFrameTransforms, received_at,
      [&] { return frame_transforms(truth, "truth/"); });
  // If no motion capture is on the bus (in a filtered log), the truth moves the bodies.
  if (!last_mocap_ || truth.stamp.time - *last_mocap_ > kMocapSilence) {
    put("/transforms", Schema::kFrameTransforms, received_at,
        [&] { return frame_transforms(truth, ""); });
    for (const models::TruthBody& body : truth.bodies) {
      extend_trail(body.name, body.world_from_body.translation_m, truth.stamp.time);
    }
    put_tracks(received_at, truth.stamp.time);
  }
  flush_estimates(received_at);
}

void Stream::on(const models::RobotMeasurement& detections, Time received_at) {
  captures_.add(models::ref_to(bus::measurement_channel(detections.robot).name, detections.stamp),
                detections.stamp.time);
  for (const models::Detection& detection : detections.detections) {
    if (detection.target_id >= 0 && !detections.jammed) {
      sightings_[detection.target_id] = {detections.robot, detections.stamp.time};
    }
  }
  const scenario::RobotSpec* robot = scenario_ ? scenario_->find_robot(detections.robot) : nullptr;
  if (robot != nullptr) {
    put("/measurement/" + detections.robot, Schema::kSceneUpdate, received_at, [&] {
      return measurement_scene(detections, robot->sensor,
                               scenario_->estimator.target_model.position_dim);
    });
  }
}

void Stream::on(const models::RobotBelief& belief, Time received_at) {
  put_grid(belief, received_at);
  if (const auto capture = captures_.newest(belief.inputs)) {
    captures_of_beliefs_.add(models::ref_to(bus::belief_channel(belief.robot).name, belief.stamp),
                             *capture);
  }
  if (!scenario_) {
    return;
  }
  metrics_->on_belief(belief);
  if (belief.step > newest_step_ || belief.step + 10 < newest_step_) {
    flush_estimates(received_at);
    newest_step_ = belief.step;
    estimates_.clear();
    put(
        "/team", Schema::kTeam, received_at,
        [&] { return team_json(*metrics_, belief.stamp.time); }, true);
    put_targets(received_at, belief.stamp.time);
  }
  const int dim = scenario_->estimator.target_model.position_dim;
  std::vector<EstimateView> own;
  // Track labels are created without limit, so their deletions cannot be listed; they expire
  // instead.
  const Duration track_lifetime = from_seconds(1.5 * scenario_->planner.step_s);
  for (const models::TargetBelief& target : belief.targets) {
    const auto estimate = position_estimate(target, belief.robot, belief.stamp.time, dim);
    if (estimate) {
      const bool is_track = target.target_id >= models::kTrackLabelMin;
      own.push_back({target.target_id, target_name(target.target_id), *estimate, std::nullopt,
                     is_track ? track_lifetime : Duration{0}});
      const auto known = estimates_.find(target.target_id);
      if (known == estimates_.end() ||
          estimate->entropy_nats < known->second.estimate.entropy_nats) {
        estimates_[target.target_id] = own.back();
      }
    }
  }
  estimates_time_ = belief.stamp.time;
  put_estimates("/belief/" + belief.robot, "belief/" + belief.robot, own, received_at);
}

void Stream::put_targets(Time received_at, Time time) {
  for (std::size_t i = 0; i < stories_.size(); ++i) {
    const TargetStatus& target = metrics_->targets()[i];
    const auto seen = sightings_.find(static_cast<int>(i));
    const auto event =
        stories_[i].on(target, seen == sightings_.end() ? "" : seen->second.robot, time);
    const bool is_known_at_first = event && event->kind == "found" && target.discovered_s &&
                                   *target.discovered_s < unknown_until_s_;
    put_event(is_known_at_first ? std::nullopt : event, received_at);
  }
  put(
      "/targets/status", Schema::kTargets, received_at,
      [&] { return targets_json(*metrics_, stories_, sightings_, unknown_until_s_, time); }, true);
}

void Stream::flush_estimates(Time received_at) {
  if (!estimates_time_) {
    return;
  }
  std::vector<EstimateView> views;
  for (auto& [id, view] : estimates_) {
    const auto index = static_cast<std::size_t>(id);
    if (id >= 0 && index < metrics_->targets().size()) {
      view.error_m = metrics_->targets()[index].error_m;
    }
    views.push_back(view);
  }
  put_estimates("/estimates", "estimate", views, received_at);
  estimates_time_.reset();
}

void Stream::put_estimates(const std::string& topic, const std::string& prefix,
                           const std::vector<EstimateView>& views, Time received_at) {
  put(
      topic, Schema::kSceneUpdate, received_at,
      [&] {
        std::set<std::string> shown;
        for (const EstimateView& view : views) {
          shown.insert(view.name);
        }
        // List all missing targets, not only new ones: a viewer may have missed the message that
        // deleted a target.
        std::vector<std::string> gone;
        for (const scenario::TargetSpec& target : scenario_->targets) {
          if (!shown.contains(target.name)) {
            gone.push_back(target.name);
          }
        }
        return estimates_scene(prefix, views, gone, received_at);
      },
      true);
}

void Stream::put_grid(const models::RobotBelief& belief, Time received_at) {
  if (belief.grid.size() == 0 || std::ssize(belief.last_seen_utime) != belief.grid.size()) {
    return;
  }
  put("/belief/" + belief.robot + "/grid", Schema::kGrid, received_at,
      [&] { return visibility_grid(belief.grid, belief.last_seen_utime, belief.stamp.time); });
  // In neighbourhood mode a belief contains only the part of the grid around its robot.
  const bool is_part = scenario_ && scenario_->network.neighbourhood_m > 0.0;
  const models::GridGeometry whole =
      is_part ? models::GridGeometry::covering(scenario_->world.bounds,
                                               scenario_->estimator.grid_resolution_m)
              : belief.grid;
  if (!(whole == grid_)) {
    grid_ = whole;
    last_seen_utime_.assign(static_cast<std::size_t>(whole.size()),
                            models::VisibilityGrid::kNeverSeen);
  }
  models::merge_stamps(grid_, last_seen_utime_, belief.grid, belief.last_seen_utime,
                       std::numeric_limits<std::int64_t>::max());
  if (belief.step != grid_step_) {
    grid_step_ = belief.step;
    put("/grid", Schema::kGrid, received_at,
        [&] { return visibility_grid(grid_, last_seen_utime_, belief.stamp.time); });
  }
}

void Stream::on(const models::RobotMap& map, Time received_at) {
  if (!scenario_ || map.grid.size() == 0) {
    return;
  }
  metrics_->on_map(map);
  for (const std::string& topic : {std::string("/map"), "/map/" + map.robot}) {
    put(topic, Schema::kGrid, received_at, [&] { return occupancy_grid(map, scenario_->mapping); });
  }
}

void Stream::on(const models::RobotPlan& plan, Time received_at) {
  if (metrics_) {
    metrics_->on_plan(plan);
  }
  trace(plan);
  put(
      "/plan/" + plan.robot, Schema::kSceneUpdate, received_at,
      [&] { return plan_scene(plan, colour_of(plan.robot)); }, true);
  put(
      "/plan/" + plan.robot + "/status", Schema::kPlan, received_at,
      [&] { return plan_json(plan); }, true);
  put_event(event_of(plan), received_at);
}

void Stream::trace(const models::RobotPlan& plan) {
  const auto capture = captures_of_beliefs_.newest(plan.inputs);
  if (!capture) {
    return;
  }
  std::map<std::int64_t, Time>& rounds = captures_of_plans_[plan.robot];
  rounds[plan.round] = *capture;
  while (rounds.size() > kPlansTraced) {
    rounds.erase(rounds.begin());
  }
}

void Stream::note_latency(const models::VehicleStatus& status) {
  const auto before = vehicles_.find(status.robot);
  if (before != vehicles_.end() && before->second.plan_round == status.plan_round) {
    return;
  }
  capture_to_setpoint_.erase(status.robot);
  const auto rounds = captures_of_plans_.find(status.robot);
  // The first status of a vehicle does not show since when the vehicle has followed its plan.
  if (before == vehicles_.end() || rounds == captures_of_plans_.end()) {
    return;
  }
  const auto capture = rounds->second.find(status.plan_round);
  if (capture != rounds->second.end()) {
    capture_to_setpoint_[status.robot] = status.stamp.time - capture->second;
  }
}

void Stream::on(const models::TeamProposal& proposal, Time received_at) {
  if (colour_of(proposal.robot) && received_at < proposal.stamp.time) {
    put(
        "/proposal/" + proposal.robot, Schema::kSceneUpdate, received_at,
        [&] { return proposal_scene(proposal, *scenario_, received_at); }, true);
  }
}

void Stream::on(const models::VehicleStatus& status, Time received_at) {
  if (metrics_) {
    metrics_->on_vehicle(status);
  }
  note_latency(status);
  put(
      "/vehicle/" + status.robot, Schema::kVehicle, received_at,
      [&] {
        const auto latency = capture_to_setpoint_.find(status.robot);
        return vehicle_json(status, latency == capture_to_setpoint_.end()
                                        ? std::nullopt
                                        : std::optional(latency->second));
      },
      true);
  const auto before = vehicles_.find(status.robot);
  put_event(event_of(before == vehicles_.end() ? nullptr : &before->second, status), received_at);
  vehicles_[status.robot] = status;
}

void Stream::on(const models::ProcessHealth& health, Time received_at) {
  if (metrics_) {
    metrics_->on_health(health);
  }
  put(
      "/health/" + health.process, Schema::kHealth, received_at,
      [&] { return health_json(health); }, true);
  put_event(processes_[health.process].on(health), received_at);
}

void Stream::on(const models::HostReport& report, Time received_at) {
  const auto before = hosts_.find(report.host);
  put_event(event_of(before == hosts_.end() ? nullptr : &before->second, report), received_at);
  hosts_[report.host] = report;
}

void Stream::on(const models::CollisionReport& contact, Time received_at) {
  if (metrics_) {
    metrics_->on_contact(contact);
  }
  put_event(event_of(contact), received_at);
}

void Stream::on(const models::AttackNotice& attack, Time received_at) {
  put(
      "/attack", Schema::kAttack, received_at, [&] { return attack_json(attack); }, true);
  const auto event = event_of(attack_ ? &*attack_ : nullptr, attack);
  put_event(event, received_at);
  attack_ = attack;
  if (event) {
    put_robots(received_at, attack.stamp.time);
  }
}

void Stream::on(const models::OperatorCommand& command, Time received_at) {
  if (command.action == models::OperatorAction::kHeartbeat) {
    return;
  }
  const bool is_stop = command.action == models::OperatorAction::kEmergencyStop;
  put_event(Event{command.stamp.time, is_stop ? LogLevel::kError : LogLevel::kInfo, "command",
                  fmt::format("operator: {} {}", name_of(command.action),
                              command.robot.empty() ? "all" : command.robot)},
            received_at);
}

void Stream::extend_trail(const std::string& body, const Eigen::Vector3d& position_m, Time time) {
  Track& points = tracks_[body];
  if (!points.empty()) {
    const auto& [last_time, last_m] = points.back();
    if (time < last_time) {
      points.clear();  // the time decreased, so a new run has begun
    } else if (time - last_time < kTrackPointPeriod ||
               (position_m - last_m).norm() < kTrackPoint_m) {
      return;
    }
  }
  if (points.size() >= 2) {
    // Drop points between collinear neighbours: most of a path is straight.
    const auto& [from_time, from_m] = points[points.size() - 2];
    const Eigen::Vector3d piece_m = position_m - from_m;
    const Eigen::Vector3d to_last_m = points.back().second - from_m;
    const double along = std::clamp(to_last_m.dot(piece_m) / piece_m.squaredNorm(), 0.0, 1.0);
    if (time - from_time <= kTrackPieceMax &&
        (to_last_m - along * piece_m).norm() <= kTrackBend_m) {
      points.pop_back();
    }
  }
  points.emplace_back(time, position_m);
  while (points.front().first < time - kTrackLength) {
    points.pop_front();
  }
}

void Stream::put_tracks(Time received_at, Time time) {
  if (next_tracks_ && time < *next_tracks_ && time >= *next_tracks_ - kTrackPeriod) {
    return;
  }
  next_tracks_ = time + kTrackPeriod;
  put("/tracks", Schema::kSceneUpdate, received_at, [&] {
    std::vector<Json> entities;
    for (const auto& [body, track] : tracks_) {
      std::vector<Eigen::Vector3d> points;
      for (const auto& [when, position_m] : track) {
        points.push_back(position_m);
      }
      entities.push_back(track_entity(body, points, colour_of(body), time));
    }
    return scene_update(std::move(entities));
  });
}

std::optional<Colour> Stream::colour_of(const std::string& robot) const {
  return scenario_ ? robot_colour(*scenario_, robot) : std::nullopt;
}

std::string Stream::target_name(int target_id) const {
  for (const scenario::TargetSpec& target : scenario_->targets) {
    if (target.id == target_id) {
      return target.name;
    }
  }
  return target_id < models::kTrackLabelMin
             ? fmt::format("target {}", target_id)
             : fmt::format("track {:x}", target_id - models::kTrackLabelMin);
}

}  // namespace vantage::logs::foxglove
