#include "tools/plan/plan_report.hpp"

#include <filesystem>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "planner/search/catalogue.hpp"

namespace vantage::tools {
namespace {

using nlohmann::json;

std::string in_repo(const std::string& name) {
  return VANTAGE_SOURCE_DIR "/test/tools/problems/" + name;
}

PlanOutcome solve(const PlanningProblem& planning, std::string_view algorithm,
                  std::int64_t nodes = 20'000) {
  PlanOutcome outcome;
  outcome.source = "p.json";
  outcome.algorithm = algorithm;
  const planner::Algorithm& chosen = planner::algorithm_called(algorithm);
  const auto search = chosen.make(
      planner::capacity_for(chosen, planning.problem, std::size_t{64} << 20, 200'000), {});
  outcome.result = search->plan(planning.problem, Deadline::nodes(nodes));
  outcome.peak_bytes = search->peak_bytes();
  return outcome;
}

// Computes the cost of the printed controls from the printed problem alone: dense matrices,
// explicit inverses, unicycle motion in closed form, H at the true distance.
double rescore(const PlanningProblem& planning, const json& printed) {
  const planner::SearchProblem& problem = planning.problem;
  const models::SensorModel& sensor = problem.sensors[0];
  double cost = 0.0;
  for (const planner::SearchTarget& target : problem.targets) {
    const Eigen::Index n = target.prior.mean.size();
    const double tau = problem.step_s;
    const double q = target.model.q;
    Eigen::MatrixXd A = Eigen::MatrixXd::Identity(n, n);
    Eigen::MatrixXd W = Eigen::MatrixXd::Zero(n, n);
    if (n == 4) {
      for (Eigen::Index i = 0; i < 2; ++i) {
        A(i, i + 2) = tau;
        W(i, i) = q * tau * tau * tau / 3.0;
        W(i, i + 2) = W(i + 2, i) = q * tau * tau / 2.0;
        W(i + 2, i + 2) = q * tau;
      }
    }
    Eigen::VectorXd mean = target.prior.mean;
    Eigen::MatrixXd covariance = target.prior.covariance;
    double x = problem.start.x_m;
    double y = problem.start.y_m;
    double yaw = problem.start.yaw_rad;
    for (std::size_t t = 0; t < printed["controls"].size(); ++t) {
      const auto& control = problem.controls[printed["controls"][t].get<std::size_t>()];
      const double v = control.speed_mps;
      const double w = control.yaw_rate_radps;
      x += w == 0.0 ? v * tau * std::cos(yaw) : v / w * (std::sin(yaw + w * tau) - std::sin(yaw));
      y += w == 0.0 ? v * tau * std::sin(yaw) : v / w * (std::cos(yaw) - std::cos(yaw + w * tau));
      yaw += w * tau;
      EXPECT_NEAR(printed["states"][t][0].get<double>(), x, 1e-9);
      EXPECT_NEAR(printed["states"][t][1].get<double>(), y, 1e-9);
      EXPECT_NEAR(std::remainder(printed["states"][t][2].get<double>() - yaw, 2.0 * kPi), 0, 1e-9);
      mean = (A * mean).eval();
      covariance = (A * covariance * A.transpose() + W).eval();
      const double dx = mean(0) - x;
      const double dy = mean(1) - y;
      const double d = std::hypot(dx, dy);
      const double bearing = std::remainder(std::atan2(dy, dx) - yaw, 2.0 * kPi);
      const bool all_round = sensor.fov_rad >= 2.0 * kPi;
      if (d < sensor.range_max_m && (all_round || std::abs(bearing) < 0.5 * sensor.fov_rad) &&
          models::line_of_sight(*planning.world, {x, y}, {mean(0), mean(1)})) {
        Eigen::MatrixXd H = Eigen::MatrixXd::Zero(2, n);
        Eigen::MatrixXd V_inverse = Eigen::MatrixXd::Zero(2, 2);
        H.block(0, 0, 1, 2) << dx / d, dy / d;
        V_inverse(0, 0) = std::pow(sensor.range_sigma_m, -2);
        if (sensor.kind == models::SensorKind::kRangeBearing) {
          H.block(1, 0, 1, 2) << -dy / (d * d), dx / (d * d);
          V_inverse(1, 1) = std::pow(sensor.bearing_sigma_rad, -2);
        }
        covariance = (covariance.inverse() + H.transpose() * V_inverse * H).inverse().eval();
      }
      cost += problem.cost == planner::CostKind::kLogDet ? std::log(covariance.determinant())
                                                         : covariance.trace();
    }
  }
  return cost;
}

// Checks every millimetre of the path by the closed form of the arc.
void expect_clear_way(const PlanningProblem& planning, const json& printed) {
  Pose2 from = planning.problem.start;
  for (const json& control : printed["controls"]) {
    const auto& u = planning.problem.controls[control.get<std::size_t>()];
    constexpr int kPieces = 2'000;
    for (int k = 1; k <= kPieces; ++k) {
      const Pose2 at = models::step_unicycle(from, u, planning.problem.step_s * k / kPieces);
      ASSERT_GT(models::clearance_m(*planning.world, at.position_m()), 0.0);
    }
    from = models::step_unicycle(from, u, planning.problem.step_s);
  }
}

TEST(PlanReport, PrintsTheCostOfItsControls) {
  for (const char* name : {"tracking.json", "mapping.json"}) {
    const PlanningProblem planning = load_problem(in_repo(name));
    for (const planner::Algorithm& algorithm : planner::all_algorithms()) {
      SCOPED_TRACE(std::string(name) + " " + std::string(algorithm.name));
      const json printed = json::parse(to_json(planning, solve(planning, algorithm.name)).dump());
      if (!printed["found"].get<bool>()) {
        EXPECT_TRUE(printed["cost"].is_null());
        continue;
      }
      ASSERT_EQ(std::ssize(printed["controls"]), planning.problem.horizon_steps);
      ASSERT_EQ(printed["states"].size(), printed["controls"].size());
      const double cost = printed["cost"];
      EXPECT_NEAR(cost, rescore(planning, printed), 1e-9 * std::max(1.0, std::abs(cost)));
      if (!printed["lower_bound"].is_null()) {
        EXPECT_LE(printed["lower_bound"].get<double>(), cost);
        EXPECT_DOUBLE_EQ(printed["gap"], cost - printed["lower_bound"].get<double>());
      }
      expect_clear_way(planning, printed);
    }
  }
}

TEST(PlanReport, HasEveryKeyOfTheInterface) {
  const PlanningProblem planning = load_problem(in_repo("tracking.json"));
  const auto printed = to_json(planning, solve(planning, "greedy"));
  for (const char* key :
       {"cost", "controls", "states", "lower_bound", "gap", "epsilon", "delta", "nodes_generated",
        "nodes_expanded", "elapsed_s", "cpu_s", "peak_bytes", "stop_reason"}) {
    EXPECT_TRUE(printed.contains(key)) << key;
  }
  EXPECT_TRUE(printed["epsilon"].is_null()) << "infinite after the greedy pass only";
  EXPECT_EQ(printed["stop_reason"], "converged");
  EXPECT_GT(printed["peak_bytes"], 0);
}

TEST(PlanReport, ReportsMissingContinuation) {
  PlanningProblem planning = load_problem(in_repo("mapping.json"));
  planning.world->obstacles.push_back({{{0.5, 0.5}, {1.4, 1.5}}, 10.0});
  planning.world->obstacles.push_back({{{1.6, 0.5}, {2.5, 1.5}}, 10.0});
  planning.world->obstacles.push_back({{{0.5, 1.01}, {2.5, 1.5}}, 10.0});
  planning.world->obstacles.push_back({{{0.5, 0.5}, {2.5, 0.99}}, 10.0});
  planning.problem.field = nullptr;
  const auto printed = to_json(planning, solve(planning, "fvi"));
  EXPECT_EQ(printed["found"], false);
  EXPECT_TRUE(printed["cost"].is_null());
  EXPECT_TRUE(printed["gap"].is_null());
  EXPECT_TRUE(printed["controls"].empty());
}

TEST(PlanReport, AdvisesASearchWithProofIfTheBoundIsLoose) {
  PlanOutcome outcome;
  outcome.algorithm = "beam";
  outcome.result.cost = -10.0;
  outcome.result.lower_bound = -20.0;
  outcome.result.stop_reason = planner::StopReason::kDeadline;
  EXPECT_TRUE(hint_for(outcome).starts_with("the bound is loose; --algorithm astar"));
  outcome.result.lower_bound = -10.0;
  EXPECT_EQ(hint_for(outcome), "");
  outcome.result.lower_bound = -20.0;
  outcome.algorithm = "astar";
  EXPECT_EQ(hint_for(outcome), "");
}

TEST(PlanReport, DrawsThePlan) {
  const PlanningProblem planning = load_problem(in_repo("tracking.json"));
  const std::string svg = draw_plan_picture(planning, solve(planning, "greedy"));
  const auto count = [&](std::string_view words) {
    int found = 0;
    for (std::size_t at = svg.find(words); at != std::string::npos; at = svg.find(words, at + 1)) {
      ++found;
    }
    return found;
  };
  EXPECT_EQ(count("class=\"plan\""), 1);
  EXPECT_EQ(count("class=\"obstacle\""), 1);
  EXPECT_EQ(count("class=\"target\""), 3);
  EXPECT_EQ(count("class=\"view\""), planning.problem.horizon_steps);
}

// Uses the public problems in the folder next to the data; skipped if they are missing.
TEST(PlanReport, ScoresThePublicProblems) {
  const std::filesystem::path folder =
      std::filesystem::path(VANTAGE_DATA_DIR).parent_path() / "problems";
  if (!std::filesystem::exists(folder)) {
    GTEST_SKIP() << "no problems next to " << VANTAGE_DATA_DIR;
  }
  int problems = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".json") {
      continue;
    }
    ++problems;
    SCOPED_TRACE(entry.path().filename().string());
    const PlanningProblem planning = load_problem(entry.path().string());
    const json printed = json::parse(to_json(planning, solve(planning, "arvi")).dump());
    ASSERT_TRUE(printed["found"].get<bool>());
    const double cost = printed["cost"];
    EXPECT_NEAR(cost, rescore(planning, printed), 1e-9 * std::abs(cost));
    expect_clear_way(planning, printed);
  }
  EXPECT_GE(problems, 4);
}

}  // namespace
}  // namespace vantage::tools
