#include "tools/experiment/resilient_tracking.hpp"

#include <cmath>
#include <random>

#include <Eigen/Cholesky>

#include "estimator/confinement.hpp"
#include "estimator/missed_detection.hpp"
#include "estimator/track.hpp"
#include "models/belief/gaussian.hpp"
#include "models/motion/unicycle.hpp"
#include "models/world/grid.hpp"
#include "planner/search/beam.hpp"
#include "planner/team/decision/attack.hpp"
#include "planner/team/decision/resilient.hpp"
#include "planner/team/fixed_information.hpp"

namespace vantage::tools {
namespace {

constexpr double kSide_m = 64.0;
constexpr double kStep_s = 0.5;
constexpr double kFieldResolution_m = 0.5;

std::size_t index(int i) { return static_cast<std::size_t>(i); }

models::SensorModel tracking_sensor() {
  models::SensorModel sensor;
  sensor.kind = models::SensorKind::kRangeBearing;
  sensor.range_max_m = 10.0;
  sensor.fov_rad = radians(94.0);
  sensor.range_sigma_m = 0.15;
  sensor.bearing_sigma_rad = radians(5.0);
  sensor.variance_grows_with_range = true;
  return sensor;
}

// Gaussian noise with the covariance `W`, which may be singular.
models::StateVector draw(const models::StateMatrix& W, std::mt19937_64& rng) {
  std::normal_distribution<double> normal;
  const Eigen::LDLT<models::StateMatrix> root(W);
  models::StateVector white(W.rows());
  for (Eigen::Index i = 0; i < white.size(); ++i) {
    white(i) = normal(rng);
  }
  const models::StateVector scaled = root.vectorD().cwiseMax(0.0).cwiseSqrt().cwiseProduct(white);
  return root.transpositionsP().transpose() * (root.matrixL() * scaled).eval();
}

// A target that leaves the square comes back the way it would from a mirror.
void reflect(models::StateVector& state) {
  for (int axis = 0; axis < 2; ++axis) {
    for (const double wall_m : {0.0, kSide_m}) {
      const bool is_beyond = wall_m == 0.0 ? state(axis) < wall_m : state(axis) > wall_m;
      if (is_beyond) {
        state(axis) = 2.0 * wall_m - state(axis);
        state(axis + 2) = -state(axis + 2);
      }
    }
  }
}

class TrackingTask {
 public:
  TrackingTask(const TrackingSetting& setting, bool is_resilient, std::uint64_t seed)
      : setting_(setting),
        is_resilient_(is_resilient),
        truth_rng_(3 * seed),
        noise_rng_(3 * seed + 1),
        model_{models::TargetKind::kDoubleIntegrator, 2, 0.001},
        A_(model_.transition(kStep_s)),
        W_(model_.process_noise(kStep_s)),
        search_(capacity(setting)) {
    world_.bounds = {{0.0, 0.0}, {kSide_m, kSide_m}};
    field_ = models::DistanceField(world_, kFieldResolution_m);
    std::uniform_real_distribution<double> place(0.0, kSide_m);
    std::uniform_real_distribution<double> heading(-kPi, kPi);
    models::StateMatrix prior = models::StateMatrix::Zero(4, 4);
    prior.diagonal().head(2).setConstant(std::pow(setting.prior_position_sigma_m, 2));
    prior.diagonal().tail(2).setConstant(std::pow(setting.prior_velocity_sigma_mps, 2));
    for (int m = 0; m < setting.targets; ++m) {
      models::StateVector state = models::StateVector::Zero(4);
      state(0) = place(truth_rng_);
      state(1) = place(truth_rng_);
      truth_.push_back(state);
      beliefs_.push_back({state + draw(prior, truth_rng_), prior});
    }
    for (int i = 0; i < setting.robots; ++i) {
      const double x_m = place(truth_rng_);
      const double y_m = place(truth_rng_);
      poses_.push_back({x_m, y_m, heading(truth_rng_)});
    }
    problems_.resize(poses_.size());
    plans_.resize(poses_.size());
  }

  TrackingRun run() {
    TrackingRun run;
    for (int step = 0; step < setting_.task_steps; ++step) {
      if (step % setting_.plan_steps == 0) {
        plan();
      }
      move(step % setting_.plan_steps);
      observe();
      note(run);
    }
    return run;
  }

 private:
  static planner::SearchCapacity capacity(const TrackingSetting& setting) {
    return {index(static_cast<int>(setting.nodes_per_plan)) + 4'096, 4'000'000, setting.targets,
            setting.plan_steps, 0};
  }

  void set_up_problems() {
    for (std::size_t i = 0; i < problems_.size(); ++i) {
      planner::SearchProblem& problem = problems_[i];
      problem.start = poses_[i];
      problem.controls = models::standard_primitives();
      problem.horizon_steps = setting_.plan_steps;
      problem.step_s = kStep_s;
      problem.sensors = {tracking_sensor()};
      problem.world = &world_;
      problem.field = &field_;
      problem.targets.clear();
      for (const models::Gaussian& belief : beliefs_) {
        problem.targets.push_back({model_, belief});
      }
      problem.fixed_information.clear();
    }
  }

  double plan_robot(int robot, const std::vector<int>& beside) {
    planner::SearchProblem& problem = problems_[index(robot)];
    std::vector<planner::FixedTeammate> teammates;
    for (const int other : beside) {
      teammates.push_back({planner::to_trajectory(problems_[index(other)], plans_[index(other)]),
                           tracking_sensor(), false});
    }
    problem.fixed_information = planner::fixed_information(problem, teammates);
    plans_[index(robot)] = search_.plan(problem, {}, Deadline::nodes(setting_.nodes_per_plan));
    planner::SearchProblem blind = problem;
    blind.sensors.clear();
    const planner::SearchResult& plan = plans_[index(robot)];
    return 0.5 * (planner::score(blind, plan.poses) - plan.cost);
  }

  void plan() {
    set_up_problems();
    planner::plan_round_resiliently(
        setting_.robots, is_resilient_ ? setting_.attacks : 0,
        [&](int robot, const std::vector<int>& beside) { return plan_robot(robot, beside); });
    planner::TeamProblem team;
    team.targets = problems_.front().targets;
    team.horizon_steps = setting_.plan_steps;
    team.step_s = kStep_s;
    team.measure = planner::InformationMeasure::kLogDet;
    planner::Choice everybody;
    for (std::size_t i = 0; i < plans_.size(); ++i) {
      team.candidates.push_back({planner::make_candidate(problems_[i], {}, plans_[i])});
      everybody.push_back(static_cast<planner::CandidateId>(i));
    }
    const planner::TeamOracle oracle(team);
    attacked_.assign(plans_.size(), false);
    for (const int robot : planner::greedy_attack(oracle, everybody, setting_.attacks).robots) {
      attacked_[index(robot)] = true;
    }
  }

  void move(int step_of_plan) {
    for (std::size_t i = 0; i < poses_.size(); ++i) {
      poses_[i] = plans_[i].poses[index(step_of_plan)];
    }
    for (models::StateVector& state : truth_) {
      state = A_ * state + draw(W_, truth_rng_);
      reflect(state);
    }
    for (models::Gaussian& belief : beliefs_) {
      belief = estimator::reflect(models::predict(belief, A_, W_), world_.bounds);
    }
  }

  void observe() {
    const models::SensorModel sensor = tracking_sensor();
    for (std::size_t m = 0; m < truth_.size(); ++m) {
      const models::PositionVector target_m = truth_[m].head(2);
      // Those that should have seen it and did not say where it is not, before the others are
      // heard.
      for (std::size_t i = 0; i < poses_.size(); ++i) {
        const models::Viewpoint from{poses_[i], 0.0};
        if (!attacked_[i] && !models::in_view(sensor, from, target_m)) {
          beliefs_[m] = estimator::missed_detection(beliefs_[m], sensor, from, world_,
                                                    setting_.detection_probability);
        }
      }
      std::optional<models::Information> information = models::to_information(beliefs_[m]);
      for (std::size_t i = 0; information && i < poses_.size(); ++i) {
        const models::Viewpoint from{poses_[i], 0.0};
        if (attacked_[i] || !models::in_view(sensor, from, target_m)) {
          continue;
        }
        const models::Measurement z = models::sample(sensor, from, target_m, noise_rng_);
        static_cast<void>(estimator::measure(*information, sensor, from, z, 0.0));
      }
      const auto updated = information ? models::to_gaussian(*information) : std::nullopt;
      beliefs_[m] = updated.value_or(beliefs_[m]);
    }
  }

  void note(TrackingRun& run) const {
    double squared_m2 = 0.0;
    double entropy_nats = 0.0;
    for (std::size_t m = 0; m < truth_.size(); ++m) {
      squared_m2 += (truth_[m] - beliefs_[m].mean).head<2>().squaredNorm();
      entropy_nats += models::entropy_nats(beliefs_[m]);
    }
    const auto targets = static_cast<double>(truth_.size());
    run.rmse_m.push_back(std::sqrt(squared_m2 / targets));
    run.entropy_nats.push_back(entropy_nats / targets);
  }

  TrackingSetting setting_;
  bool is_resilient_;
  std::mt19937_64 truth_rng_;
  std::mt19937_64 noise_rng_;
  models::TargetModel model_;
  models::StateMatrix A_;
  models::StateMatrix W_;
  models::World world_;
  models::DistanceField field_;
  planner::RefiningBeam search_;
  std::vector<models::StateVector> truth_;
  std::vector<models::Gaussian> beliefs_;
  std::vector<Pose2> poses_;
  std::vector<planner::SearchProblem> problems_;
  std::vector<planner::SearchResult> plans_;
  std::vector<bool> attacked_;
};

}  // namespace

TrackingRun track_under_attack(const TrackingSetting& setting, bool is_resilient,
                               std::uint64_t seed) {
  return TrackingTask(setting, is_resilient, seed).run();
}

}  // namespace vantage::tools
