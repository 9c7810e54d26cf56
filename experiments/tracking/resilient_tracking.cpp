#include "experiments/tracking/resilient_tracking.hpp"

#include <cmath>
#include <random>

#include <fmt/format.h>

#include "core/index.hpp"
#include "experiments/team/searching_team.hpp"
#include "experiments/team/team_task.hpp"
#include "experiments/tracking/bearing_noise.hpp"
#include "models/motion/unicycle.hpp"
#include "models/world/grid.hpp"
#include "planner/search/beam.hpp"

namespace vantage::experiments {
namespace {

constexpr double kSide_m = 64.0;
constexpr double kStep_s = 0.5;
constexpr double kGridResolution_m = 0.5;
// Share of the beam width, see BeamOptions::breadth. With a smaller share, plans of 25 steps stay
// near their first target.
constexpr double kBreadth = 0.6;

models::SensorModel tracking_sensor(BearingNoise bearing_noise) {
  models::SensorModel sensor;
  sensor.kind = bearing_noise == BearingNoise::kByRange ? models::SensorKind::kRangeBearing
                                                        : range_bearing_by_bearing();
  sensor.range_max_m = 10.0;
  sensor.fov_rad = radians(94.0);
  sensor.range_sigma_m = 0.15;
  sensor.bearing_sigma_rad = radians(5.0);
  sensor.variance_grows_with_range = true;
  return sensor;
}

models::World square_world() {
  models::World world;
  world.bounds = {{0.0, 0.0}, {kSide_m, kSide_m}};
  return world;
}

TargetSetting target_setting(const TrackingSetting& setting) {
  TargetSetting of_targets;
  of_targets.count = setting.targets;
  of_targets.start_side_m = setting.start_side_m;
  of_targets.step_s = kStep_s;
  of_targets.prior_position_sigma_m = setting.prior_position_sigma_m;
  of_targets.prior_velocity_sigma_mps = setting.prior_velocity_sigma_mps;
  of_targets.detection_probability = setting.detection_probability;
  of_targets.beliefs_stay_inside = setting.beliefs_stay_inside;
  return of_targets;
}

class TrackingTask {
 public:
  TrackingTask(const TrackingSetting& setting, bool is_resilient, std::uint64_t seed)
      : setting_(setting),
        is_resilient_(is_resilient),
        world_(square_world()),
        field_(world_, kGridResolution_m),
        targets_(target_setting(setting), world_, 2 * seed),
        search_(capacity(setting)) {
    std::mt19937_64 rng(2 * seed + 1);
    std::uniform_real_distribution<double> off_m(-0.5 * setting.start_side_m,
                                                 0.5 * setting.start_side_m);
    std::uniform_real_distribution<double> heading(-kPi, kPi);
    for (int i = 0; i < setting.robots; ++i) {
      const double x_m = 0.5 * kSide_m + off_m(rng);
      const double y_m = 0.5 * kSide_m + off_m(rng);
      team_.problems.push_back(problem_from({x_m, y_m, heading(rng)}));
    }
  }

  void plan() {
    std::vector<planner::SearchTarget> targets;
    for (const models::Gaussian& belief : targets_.beliefs()) {
      targets.push_back({targets_.model(), belief});
    }
    planner::BeamOptions options;
    options.breadth = kBreadth;
    team_.plan(targets, is_resilient_ ? setting_.attacks : 0,
               [&](const planner::SearchProblem& problem) {
                 return search_.plan(problem, options, Deadline::nodes(setting_.nodes_per_plan));
               });
  }

  void attack() { attacked_ = team_.attacked(setting_.attacker, setting_.attacks); }

  void move(int step_of_plan) {
    team_.move(step_of_plan, 0.0);
    targets_.move();
  }

  void observe() {
    targets_.observe(tracking_sensor(setting_.bearing_noise), team_.poses(), attacked_);
  }

  void record() {
    const std::vector<TargetStep> steps = targets_.steps();
    const auto count = static_cast<double>(steps.size());
    double squared_m2 = 0.0;
    for (const TargetStep& step : steps) {
      squared_m2 += step.error_m * step.error_m;
    }
    double entropy_nats = 0.0;
    for (const models::Gaussian& belief : targets_.beliefs()) {
      entropy_nats += models::entropy_nats(belief);
    }
    run_.rmse_m.push_back(std::sqrt(squared_m2 / count));
    run_.entropy_nats.push_back(entropy_nats / count);
    run_.targets.push_back(steps);
  }

  [[nodiscard]] const TrackingRun& run() const { return run_; }

 private:
  static planner::SearchCapacity capacity(const TrackingSetting& setting) {
    return {index(static_cast<int>(setting.nodes_per_plan)) + 4'096, 4'000'000, setting.targets,
            setting.plan_steps, 0};
  }

  [[nodiscard]] planner::SearchProblem problem_from(const Pose2& start) const {
    planner::SearchProblem problem;
    problem.start = start;
    problem.controls = models::standard_primitives();
    problem.horizon_steps = setting_.plan_steps;
    problem.step_s = kStep_s;
    problem.sensors = {tracking_sensor(setting_.bearing_noise)};
    problem.sensors.front().range_min_m = setting_.plan_range_min_m;
    problem.world = &world_;
    problem.field = &field_;
    return problem;
  }

  TrackingSetting setting_;
  bool is_resilient_;
  models::World world_;
  models::DistanceField field_;
  TrackedTargets targets_;
  planner::RefiningBeam search_;
  SearchingTeam team_;
  std::vector<char> attacked_;
  TrackingRun run_;
};

}  // namespace

std::map<std::string, std::string> parameters_of(const TrackingSetting& setting) {
  return {{"task_steps", std::to_string(setting.task_steps)},
          {"plan_steps", std::to_string(setting.plan_steps)},
          {"nodes_per_plan", std::to_string(setting.nodes_per_plan)},
          {"prior_position_sigma_m", fmt::format("{}", setting.prior_position_sigma_m)},
          {"prior_velocity_sigma_mps", fmt::format("{}", setting.prior_velocity_sigma_mps)},
          {"detection_probability", fmt::format("{}", setting.detection_probability)},
          {"plan_range_min_m", fmt::format("{}", setting.plan_range_min_m)}};
}

TrackingRun track_under_attack(const TrackingSetting& setting, bool is_resilient,
                               std::uint64_t seed) {
  TrackingTask task(setting, is_resilient, seed);
  run_team_task(task, setting.task_steps, setting.plan_steps);
  return task.run();
}

}  // namespace vantage::experiments
