#include "experiments/tracking/clutter_trial.hpp"

#include <algorithm>
#include <random>
#include <vector>

#include "core/cpu_time.hpp"
#include "core/index.hpp"
#include "estimator/filter/distributed_filter.hpp"
#include "estimator/tracks/labelled/multi_target.hpp"
#include "experiments/team/team_task.hpp"
#include "logs/metrics/set_means.hpp"
#include "models/world/world.hpp"
#include "sim/random.hpp"
#include "sim/world/ground.hpp"

namespace vantage::experiments {
namespace {

constexpr double kSettling_s = 10.0;
constexpr double kSpeed_mps = 1.0;
constexpr double kPhysics_s = 0.005;
constexpr int kPhysicsPerDecision = 10;

estimator::FilterSpec central_spec(scenario::Scenario scenario,
                                   const models::DetectionModel& detection) {
  scenario.estimator.detection_probability =
      std::min(scenario.estimator.detection_probability, detection.detection_probability);
  scenario.network.communication_range_m = 1e6;
  return estimator::filter_spec(scenario, scenario.robots.front().name);
}

estimator::MultiTargetSpec tracker_spec(const scenario::Scenario& scenario,
                                        const models::DetectionModel& detection,
                                        estimator::Tracker tracker) {
  estimator::MultiTargetSpec spec;
  spec.estimator = scenario.estimator;
  spec.world = scenario.world;
  spec.detection = detection;
  spec.step_s = scenario.planner.step_s;
  spec.targets = static_cast<int>(scenario.targets.size());
  spec.tracks_max = 2 * spec.targets;
  spec.tracker = tracker;
  return spec;
}

// Metrics of one method.
struct MethodMetrics {
  logs::OspaJudge ospa{logs::kOspaCutoff_m};
  ClutterScore sum;
};

struct Tracking {
  explicit Tracking(const estimator::MultiTargetSpec& spec)
      : filter(spec), tracks(filter.no_tracks()) {}
  estimator::MultiTargetFilter filter;
  std::vector<estimator::LabelledTrack> tracks;
};

class ClutterTrial {
 public:
  ClutterTrial(const scenario::Scenario& scenario, const models::DetectionModel& detection,
               double duration_s, std::uint64_t seed)
      : scenario_(scenario),
        detection_(detection),
        step_s_(scenario.planner.step_s),
        steps_(static_cast<int>(duration_s / step_s_)),
        settling_(std::min(steps_ / 2, static_cast<int>(kSettling_s / step_s_))),
        ground_(scenario, seed),
        rng_(sim::random_stream(seed, "clutter")),
        known_(central_spec(scenario, detection)) {
    for (const estimator::Tracker tracker :
         {estimator::Tracker::kLabelled, estimator::Tracker::kJpda, estimator::Tracker::kNearest}) {
      trackings_.emplace_back(tracker_spec(scenario, detection, tracker));
    }
    for (const scenario::RobotSpec& robot : scenario.robots) {
      positions_m_.push_back(robot.start.position_m());
    }
  }

  // Assigns to each robot the unassigned target with the largest ratio of position variance to
  // distance, or a random position if there is none.
  void plan() {
    goals_m_.clear();
    std::vector<char> is_taken(scenario_.targets.size(), 0);
    for (const Eigen::Vector2d& position_m : positions_m_) {
      Eigen::Vector2d goal_m = anywhere_m();
      double most = 0.0;
      std::size_t chosen = is_taken.size();
      for (std::size_t m = 0; m < is_taken.size(); ++m) {
        const estimator::Track& track = known_.track(static_cast<int>(m));
        const auto belief = track.known ? models::to_gaussian(track.information) : std::nullopt;
        if (is_taken[m] != 0 || !belief) {
          continue;
        }
        const Eigen::Vector2d mean_m = belief->mean.head<2>();
        const double ratio =
            belief->covariance.topLeftCorner<2, 2>().trace() / (0.5 + (mean_m - position_m).norm());
        if (ratio > most) {
          most = ratio;
          goal_m = mean_m;
          chosen = m;
        }
      }
      if (chosen < is_taken.size()) {
        is_taken[chosen] = 1;
      }
      goals_m_.push_back(goal_m);
    }
  }

  void attack() {}

  void move(int /*step_of_plan*/) {
    const int physics = static_cast<int>(step_s_ / kPhysics_s + 0.5);
    for (int i = 0; i < physics; ++i) {
      if (i % kPhysicsPerDecision == 0) {
        ground_.decide(kPhysicsPerDecision * kPhysics_s);
      }
      ground_.step(kPhysics_s);
    }
    truth_.clear();
    for (std::size_t m = 0; m < scenario_.targets.size(); ++m) {
      truth_.push_back({static_cast<std::int64_t>(m), ground_.world_from_body(m).position_m()});
    }
    for (std::size_t i = 0; i < positions_m_.size(); ++i) {
      const Eigen::Vector2d to_goal_m = goals_m_[i] - positions_m_[i];
      const double far_m = to_goal_m.norm();
      if (far_m > 0.0) {
        positions_m_[i] += std::min(1.0, kSpeed_mps * step_s_ / far_m) * to_goal_m;
      }
    }
    ++step_;
  }

  void observe() {
    const Time now = from_utime(1'000'000'000) + from_seconds(step_ * step_s_);
    detect(now);
    filter(now);
  }

  void record() {
    if (step_ <= settling_) {
      return;
    }
    std::vector<logs::Labelled> reported;
    const auto note = [&](MethodMetrics& metrics) {
      const logs::SetError error = metrics.ospa.judge(truth_, reported);
      metrics.sum.ospa_m += error.ospa_m;
      metrics.sum.matched_rmse_m += error.matched_rmse_m;
      metrics.sum.tracks += static_cast<double>(reported.size());
    };
    for (std::size_t t = 0; t < trackings_.size(); ++t) {
      reported.clear();
      for (const estimator::LabelledTrack& track : trackings_[t].tracks) {
        if (trackings_[t].filter.is_confirmed(track)) {
          reported.push_back({track.label, estimator::moments(track.mixture).mean.head<2>()});
        }
      }
      note(metrics_[t]);
    }
    reported.clear();
    for (std::size_t m = 0; m < truth_.size(); ++m) {
      const estimator::Track& track = known_.track(static_cast<int>(m));
      if (const auto belief = track.known ? models::to_gaussian(track.information) : std::nullopt) {
        reported.push_back({static_cast<std::int64_t>(m), belief->mean.head<2>()});
      }
    }
    note(metrics_[index(ClutterMethod::kKnownIds)]);
  }

  [[nodiscard]] int steps() const { return steps_; }

  [[nodiscard]] ClutterScores scores() const {
    const int scored_steps = steps_ - settling_;
    ClutterScores out;
    for (std::size_t i = 0; i < out.size(); ++i) {
      const ClutterScore& sum = metrics_[i].sum;
      out[i] = {sum.ospa_m / scored_steps,
                60.0 * static_cast<double>(metrics_[i].ospa.swaps()) / (scored_steps * step_s_),
                sum.matched_rmse_m / scored_steps, sum.tracks / scored_steps,
                sum.step_cpu_s / scored_steps};
    }
    return out;
  }

 private:
  Eigen::Vector2d anywhere_m() {
    const models::Rectangle& bounds = scenario_.world.bounds;
    std::uniform_real_distribution<double> share(0.0, 1.0);
    const double x = share(rng_);
    return bounds.min_m + Eigen::Vector2d(x, share(rng_)).cwiseProduct(bounds.max_m - bounds.min_m);
  }

  // Simulates the detections, with target ids; filter() adds false alarms with id −1.
  void detect(Time now) {
    std::uniform_real_distribution<double> share(0.0, 1.0);
    looks_.clear();
    for (std::size_t i = 0; i < positions_m_.size(); ++i) {
      const scenario::RobotSpec& robot = scenario_.robots[i];
      models::RobotMeasurement look;
      look.stamp.time = now;
      look.robot = robot.name;
      look.viewpoint = {{positions_m_[i].x(), positions_m_[i].y(), 0.0}, robot.height_m};
      for (const logs::Labelled& target : truth_) {
        const models::PositionVector y_m = target.position_m;
        if (models::in_view(robot.sensor, look.viewpoint, y_m) &&
            models::line_of_sight(scenario_.world, positions_m_[i], target.position_m) &&
            share(rng_) < detection_.detection_probability) {
          look.detections.push_back({static_cast<int>(target.label),
                                     models::sample(robot.sensor, look.viewpoint, y_m, rng_)});
        }
      }
      looks_.push_back(look);
    }
  }

  void filter(Time now) {
    std::vector<const models::RobotMeasurement*> pointers;
    for (const models::RobotMeasurement& look : looks_) {
      pointers.push_back(&look);
    }
    double start_s = thread_cpu_s();
    known_.advance({now, looks_.front().viewpoint, pointers, {}});
    metrics_[index(ClutterMethod::kKnownIds)].sum.step_cpu_s += thread_cpu_s() - start_s;
    for (std::size_t i = 0; i < looks_.size(); ++i) {
      for (const models::Measurement& z :
           models::sample_clutter(scenario_.robots[i].sensor, looks_[i].viewpoint,
                                  detection_.clutter_per_look, rng_)) {
        looks_[i].detections.push_back({-1, z});
      }
    }
    std::vector<estimator::Observation> observations;
    for (const models::RobotMeasurement& look : looks_) {
      const int robot = static_cast<int>(observations.size());
      observations.push_back({now, robot, look.viewpoint, look.detections});
    }
    for (std::size_t t = 0; t < trackings_.size(); ++t) {
      Tracking& of = trackings_[t];
      start_s = thread_cpu_s();
      of.filter.propagate(of.tracks, now - from_seconds(step_s_), now);
      for (std::size_t i = 0; i < observations.size(); ++i) {
        of.filter.update(of.tracks, observations[i], scenario_.robots[i].sensor);
      }
      metrics_[t].sum.step_cpu_s += thread_cpu_s() - start_s;
    }
  }

  const scenario::Scenario& scenario_;
  models::DetectionModel detection_;
  double step_s_;
  int steps_;
  int settling_;  ///< number of first steps that are not evaluated
  int step_ = 0;  ///< current step, from 1
  sim::Ground ground_;
  std::mt19937_64 rng_;
  estimator::DistributedFilter known_;
  std::vector<Tracking> trackings_;  ///< one per ClutterMethod
  std::array<MethodMetrics, kClutterMethods.size()> metrics_;
  std::vector<Eigen::Vector2d> positions_m_;  ///< m; by robot
  std::vector<Eigen::Vector2d> goals_m_;      ///< m; by robot
  std::vector<logs::Labelled> truth_;
  std::vector<models::RobotMeasurement> looks_;
};

}  // namespace

ClutterScores track_in_clutter(const scenario::Scenario& scenario,
                               const models::DetectionModel& detection, double duration_s,
                               std::uint64_t seed) {
  ClutterTrial task(scenario, detection, duration_s, seed);
  run_team_task(task, task.steps(), 1);
  return task.scores();
}

}  // namespace vantage::experiments
