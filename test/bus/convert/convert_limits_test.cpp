#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include <gtest/gtest.h>

#include "bus/convert/convert.hpp"
#include "bus/convert/convert_parts.hpp"
#include "test/bus/convert/changed_message.hpp"
#include "test/bus/convert/message_types.hpp"
#include "test/bus/convert/sample_messages.hpp"

// Limits of the fields of sensing and estimation messages: the last valid value is accepted and the
// first invalid one is rejected.

namespace vantage::bus {
namespace {

using test::Changed;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

template <class Message>
class MessageLimits : public ::testing::Test {};
TYPED_TEST_SUITE(MessageLimits, test::MessageTypes);

TYPED_TEST(MessageLimits, StampEndsInYear2286AndSequenceStartsAtZero) {
  test::Sampler sampler(41);
  auto sample = test::sample<TypeParam>(sampler);
  if constexpr (std::is_same_v<TypeParam, models::CompactBelief>) {
    sample.targets.clear();  // ages of targets and cells also limit the stamp
    sample.grid = {};
    sample.runs.clear();
  }
  const Changed<TypeParam> message(sample);
  message.utime("time", VANTAGE_FIELD(utime));
  message.whole("sequence", 0, VANTAGE_FIELD(sequence));
}

TEST(Limits, AreEnforcedForMocapFrames) {
  models::MocapFrame frame;
  frame.bodies = {{"first", {}, false}, {"last", {{1.0, 2.0, 3.0}, Quaternion::Identity()}, false}};
  const Changed<models::MocapFrame> message(frame);
  message.utime("arrival", VANTAGE_FIELD(arrival_utime));
  message.count("bodies", VANTAGE_FIELD(num_bodies));
  message.text("name", VANTAGE_FIELD(bodies[1].name));
  message.boolean("occluded", VANTAGE_FIELD(bodies[1].occluded));
  message.finite("x", VANTAGE_FIELD(bodies[1].position_world_m[0]));
  message.finite("y", VANTAGE_FIELD(bodies[1].position_world_m[1]));
  message.finite("z", VANTAGE_FIELD(bodies[1].position_world_m[2]));
  for (const double sign : {-1.0, 1.0}) {
    message.taken("nearly unit",
                  [sign](auto& w) { w.bodies[1].quaternion_wxyz[0] = 1.0 + sign * 0.999e-3; });
    message.refused("less nearly",
                    [sign](auto& w) { w.bodies[1].quaternion_wxyz[0] = 1.0 + sign * 1.001e-3; });
  }
  message.taken("as many bodies as there may be", [](auto& w) {
    w.bodies.resize(10'000, w.bodies[0]);
    w.num_bodies = 10'000;
  });
}

// A quaternion within 10⁻¹² of unit norm keeps its bits; any other is normalised.
TEST(Limits, AllowRoundingOfUnitVectors) {
  const double position_m[3] = {1.0, 2.0, 3.0};
  for (const double off : {-1.4e-12, -0.7e-12, 0.7e-12, 1.4e-12}) {
    const double wxyz[4] = {1.0 + off, 0.0, 0.0, 0.0};
    const auto pose = parts::pose3_from(position_m, wxyz);
    ASSERT_TRUE(pose);
    EXPECT_EQ(pose->rotation.w(), std::abs(off) < 1e-12 ? 1.0 + off : 1.0) << off;
  }
}

TEST(Limits, AreEnforcedForTruthFrames) {
  models::TruthFrame truth;
  truth.bodies.resize(2);
  const Changed<models::TruthFrame> message(truth);
  message.count("bodies", VANTAGE_FIELD(num_bodies));
  message.text("name", VANTAGE_FIELD(bodies[1].name));
  message.whole("target", -1, VANTAGE_FIELD(bodies[1].target_id));
  message.finite("x", VANTAGE_FIELD(bodies[1].position_world_m[0]));
  for (int axis = 0; axis < 3; ++axis) {
    message.finite(
        "velocity", [axis](auto& w) -> auto& { return w.bodies[1].velocity_world_mps[axis]; });
  }
}

TEST(Limits, AreEnforcedForDetections) {
  models::RobotMeasurement set;
  set.inputs = {{"A", 1, 2}, {"B", 3, 4}};
  set.detections.resize(2);
  for (models::Detection& detection : set.detections) {
    detection.measurement.z = Eigen::Vector2d(1.0, 2.0);
    detection.measurement.V = Eigen::Matrix2d(Eigen::Vector2d(4.0, 1.0).asDiagonal());
  }
  const Changed<models::RobotMeasurement> message(set);
  message.text("robot", VANTAGE_FIELD(robot));
  message.finite("x", VANTAGE_FIELD(x_world_m));
  message.finite("y", VANTAGE_FIELD(y_world_m));
  message.finite("yaw", VANTAGE_FIELD(yaw_world_rad));
  message.finite("height", VANTAGE_FIELD(height_m));
  message.boolean("jammed", VANTAGE_FIELD(jammed));
  message.count("detections", VANTAGE_FIELD(num_detections));
  message.count("inputs", VANTAGE_FIELD(num_inputs));
  message.text("channel of an input", VANTAGE_FIELD(inputs[1].channel));
  message.whole("sequence of an input", 0, VANTAGE_FIELD(inputs[1].sequence));
  message.whole("target", models::kNoTargetId, VANTAGE_FIELD(detections[1].target_id));
  message.finite("z", VANTAGE_FIELD(detections[1].z[1]));
  // Asymmetry of up to 10⁻⁹ of the largest entry is accepted as rounding error.
  for (const double off : {-4.4e-9, -3.6e-9, 3.6e-9, 4.4e-9}) {
    const auto change = [off](auto& w) { w.detections[1].covariance_z[0][1] = off; };
    std::abs(off) < 4e-9 ? message.taken("rounding", change) : message.refused("more", change);
  }
  message.refused("one element more in z", [](auto& w) { w.detections[1].z.push_back(0.0); });
  message.refused("a row more", [](auto& w) { w.detections[1].covariance_z.emplace_back(2, 0.0); });
  message.refused("a column more", [](auto& w) { w.detections[1].covariance_z[0].push_back(0.0); });
}

TEST(Limits, AreEnforcedForMatrices) {
  for (int dim = -1; dim <= 6; ++dim) {
    const auto side = static_cast<std::size_t>(std::max(dim, 0));
    parts::Rows rows(side, std::vector<double>(side, 0.0));
    for (std::size_t i = 0; i < side; ++i) {
      rows[i][i] = 1.0 + static_cast<double>(i);
    }
    const auto M = parts::definite_from(rows, dim);
    EXPECT_EQ(M.has_value(), dim >= 1 && dim <= 4) << dim;
    if (M) {
      EXPECT_EQ(parts::rows_to(*M, dim), rows);
      EXPECT_FALSE(parts::definite_from(rows, dim - 1).has_value());
      EXPECT_FALSE(parts::definite_from(rows, dim + 1).has_value());
    }
  }
  // Missing entries of a matrix become NaN; surplus entries are dropped.
  const parts::SmallMatrix M = Eigen::Matrix2d(Eigen::Vector2d(1.0, 2.0).asDiagonal());
  const parts::Rows more = parts::rows_to(M, 3);
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) {
      EXPECT_EQ(std::isnan(more[i][j]), i == 2 || j == 2) << i << j;
    }
  }
  EXPECT_EQ(parts::rows_to(M, 1), (parts::Rows{{1.0}}));
}

models::RobotBelief belief_of_two() {
  models::RobotBelief belief;
  belief.targets.resize(2);
  for (std::size_t i = 0; i < 2; ++i) {
    belief.targets[i].target_id = static_cast<int>(3 * i);
    belief.targets[i].information.vector = Eigen::Vector2d(1.0, 2.0);
    belief.targets[i].information.matrix = Eigen::Matrix2d::Identity();
  }
  belief.grid = {{1.0, 2.0}, 0.5, 2, 3};
  belief.last_seen_utime.assign(6, 0);
  belief.inputs = {{"A", 1, 2}};
  return belief;
}

TEST(Limits, AreEnforcedForBeliefs) {
  const Changed<models::RobotBelief> message(belief_of_two());
  message.text("robot", VANTAGE_FIELD(robot));
  message.whole("step", 0, VANTAGE_FIELD(step));
  message.whole("degree", 0, VANTAGE_FIELD(degree));
  message.count("targets", VANTAGE_FIELD(num_targets));
  message.count("cells", VANTAGE_FIELD(num_cells));
  message.count("inputs", VANTAGE_FIELD(num_inputs));
  message.finite("x", VANTAGE_FIELD(x_world_m));
  message.finite("height", VANTAGE_FIELD(height_m));
  message.finite("origin", VANTAGE_FIELD(grid_origin_x_m));
  message.finite("origin", VANTAGE_FIELD(grid_origin_y_m));
  for (const double bad_m : {0.0, -0.5, kNan, kInfinity}) {
    message.refused("resolution", [bad_m](auto& w) { w.grid_resolution_m = bad_m; });
  }
  message.whole("id of the first", 0, VANTAGE_FIELD(targets[0].target_id), 2);
  message.whole("id of the last", 1, VANTAGE_FIELD(targets[1].target_id));
  message.finite("vector", VANTAGE_FIELD(targets[1].information_vector[1]));
  message.utime("seen last", VANTAGE_FIELD(targets[1].last_seen_utime));
  message.utime("cell seen last", VANTAGE_FIELD(last_seen_utime[5]));
  for (const int dim : {2, 4}) {  // the smallest and the largest valid dimension
    message.taken("dimension", [dim](auto& w) {
      const auto side = static_cast<std::size_t>(dim);
      w.targets[1].dim = dim;
      w.targets[1].information_vector.assign(side, 1.0);
      w.targets[1].information_matrix =
          parts::rows_to(parts::SmallMatrix(Eigen::MatrixXd::Identity(dim, dim)), dim);
    });
  }
  for (const int dim : {1, 5}) {
    message.refused("dimension", [dim](auto& w) {
      const auto side = static_cast<std::size_t>(dim);
      w.targets[1].dim = dim;
      w.targets[1].information_vector.assign(side, 1.0);
      w.targets[1].information_matrix.assign(side, std::vector<double>(side, 0.0));
      for (std::size_t i = 0; i < side; ++i) {
        w.targets[1].information_matrix[i][i] = 1.0;
      }
    });
  }
  const auto with_grid = [](std::int32_t columns, std::int32_t rows) {
    return [columns, rows](auto& w) {
      w.grid_columns = columns;
      w.grid_rows = rows;
      w.num_cells = columns * rows;
      w.last_seen_utime.assign(static_cast<std::size_t>(w.num_cells), 0);
    };
  };
  message.taken("a million cells", with_grid(1'000, 1'000));
  message.refused("and one", with_grid(1, 1'000'001));
  message.taken("no cell", with_grid(0, 0));
  message.refused("fewer columns than none", with_grid(-1, 0));
  message.refused("fewer rows than none", with_grid(0, -1));
}

TEST(Limits, AreEnforcedForMixtures) {
  models::BeliefMixture mixture;
  mixture.targets.resize(2);
  for (std::size_t i = 0; i < 2; ++i) {
    mixture.targets[i].target_id = static_cast<int>(i);
    for (const double weight : {0.25, 0.75}) {
      mixture.targets[i].components.push_back(
          {weight, {Eigen::Vector2d(1.0, 2.0), Eigen::Matrix2d::Identity()}});
    }
  }
  const Changed<models::BeliefMixture> message(mixture);
  message.text("robot", VANTAGE_FIELD(robot));
  message.whole("step", 0, VANTAGE_FIELD(step));
  message.count("targets", VANTAGE_FIELD(num_targets));
  message.count("components", VANTAGE_FIELD(targets[1].num_components));
  message.finite("mean", VANTAGE_FIELD(targets[1].components[1].mean[1]));
  for (const double off : {-1.2e-6, -0.8e-6, 0.8e-6, 1.2e-6}) {
    const auto change = [off](auto& w) { w.targets[1].components[0].weight += off; };
    std::abs(off) < 1e-6 ? message.taken("rounding", change) : message.refused("more", change);
  }
  message.refused("more than all and less than none", [](auto& w) {
    w.targets[1].components[0].weight = 1.25;
    w.targets[1].components[1].weight = -0.25;
  });
  message.taken("all in one", [](auto& w) {
    w.targets[1].num_components = 1;
    w.targets[1].components.resize(1);
    w.targets[1].components[0].weight = 1.0;
  });
  message.refused("existence below none", [](auto& w) { w.targets[1].existence = -0.5; });
}

TEST(Limits, AreEnforcedForScans) {
  models::RangeScan scan;
  scan.field_of_view_rad = 1.0;
  scan.range_max_m = 5.0;
  scan.ranges_m = {1.0, -0.1};
  scan.inputs = {{"A", 1, 2}};
  const Changed<models::RangeScan> message(scan);
  message.text("robot", VANTAGE_FIELD(robot));
  message.count("beams", VANTAGE_FIELD(num_beams));
  message.count("inputs", VANTAGE_FIELD(num_inputs));
  message.finite("range", VANTAGE_FIELD(range_m[1]));
  message.finite("y", VANTAGE_FIELD(y_world_m));
  message.taken("a full turn", [](auto& w) { w.field_of_view_rad = 2.0 * kPi; });
  for (const double bad : {-1.0, 0.0, 2.0 * kPi + 1e-6, kNan, kInfinity}) {
    message.refused("field of view", [bad](auto& w) { w.field_of_view_rad = bad; });
  }
  for (const double bad : {-1.0, 0.0, kNan, kInfinity}) {
    message.refused("longest range", [bad](auto& w) { w.range_max_m = bad; });
  }
}

TEST(Limits, AreEnforcedForMaps) {
  models::RobotMap map;
  map.grid = {{1.0, 2.0}, 0.5, 2, 3};
  map.own_looks = {1, 2, 3, 4, 5, 6};
  map.team_looks = {7, 8, 9};
  const Changed<models::RobotMap> message(map);
  message.text("robot", VANTAGE_FIELD(robot));
  message.whole("step", 0, VANTAGE_FIELD(step));
  message.count("cells", VANTAGE_FIELD(num_cells));
  message.amount("entropy", VANTAGE_FIELD(entropy_nat));
  message.refused("a team's cell more", [](auto& w) { w.team_looks.push_back(0); });
  // The team's counts are padded with zeros up to the number of cells.
  const auto back = from_wire(to_wire(map));
  ASSERT_TRUE(back);
  EXPECT_EQ(back->team_looks, (std::vector<std::int16_t>{7, 8, 9, 0, 0, 0}));
}

// A text of the autopilot that is too long is shortened; the other fields remain valid.
TEST(Limits, ShortenLongReasonsOfVehicleStatuses) {
  const auto decoded_reasons = [](const std::string& reason) {
    models::VehicleStatus status;
    status.reasons = {reason, "and this"};
    const auto back = from_wire(to_wire(status));
    return back ? back->reasons : std::vector<std::string>{"refused"};
  };
  for (const std::size_t bytes : {std::size_t{0}, std::size_t{255}, std::size_t{256}}) {
    const std::string whole(bytes, 'r');
    EXPECT_EQ(decoded_reasons(whole), (std::vector<std::string>{whole, "and this"})) << bytes;
  }
  for (const std::size_t bytes : {257U, 258U, 500U, 100'000U}) {
    EXPECT_EQ(decoded_reasons(std::string(bytes, 'r')),
              (std::vector<std::string>{std::string(253, 'r') + "…", "and this"}))
        << bytes;
  }
  // No character is split: byte 253 is inside a character of two, three or four bytes.
  for (const std::string& character : {std::string("ü"), std::string("→"), std::string("😀")}) {
    for (std::size_t before = 0; before < 4; ++before) {
      std::string text(before, 'r');
      while (text.size() <= 256) {
        text += character;
      }
      const std::string cut = decoded_reasons(text).front();
      EXPECT_LE(cut.size(), 256U);
      EXPECT_GT(cut.size(), 256U - character.size());
      const std::string kept = cut.substr(0, cut.size() - std::string("…").size());
      EXPECT_EQ(cut, kept + "…");
      EXPECT_EQ(text.substr(0, kept.size()), kept);
      EXPECT_EQ((kept.size() - before) % character.size(), 0U);
    }
  }
  // Counter names contain channel names, which may contain arbitrary bytes.
  models::ProcessHealth health;
  health.counters = {{"VEHICLE_\xff.unsigned", 3}, {std::string(300, 'c'), 4}};
  const auto counted = from_wire(to_wire(health));
  ASSERT_TRUE(counted);
  EXPECT_EQ(counted->counters[0].name, "VEHICLE_\\xFF.unsigned");
  EXPECT_EQ(counted->counters[1].name, std::string(253, 'c') + "…");
  const std::string torn = std::string("a") + '\xe2' + '\0' + "b";
  EXPECT_EQ(decoded_reasons(torn), (std::vector<std::string>{"a\\xE2\\x00b", "and this"}));
}

}  // namespace
}  // namespace vantage::bus
