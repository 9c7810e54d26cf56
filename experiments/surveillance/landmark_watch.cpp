#include "experiments/surveillance/landmark_watch.hpp"

#include <algorithm>
#include <limits>

#include "core/check.hpp"
#include "core/index.hpp"
#include "experiments/team/searching_team.hpp"
#include "experiments/team/team_task.hpp"
#include "models/belief/gaussian.hpp"
#include "models/world/grid.hpp"
#include "planner/search/arvi.hpp"

namespace vantage::experiments {
namespace {

constexpr double kFieldResolution_m = 0.5;
constexpr double kTurnOnTheSpot_radps = 2.0;

class Mean {
 public:
  void add(double value) {
    sum_ += value;
    count_ += 1.0;
  }
  // Returns the mean; NaN without values.
  [[nodiscard]] double value() const {
    return count_ > 0.0 ? sum_ / count_ : std::numeric_limits<double>::quiet_NaN();
  }

 private:
  double sum_ = 0.0;
  double count_ = 0.0;
};

class LandmarkWatch {
 public:
  LandmarkWatch(const WatchSetting& setting, std::span<const models::Viewpoint> starts,
                bool is_resilient)
      : setting_(setting),
        is_resilient_(is_resilient),
        search_({200'000, 8'000'000, static_cast<int>(setting.landmarks_m.size()),
                 setting.plan_steps, 0}) {
    require(setting.replan_steps >= 1 && setting.replan_steps <= setting.plan_steps,
            "watch: replan_steps must be in [1, plan_steps]");
    const int n = setting.landmark_model.dim();
    steps_unseen_.assign(setting.landmarks_m.size(), 0);
    for (const models::PositionVector& landmark_m : setting.landmarks_m) {
      models::Gaussian prior{
          models::StateVector::Zero(n),
          setting.prior_sigma_m * setting.prior_sigma_m * models::StateMatrix::Identity(n, n)};
      prior.mean.head(landmark_m.size()) = landmark_m;
      beliefs_.push_back(prior);
    }
    // the elements must not move, because problems point to them
    surroundings_.reserve(starts.size());
    for (const models::Viewpoint& start : starts) {
      const models::World world = world_at(setting, start.height_m);
      require(models::clearance_m(world, start.world_from_body.position_m()) > setting.clearance_m,
              "watch: a robot's start must be free");
      surroundings_.push_back({world, models::DistanceField(world, kFieldResolution_m)});
      team_.problems.push_back(problem_of(start, surroundings_.back()));
    }
    run_.poses.push_back(team_.poses());
  }

  void plan() {
    team_.plan(planned_targets(), is_resilient_ ? setting_.attacks : 0,
               [&](const planner::SearchProblem& problem) {
                 return search_.plan(problem, reduction(), Deadline::never());
               });
  }

  void attack() {
    if (setting_.jammed_robot >= 0) {
      attacked_.assign(team_.problems.size(), 0);
      attacked_[index(setting_.jammed_robot)] = 1;
    } else {
      attacked_ = team_.attacked(setting_.attacker, setting_.attacks);
    }
  }

  void move(int step_of_plan) {
    run_.turns_on_the_spot += team_.move(step_of_plan, kTurnOnTheSpot_radps);
  }

  void observe() {
    seen_.assign(beliefs_.size(), 0);
    const models::TargetModel& model = setting_.landmark_model;
    const models::StateMatrix A = model.transition(setting_.step_s);
    for (std::size_t m = 0; m < beliefs_.size(); ++m) {
      beliefs_[m] =
          models::predict(beliefs_[m], A, model.process_noise(setting_.step_s, steps_unseen_[m]));
      ++steps_unseen_[m];
      const models::PositionVector& landmark_m = setting_.landmarks_m[m];
      models::PositionMatrix M = models::PositionMatrix::Zero(landmark_m.size(), landmark_m.size());
      for (std::size_t i = 0; i < team_.problems.size(); ++i) {
        const models::Viewpoint from{team_.problems[i].start, team_.problems[i].height_m};
        if (attacked_[i] == 0 && models::in_view(setting_.sensor, from, landmark_m)) {
          M += models::information(setting_.sensor, from, landmark_m);
          seen_[m] = 1;
        }
      }
      if (seen_[m] != 0) {
        beliefs_[m].covariance = models::update_covariance(beliefs_[m].covariance, M);
        steps_unseen_[m] = 0;
      }
    }
  }

  void record() {
    double entropy_nats = 0.0;
    for (const models::Gaussian& belief : beliefs_) {
      entropy_nats += models::entropy_nats(belief);
    }
    run_.entropy_nats.push_back(entropy_nats / static_cast<double>(beliefs_.size()));
    run_.seen.push_back(seen_);
    run_.poses.push_back(team_.poses());
    run_.attacked.push_back(attacked_);
  }

  [[nodiscard]] const WatchRun& run() const { return run_; }

 private:
  // The obstacles that block one robot.
  struct Surroundings {
    models::World world;
    models::DistanceField field;
  };

  [[nodiscard]] planner::SearchProblem problem_of(const models::Viewpoint& start,
                                                  const Surroundings& surroundings) const {
    planner::SearchProblem problem;
    problem.start = start.world_from_body;
    problem.height_m = start.height_m;
    problem.controls = setting_.controls;
    problem.horizon_steps = setting_.plan_steps;
    problem.step_s = setting_.step_s;
    problem.sensors = {setting_.sensor};
    problem.world = &surroundings.world;
    problem.field = &surroundings.field;
    problem.clearance_m = setting_.clearance_m;
    problem.obstacles_block_sight = false;
    return problem;
  }

  [[nodiscard]] std::vector<planner::SearchTarget> planned_targets() const {
    std::vector<planner::SearchTarget> targets;
    for (std::size_t m = 0; m < beliefs_.size(); ++m) {
      targets.push_back(
          {setting_.landmark_model.as_planned(steps_unseen_[m], setting_.step_s), beliefs_[m]});
    }
    return targets;
  }

  // The search keeps only the cheapest of all poses within δ of each other, independent of the
  // beliefs. The kept plans thus have different destinations. This is needed because a path to a
  // distant landmark gives no information until the landmark is in view.
  [[nodiscard]] planner::ReducedOptions reduction() const {
    planner::ReducedOptions options;
    options.search = planner::ReducedSearch::kSinglePass;
    options.epsilon = 1e9;
    options.delta_m = setting_.delta_m;
    options.yaw_weight_m_per_rad = 0.3;
    return options;
  }

  const WatchSetting& setting_;
  bool is_resilient_;
  planner::ReducedValueIteration search_;
  std::vector<models::Gaussian> beliefs_;
  std::vector<int> steps_unseen_;           ///< by landmark
  std::vector<Surroundings> surroundings_;  ///< obstacles that block a robot, by robot
  SearchingTeam team_;
  std::vector<char> attacked_;
  std::vector<char> seen_;  ///< by landmark: nonzero if seen in the last observation
  WatchRun run_;
};

}  // namespace

models::World world_at(const WatchSetting& setting, double height_m) {
  models::World world = setting.world;
  std::erase_if(world.obstacles, [&](const models::Obstacle& obstacle) {
    return obstacle.height_m <= height_m - setting.overfly_m;
  });
  return world;
}

WatchRun watch(const WatchSetting& setting, std::span<const models::Viewpoint> starts,
               bool is_resilient) {
  LandmarkWatch task(setting, starts, is_resilient);
  run_team_task(task, setting.task_steps, setting.replan_steps);
  return task.run();
}

Revisits revisits(const std::vector<std::vector<char>>& seen) {
  const int steps = static_cast<int>(seen.size());
  const std::size_t landmarks = seen.empty() ? 0 : seen.front().size();
  Revisits result;
  Mean intervals;
  Mean with_ends;
  Mean by_landmark;
  Mean absences;
  Mean ages;
  for (std::size_t m = 0; m < landmarks; ++m) {
    Mean of_landmark;
    int last = 0;  // step of the last observation, counted from 1; 0: the start
    const auto end_interval = [&](int step) {
      of_landmark.add(step - last);
      with_ends.add(step - last);
      result.longest = std::max(result.longest, step - last);
    };
    for (int step = 1; step <= steps; ++step) {
      if (seen[index(step - 1)][m] != 0) {
        end_interval(step);
        if (last > 0) {
          intervals.add(step - last);
        }
        if (last > 0 && step - last > 1) {
          absences.add(step - last);
        }
        last = step;
      }
      ages.add(step - last);
    }
    result.never_seen += last == 0 ? 1 : 0;
    if (last < steps) {
      end_interval(steps);
    }
    by_landmark.add(of_landmark.value());
  }
  result.interval = intervals.value();
  result.interval_with_ends = with_ends.value();
  result.interval_by_landmark = by_landmark.value();
  result.age = ages.value();
  result.absence = absences.value();
  return result;
}

}  // namespace vantage::experiments
