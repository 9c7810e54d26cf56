#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "logs/foxglove/parts.hpp"
#include "logs/foxglove/scene.hpp"
#include "logs/foxglove/schema.hpp"
#include "test/logs/foxglove_json.hpp"
#include "test/logs/foxglove_notebook.hpp"

namespace vantage::logs::foxglove {
namespace {

constexpr Time kTime = from_utime(1'700'000'000'250'000);

models::RobotPlan straight_plan(double speed_mps, double duration_s) {
  models::RobotPlan plan;
  plan.robot = "Q2";
  plan.round = 41;
  plan.stamp.time = kTime;
  plan.source = models::PlanSource::kSearched;
  plan.trajectory = {kTime, {1.0, -2.0, kPi / 2}, 1.25, {{{speed_mps, 0.0}, duration_s, 0.0}}};
  return plan;
}

TEST(PlanScene, HasEqualPiecesOfAtMostATenthOfASecond) {
  const Json scene = plan_scene(straight_plan(2.0, 1.65), std::nullopt);
  const Json& entity = scene.at("entities").at(0);
  EXPECT_EQ(entity.at("timestamp"), to_json(kTime));
  EXPECT_EQ(entity.at("lines").at(0).at("type"), 0);
  const auto points = points_of(entity.at("lines").at(0));
  ASSERT_EQ(points.size(), 18U) << "17 pieces";
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_NEAR(
        (points[i] - Eigen::Vector3d(1.0, -2.0 + 3.3 / 17.0 * static_cast<double>(i), 1.25)).norm(),
        0.0, 1e-5);
  }
  const Json& mark = entity.at("spheres").at(0);
  EXPECT_EQ(xyz(mark.at("pose").at("position")), points.back());
  EXPECT_EQ(told(entity, "round"), "41");
  EXPECT_EQ(told(entity, "source"), "searched");
  EXPECT_EQ(told(entity, "late"), "no");

  const auto pieces = [](const models::RobotPlan& plan) {
    return points_of(plan_scene(plan, std::nullopt).at("entities")[0].at("lines")[0]).size() - 1;
  };
  EXPECT_EQ(pieces(straight_plan(1.0, 0.1)), 1U);
  EXPECT_EQ(pieces(straight_plan(1.0, 0.1001)), 2U);
  models::RobotPlan rest = straight_plan(1.0, 1.0);
  rest.trajectory.segments.clear();
  EXPECT_EQ(pieces(rest), 1U);
  EXPECT_EQ(pieces(straight_plan(1e-3, 1e7)), 10'000U)
      << "only a foreign program would send such a plan";
}

TEST(PlanScene, IsColouredByPlanKind) {
  const Colour own{0.25, 0.5, 0.75};
  models::RobotPlan plan = straight_plan(1.0, 1.0);
  const auto colour = [&](const std::optional<Colour>& of_robot) {
    const Json entity = plan_scene(plan, of_robot).at("entities").at(0);
    EXPECT_EQ(entity.at("lines")[0].at("color"), entity.at("spheres")[0].at("color"));
    return entity.at("lines")[0].at("color");
  };
  EXPECT_EQ(colour(own), to_json(own));
  EXPECT_EQ(rgb(colour(std::nullopt)), robot_appearance(0).body_paint().middle());
  plan.source = models::PlanSource::kShifted;
  EXPECT_EQ(rgb(colour(own)), role("fallback"));
  plan.late = true;
  EXPECT_EQ(rgb(colour(own)), role("late"));
  plan.source = models::PlanSource::kSearched;
  EXPECT_EQ(rgb(colour(own)), role("late"));
}

TEST(ProposalScene, ShowsRobotAndGain) {
  models::TeamProposal proposal;
  proposal.robot = "Q3";
  proposal.round = 12;
  proposal.value_nats = 3.456;
  proposal.stamp.time = kTime;
  const Time received_at = kTime - from_seconds(0.75);
  for (const char* mover : {"Q1", "Q2"}) {
    proposal.choices.push_back({mover, straight_plan(1.0, 1.0).trajectory, 1.0, 0.1});
  }
  const Json entity = proposal_scene(proposal, lab(), received_at).at("entities").at(0);
  EXPECT_EQ(told(entity, "moves"), "Q1, Q2");
  EXPECT_EQ(told(entity, "value_nat"), "3.46");
  EXPECT_EQ(told(entity, "round"), "12");
  EXPECT_EQ(entity.at("lifetime"), to_json(from_seconds(0.75)));
  // Robots with an even index (Q3) draw the first, third and fifth of five parts of 0.2 s.
  const auto dashes = points_of(entity.at("lines").at(0));
  ASSERT_EQ(dashes.size(), 6U);
  for (std::size_t i = 0; i < 6; ++i) {
    const double along_m = 0.2 * static_cast<double>(i / 2 * 2 + i % 2);
    expect_near(dashes[i], {1.0, -2.0 + along_m, 1.25});
  }
}

PositionEstimate estimate_of(double sigma_x_m, double sigma_y_m) {
  PositionEstimate out;
  out.robot = "Q2";
  out.mean_m = Eigen::Vector2d(3.0, -1.0);
  out.covariance_m2 = Eigen::Vector2d(sigma_x_m * sigma_x_m, sigma_y_m * sigma_y_m).asDiagonal();
  return out;
}

// The distance alone does not suffice: points on one half of the ellipse would have the right
// distance, too.
TEST(Ellipse, SurroundsItsMeanAtItsHeight) {
  PositionEstimate estimate = estimate_of(0.5, 0.25);
  for (const int dim : {2, 3}) {
    if (dim == 3) {
      estimate.mean_m = Eigen::Vector3d(3.0, -1.0, 0.7);
      estimate.covariance_m2 = Eigen::Matrix3d::Identity();
    }
    const auto points = ellipse(estimate, 12);
    ASSERT_EQ(points.size(), 12U);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < points.size(); ++i) {
      sum += points[i];
      EXPECT_EQ(points[i].z(), dim == 3 ? 0.7 : 0.0);
      expect_near(points[i] + points[(i + 6) % 12],
                  2.0 * points[i].z() * Eigen::Vector3d::UnitZ() + Eigen::Vector3d(6.0, -2.0, 0.0));
    }
    expect_near(sum / 12.0, {3.0, -1.0, points[0].z()});
  }
}

TEST(EstimatesScene, MarksTheMeanAndStatesTheUncertainty) {
  EstimateView small{4, "R5", estimate_of(0.2, 0.2), 0.125, Duration{0}};
  EstimateView large{5, "R6", estimate_of(4.0, 2.0), std::nullopt, from_seconds(0.75)};
  const Json scene = estimates_scene("estimate", {small, large}, {"R1", "R2"}, kTime);
  ASSERT_EQ(scene.at("entities").size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    const Json& entity = scene.at("entities")[i];
    EXPECT_EQ(entity.at("id"), i == 0 ? "estimate/R5" : "estimate/R6");
    EXPECT_EQ(entity.at("timestamp"), to_json(kTime));
    EXPECT_EQ(entity.at("lifetime"), to_json(i == 0 ? Duration{0} : from_seconds(0.75)));
    const Json& loop = entity.at("lines").at(0);
    EXPECT_EQ(loop.at("type"), 1);
    EXPECT_EQ(rgb(loop.at("color")), role("estimate"));
    const double z_m = points_of(loop).front().z();
    EXPECT_GT(z_m, 0.01) << "above the ground, so that the two do not flicker";
    EXPECT_LT(z_m, 0.03);
    for (const Eigen::Vector3d& point : points_of(loop)) {
      EXPECT_EQ(point.z(), z_m);
    }
    // Half the length of the cross: a quarter of the root of the mean variance, but at least 10 cm.
    const double arm_m = i == 0 ? 0.1 : 0.25 * std::sqrt((16.0 + 4.0) / 2.0);
    const auto cross = points_of(entity.at("lines").at(1));
    ASSERT_EQ(cross.size(), 4U);
    EXPECT_EQ(entity.at("lines").at(1).at("type"), 2);
    expect_near(cross[0], {3.0 - arm_m, -1.0, z_m});
    expect_near(cross[1], {3.0 + arm_m, -1.0, z_m});
    expect_near(cross[2], {3.0, -1.0 - arm_m, z_m});
    expect_near(cross[3], {3.0, -1.0 + arm_m, z_m});
    expect_near(xyz(entity.at("texts")[0].at("pose").at("position")), {3.0, -1.0, z_m});
    EXPECT_EQ(told(entity, "robot"), "Q2");
    EXPECT_EQ(told(entity, "target_id"), i == 0 ? "4" : "5");
    EXPECT_EQ(told(entity, "sigma_m"), i == 0 ? "0.200" : "3.162");
    EXPECT_EQ(told(entity, "error_m"), i == 0 ? "0.125" : "nothing of error_m");
  }
  ASSERT_EQ(scene.at("deletions").size(), 2U);
  EXPECT_EQ(scene.at("deletions")[1],
            (Json{{"timestamp", to_json(kTime)}, {"type", 0}, {"id", "estimate/R2"}}));
}

TEST(TrackEntity, DrawsThePathInTheRobotsColour) {
  const std::vector<Eigen::Vector3d> way = {{1.0, 2.0, 3.0}, {4.0, 5.0, 6.0}};
  const Colour own{0.25, 0.5, 0.75};
  const Json robot = track_entity("Q1", way, own, kTime);
  EXPECT_EQ(robot.at("id"), "track/Q1");
  EXPECT_EQ(points_of(robot.at("lines").at(0)), way);
  EXPECT_EQ(robot.at("lines")[0].at("color").at("g"), 0.5);
  EXPECT_LT(robot.at("lines")[0].at("color").at("a"), 1.0);
  const Json target = track_entity("R1", way, std::nullopt, kTime);
  EXPECT_EQ(rgb(target.at("lines")[0].at("color")), role("truth"));
}

TEST(MeasurementScene, DrawsALinePerDetectionWithAPosition) {
  models::SensorModel sensor;
  sensor.kind = models::SensorKind::kPosition;
  models::RobotMeasurement looked;
  looked.robot = "Q1";
  looked.stamp.time = kTime;
  looked.viewpoint = {{1.0, 2.0, kPi / 2}, 1.5};
  looked.detections.resize(2);
  looked.detections[0].measurement.z = Eigen::Vector3d(1.0, 0.0, -1.25);  // ahead, 0.25 m high
  looked.detections[1].measurement.z = Eigen::Vector3d(0.0, 2.0, -1.5);   // on the left
  const Json entity = measurement_scene(looked, sensor, 3).at("entities").at(0);
  EXPECT_EQ(entity.at("id"), "measurement/Q1");
  EXPECT_EQ(entity.at("timestamp"), to_json(kTime));
  EXPECT_EQ(entity.at("lifetime"), to_json(from_seconds(0.4)));
  EXPECT_EQ(entity.at("lines").at(0).at("type"), 2);
  const auto points = points_of(entity.at("lines")[0]);
  ASSERT_EQ(points.size(), 4U);
  expect_near(points[0], {1.0, 2.0, 1.5});
  expect_near(points[1], {1.0, 3.0, 0.25});
  expect_near(points[2], {1.0, 2.0, 1.5});
  expect_near(points[3], {-1.0, 2.0, 0.0});
  EXPECT_EQ(told(entity, "detections"), "2");
  EXPECT_EQ(told(entity, "jammed"), "no");

  sensor.kind = models::SensorKind::kRange;
  looked.jammed = true;
  for (models::Detection& each : looked.detections) {
    each.measurement.z = models::MeasurementVector::Ones(1);
  }
  const Json nowhere = measurement_scene(looked, sensor, 2).at("entities").at(0);
  EXPECT_TRUE(nowhere.at("lines").empty());
  EXPECT_EQ(told(nowhere, "jammed"), "yes");
}

TEST(FoxgloveParts, ContainTheirArguments) {
  const Colour colour{0.1, 0.2, 0.3, 0.4};
  EXPECT_EQ(to_json(colour), (Json{{"r", 0.1}, {"g", 0.2}, {"b", 0.3}, {"a", 0.4}}));
  EXPECT_EQ(to_json(Quaternion(0.1, 0.2, 0.3, 0.4)),
            (Json{{"w", 0.1}, {"x", 0.2}, {"y", 0.3}, {"z", 0.4}}));
  const Json lasting = entity("a", "b", kTime, true);
  EXPECT_EQ(lasting.at("id"), "a");
  EXPECT_EQ(lasting.at("frame_id"), "b");
  EXPECT_EQ(lasting.at("lifetime"), (Json{{"sec", 0}, {"nsec", 0}}))
      << "displayed until it is replaced";
  const Json drawn = line(LineType::kLoop, {{1.0, 2.0, 3.0}}, 2.5, colour);
  EXPECT_EQ(drawn.at("thickness"), 2.5);
  EXPECT_EQ(drawn.at("scale_invariant"), true);
  EXPECT_EQ(drawn.at("type"), 1);
  EXPECT_EQ(drawn.at("color"), to_json(colour));
  const Json words = label("hello", {1.0, 2.0, 3.0}, 11.0, colour);
  EXPECT_EQ(words.at("font_size"), 11.0);
  EXPECT_EQ(words.at("billboard"), true);
  EXPECT_EQ(words.at("text"), "hello");
  EXPECT_EQ(to_json(Duration{-1'250'000}), (Json{{"sec", -2}, {"nsec", 750'000'000}}));
  EXPECT_EQ(to_json(Duration{-2'000'000}), (Json{{"sec", -2}, {"nsec", 0}}));
}

// The schema names of docs/reference/foxglove-topics.md, which existing layouts depend on.
TEST(NameOf, ReturnsEachSchemasName) {
  std::vector<std::string> names;
  for (const Schema each : kSchemas) {
    names.emplace_back(name_of(each));
    EXPECT_EQ(Json::parse(json_schema(each)).at("title"), names.back());
  }
  EXPECT_EQ(names,
            (std::vector<std::string>{
                "foxglove.SceneUpdate", "foxglove.Grid", "foxglove.FrameTransforms", "foxglove.Log",
                "vantage.Scenario", "vantage.Team", "vantage.Targets", "vantage.Plan",
                "vantage.Vehicle", "vantage.Health", "vantage.Attack", "vantage.Lcm"}));
}

}  // namespace
}  // namespace vantage::logs::foxglove
