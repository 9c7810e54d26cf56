#include "experiments/tracking/resilient_tracking.hpp"

#include <cmath>
#include <random>

#include <fmt/format.h>

#include "core/index.hpp"
#include "experiments/team/searching_team.hpp"
#include "experiments/team/team_task.hpp"
#include "experiments/tracking/bearing_noise.hpp"
#include "models/motion/unicycle.hpp"
#include "planner/search/beam.hpp"

namespace vantage::experiments {
namespace {

constexpr double kSide_m = 64.0;
// Share of the beam width, see BeamOptions::breadth. With a smaller share, plans of 25 steps stay
// near their first target.
constexpr double kBreadth = 0.6;

models::SensorModel sensor_with(BearingNoise bearing_noise) {
  models::SensorModel sensor = tracking_sensor();
  if (bearing_noise == BearingNoise::kByBearing) {
    sensor.kind = range_bearing_by_bearing();
  }
  sensor.variance_grows_with_range = true;
  return sensor;
}

class TrackingTask {
 public:
  TrackingTask(const TrackingSetting& setting, bool is_resilient, std::uint64_t seed)
      : setting_(setting),
        is_resilient_(is_resilient),
        ground_(kSide_m),
        targets_(setting.targets, ground_.world, 2 * seed),
        search_(capacity(setting)) {
    std::mt19937_64 rng(2 * seed + 1);
    const double start_side_m = setting.targets.start_side_m;
    std::uniform_real_distribution<double> off_m(-0.5 * start_side_m, 0.5 * start_side_m);
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
    targets_.observe(sensor_with(setting_.bearing_noise), team_.poses(), attacked_);
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
    return {index(static_cast<int>(setting.nodes_per_plan)) + 4'096, 4'000'000,
            setting.targets.count, setting.plan_steps, 0};
  }

  [[nodiscard]] planner::SearchProblem problem_from(const Pose2& start) const {
    planner::SearchProblem problem;
    problem.start = start;
    problem.controls = models::standard_primitives();
    problem.horizon_steps = setting_.plan_steps;
    problem.step_s = setting_.targets.step_s;
    problem.sensors = {sensor_with(setting_.bearing_noise)};
    problem.sensors.front().range_min_m = kPlannedRangeMin_m;
    problem.world = &ground_.world;
    problem.field = &ground_.field;
    return problem;
  }

  TrackingSetting setting_;
  bool is_resilient_;
  TrackingGround ground_;
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
          {"prior_position_sigma_m", fmt::format("{}", setting.targets.prior_position_sigma_m)},
          {"prior_velocity_sigma_mps", fmt::format("{}", setting.targets.prior_velocity_sigma_mps)},
          {"detection_probability", fmt::format("{}", setting.targets.detection_probability)},
          {"plan_range_min_m", fmt::format("{}", kPlannedRangeMin_m)}};
}

TrackingRun track_under_attack(const TrackingSetting& setting, bool is_resilient,
                               std::uint64_t seed) {
  TrackingTask task(setting, is_resilient, seed);
  run_team_task(task, setting.task_steps, setting.plan_steps);
  return task.run();
}

}  // namespace vantage::experiments
