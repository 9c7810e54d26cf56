#include "bus/convert/convert.hpp"

#include <limits>

#include "bus/convert/convert_parts.hpp"
#include "bus/convert/wire_walk.hpp"
#include "test/bus/convert/flat_message.hpp"
#include "test/bus/convert/message_types.hpp"
#include "test/bus/convert/sample_messages.hpp"

namespace vantage::bus {
namespace {

namespace wire = vantage_lcm;

// Small norm errors in either direction are normalised; a unit quaternion keeps its bits.
TEST(Pose3From, NormalisesANearlyUnitQuaternion) {
  const double position_m[3] = {1.0, -2.0, 3.0};
  for (const double norm : {1.0 - 5e-4, 1.0 - 1e-6, 1.0, 1.0 + 1e-6, 1.0 + 5e-4}) {
    const double wxyz[4] = {0.6 * norm, 0.0, 0.0, 0.8 * norm};
    const auto pose = parts::pose3_from(position_m, wxyz);
    ASSERT_TRUE(pose) << norm;
    EXPECT_NEAR(pose->rotation.norm(), 1.0, 1e-15) << norm;
    EXPECT_NEAR(pose->rotation.z(), 0.8, 1e-15) << norm;
    EXPECT_TRUE(norm != 1.0 || (pose->rotation.w() == 0.6 && pose->rotation.z() == 0.8));
  }
}

template <class Message>
class EveryMessage : public ::testing::Test {};
TYPED_TEST_SUITE(EveryMessage, test::MessageTypes);

TYPED_TEST(EveryMessage, RoundTripsBitForBit) {
  test::Sampler sampler(1);
  for (int i = 0; i < 200; ++i) {
    const auto message = test::sample<TypeParam>(sampler);
    const auto wire = decode_wire<WireOf<TypeParam>>(test::encoded(message));
    ASSERT_TRUE(wire.has_value());
    const auto back = from_wire(*wire);
    ASSERT_TRUE(back.has_value());
    ASSERT_EQ(test::Flat::of(*back), test::Flat::of(message));
  }
}

TYPED_TEST(EveryMessage, RefusesAnImpossibleStamp) {
  test::Sampler sampler(2);
  const auto good = to_wire(test::sample<TypeParam>(sampler));
  auto bad = good;
  bad.sequence = -1;
  EXPECT_FALSE(from_wire(bad).has_value());
  bad = good;
  bad.utime = std::numeric_limits<std::int64_t>::min();
  EXPECT_FALSE(from_wire(bad).has_value());
  bad.utime = std::numeric_limits<std::int64_t>::max();
  EXPECT_FALSE(from_wire(bad).has_value());
}

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Returns a random message, as wire type, for which `has_enough` returns true: every list that a
/// test changes has at least one element.
template <class Message, class HasEnough>
WireOf<Message> rich_wire(const HasEnough& has_enough) {
  test::Sampler sampler(3);
  for (;;) {
    const auto message = test::sample<Message>(sampler);
    if (has_enough(message)) {
      return to_wire(message);
    }
  }
}

/// Checks that `good` is accepted, and that it is refused after `spoil` has changed it.
template <class Wire>
void expect_refused(const Wire& good, void (*spoil)(Wire&), const char* what) {
  ASSERT_TRUE(from_wire(good).has_value()) << "before the change: " << what;
  Wire bad = good;
  spoil(bad);
  EXPECT_FALSE(from_wire(bad).has_value()) << what;
}

template <class Wire>
void expect_accepted(const Wire& good, void (*change)(Wire&), const char* what) {
  Wire changed = good;
  change(changed);
  EXPECT_TRUE(from_wire(changed).has_value()) << what;
}

TEST(FromWireMocapFrame, RefusesInvalidValues) {
  auto good = rich_wire<models::MocapFrame>([](const auto& m) { return m.bodies.size() >= 2; });
  for (auto& body : good.bodies) {
    body.occluded = 0;
  }
  expect_refused<wire::mocap_frame_t>(
      good, [](wire::mocap_frame_t& w) { w.bodies[1].position_world_m[2] = kNan; }, "NaN position");
  expect_refused<wire::mocap_frame_t>(
      good, [](wire::mocap_frame_t& w) { w.bodies[0].quaternion_wxyz[3] = kInfinity; },
      "quaternion");
  expect_refused<wire::mocap_frame_t>(
      good,
      [](wire::mocap_frame_t& w) {
        for (double& q : w.bodies[0].quaternion_wxyz) {
          q = 0.0;
        }
      },
      "zero quaternion");
  expect_refused<wire::mocap_frame_t>(
      good,
      [](wire::mocap_frame_t& w) {
        for (double& q : w.bodies[0].quaternion_wxyz) {
          q *= 1.002;
        }
      },
      "quaternion too long");
  expect_refused<wire::mocap_frame_t>(
      good, [](wire::mocap_frame_t& w) { w.bodies[0].occluded = 2; }, "boolean 2");
  expect_refused<wire::mocap_frame_t>(
      good, [](wire::mocap_frame_t& w) { w.bodies[0].name.assign(257, 'x'); }, "long name");
  expect_refused<wire::mocap_frame_t>(
      good, [](wire::mocap_frame_t& w) { w.bodies[0].name = std::string("a\0b", 3); },
      "NUL in a name");
  expect_refused<wire::mocap_frame_t>(
      good, [](wire::mocap_frame_t& w) { w.bodies[0].name = "\xC3("; }, "not UTF-8");
  expect_refused<wire::mocap_frame_t>(
      good, [](wire::mocap_frame_t& w) { ++w.num_bodies; }, "count above the elements");
  expect_refused<wire::mocap_frame_t>(
      good, [](wire::mocap_frame_t& w) { w.num_bodies = -1; }, "negative count");
  expect_refused<wire::mocap_frame_t>(
      good, [](wire::mocap_frame_t& w) { w.arrival_utime = std::int64_t{1} << 62; }, "far future");
  expect_refused<wire::mocap_frame_t>(
      good,
      [](wire::mocap_frame_t& w) {
        w.bodies.resize(10'001, w.bodies[0]);
        w.num_bodies = 10'001;
      },
      "too many bodies");
}

TEST(FromWireMocapFrame, NormalisesANearlyUnitQuaternion) {
  auto wire = rich_wire<models::MocapFrame>([](const auto& m) { return !m.bodies.empty(); });
  for (double& q : wire.bodies[0].quaternion_wxyz) {
    q *= 1.0009;
  }
  const auto frame = from_wire(wire);
  ASSERT_TRUE(frame.has_value());
  EXPECT_NEAR(frame->bodies[0].world_from_body.rotation.norm(), 1.0, 1e-15);
}

TEST(FromWireMocapFrame, DropsPosesOfOccludedBodies) {
  auto wire = rich_wire<models::MocapFrame>([](const auto& m) { return !m.bodies.empty(); });
  wire.bodies[0].occluded = 1;
  wire.bodies[0].position_world_m[0] = kNan;
  const auto frame = from_wire(wire);
  ASSERT_TRUE(frame.has_value());
  EXPECT_TRUE(frame->bodies[0].occluded);
  EXPECT_TRUE(frame->bodies[0].world_from_body.translation_m.allFinite());
}

TEST(FromWireMeasurement, RefusesInvalidValues) {
  const auto good = rich_wire<models::RobotMeasurement>([](const auto& m) {
    return !m.inputs.empty() && m.detections.size() >= 2 &&
           m.detections[0].measurement.z.size() == 3;
  });
  const auto refused = [&](void (*spoil)(wire::measurement_t&), const char* what) {
    expect_refused(good, spoil, what);
  };
  refused([](wire::measurement_t& w) { w.x_world_m = kNan; }, "NaN x");
  refused([](wire::measurement_t& w) { w.yaw_world_rad = kInfinity; }, "infinite yaw");
  refused([](wire::measurement_t& w) { w.height_m = kNan; }, "NaN height");
  refused([](wire::measurement_t& w) { w.robot.assign(300, 'Q'); }, "long robot name");
  refused([](wire::measurement_t& w) { w.jammed = -1; }, "boolean -1");
  refused([](wire::measurement_t& w) { w.detections[0].target_id = -2; }, "negative id");
  refused([](wire::measurement_t& w) { w.detections[0].z[1] = kNan; }, "NaN z");
  refused([](wire::measurement_t& w) { w.detections[0].dim = 4; }, "dim 4");
  refused([](wire::measurement_t& w) { w.detections[0].dim = 0; }, "dim 0");
  refused([](wire::measurement_t& w) { w.detections[0].dim = 2; }, "dim that does not fit");
  refused([](wire::measurement_t& w) { w.detections[0].covariance_z[0][1] += 1e-6; },
          "asymmetric covariance");
  refused([](wire::measurement_t& w) { w.detections[0].covariance_z[0][0] = 0.0; },
          "singular covariance");
  refused([](wire::measurement_t& w) { w.detections[0].covariance_z[2][2] = -1.0; },
          "negative variance");
  refused([](wire::measurement_t& w) { w.detections[0].covariance_z[2].pop_back(); },
          "ragged covariance");
  refused([](wire::measurement_t& w) { w.inputs[0].sequence = -1; }, "negative input sequence");
  refused([](wire::measurement_t& w) { w.inputs[0].channel.assign(257, 'X'); },
          "long input channel");
  refused([](wire::measurement_t& w) { w.num_inputs = 0; }, "inputs beyond the count");
  refused([](wire::measurement_t& w) { w.num_detections = 1; }, "detections beyond the count");
}

TEST(FromWireBelief, RefusesInvalidValues) {
  const auto good =
      rich_wire<models::RobotBelief>([](const auto& m) { return m.targets.size() >= 3; });
  const auto refused = [&](void (*spoil)(wire::belief_t&), const char* what) {
    expect_refused(good, spoil, what);
  };
  refused([](wire::belief_t& w) { w.targets[0].information_vector[0] = kInfinity; },
          "infinite vector");
  refused([](wire::belief_t& w) { w.targets[0].information_matrix[0][0] = kNan; }, "NaN matrix");
  refused([](wire::belief_t& w) { w.targets[0].information_matrix[1][0] *= 1.0 + 1e-6; },
          "asymmetric");
  refused(
      [](wire::belief_t& w) {
        for (auto& row : w.targets[0].information_matrix) {
          for (double& x : row) {
            x = -x;
          }
        }
      },
      "negative definite");
  refused(
      [](wire::belief_t& w) {
        for (auto& row : w.targets[0].information_matrix) {
          for (double& x : row) {
            x = 1.0;
          }
        }
      },
      "rank one");
  refused(
      [](wire::belief_t& w) {
        for (auto& row : w.targets[0].information_matrix) {
          for (double& x : row) {
            x *= 1e308;
          }
        }
      },
      "overflowing");
  refused([](wire::belief_t& w) { w.targets[0].dim = 1; }, "dim 1");
  refused([](wire::belief_t& w) { w.targets[0].dim = 5; }, "dim 5");
  refused([](wire::belief_t& w) { w.targets[1].target_id = w.targets[0].target_id; },
          "an id twice");
  refused([](wire::belief_t& w) { std::swap(w.targets[0], w.targets[1]); }, "ids not ascending");
  refused([](wire::belief_t& w) { w.targets[0].last_seen_utime = std::int64_t{1} << 62; },
          "far future");
  refused([](wire::belief_t& w) { w.degree = -1; }, "negative degree");
  refused([](wire::belief_t& w) { w.step = -1; }, "negative step");
  refused([](wire::belief_t& w) { w.grid_resolution_m = 0.0; }, "cells of no size");
  refused([](wire::belief_t& w) { w.grid_origin_x_m = kNan; }, "NaN origin");
  refused([](wire::belief_t& w) { ++w.grid_columns; }, "columns × rows is not the cells");
  refused(
      [](wire::belief_t& w) {
        w.grid_columns = -w.grid_columns;
        w.grid_rows = -w.grid_rows;
      },
      "negative grid");
  refused(
      [](wire::belief_t& w) { w.last_seen_utime[0] = std::numeric_limits<std::int64_t>::min(); },
      "cell time");
  refused([](wire::belief_t& w) { w.last_seen_utime.pop_back(); }, "a cell missing");
  refused(
      [](wire::belief_t& w) {
        w.grid_columns = 1'000'001;
        w.grid_rows = 1;
        w.num_cells = 1'000'001;
        w.last_seen_utime.assign(1'000'001, 0);
      },
      "more than a million cells");
  // Rows times columns, 65536 · 65536, is 0 in 32 bits.
  refused(
      [](wire::belief_t& w) {
        w.grid_columns = w.grid_rows = 65'536;
        w.num_cells = 0;
        w.last_seen_utime.clear();
      },
      "a product that overflows");
}

TEST(FromWireBelief, AcceptsAsymmetryByRoundingErrors) {
  const auto good =
      rich_wire<models::RobotBelief>([](const auto& m) { return !m.targets.empty(); });
  expect_accepted<wire::belief_t>(
      good, [](wire::belief_t& w) { w.targets[0].information_matrix[1][0] *= 1.0 + 1e-13; },
      "rounding");
}

TEST(FromWireMixture, RefusesInvalidValues) {
  const auto good = rich_wire<models::BeliefMixture>(
      [](const auto& m) { return m.targets.size() >= 2 && m.targets[0].components.size() >= 2; });
  const auto refused = [&](void (*spoil)(wire::mixture_t&), const char* what) {
    expect_refused(good, spoil, what);
  };
  const auto accepted = [&](void (*change)(wire::mixture_t&), const char* what) {
    expect_accepted<wire::mixture_t>(good, change, what);
  };
  refused([](wire::mixture_t& w) { w.targets[0].components[0].mean[0] = kInfinity; }, "no mean");
  refused([](wire::mixture_t& w) { w.targets[0].components[0].covariance[0][0] = -1.0; },
          "not definite");
  refused([](wire::mixture_t& w) { w.targets[0].components[0].covariance[1][0] += 1e-3; },
          "asymmetric");
  refused([](wire::mixture_t& w) { w.targets[0].components[0].weight = 0.0; }, "of no weight");
  refused([](wire::mixture_t& w) { w.targets[0].components[0].weight += 1e-5; }, "more than all");
  refused([](wire::mixture_t& w) { w.targets[0].components[0].weight -= 1e-5; }, "less than all");
  accepted([](wire::mixture_t& w) { w.targets[0].components[0].weight += 1e-9; }, "rounding");
  refused([](wire::mixture_t& w) { w.targets[0].components[0].weight = kNan; }, "a weight of NaN");
  refused([](wire::mixture_t& w) { w.targets[0].existence = 0.0; }, "it does not exist");
  refused([](wire::mixture_t& w) { w.targets[0].existence = 1.0 + 1e-9; }, "more than surely");
  refused([](wire::mixture_t& w) { w.targets[0].existence = kNan; }, "an existence of NaN");
  accepted([](wire::mixture_t& w) { w.targets[0].existence = 1.0; }, "surely");
  refused(
      [](wire::mixture_t& w) {
        w.targets[0].num_components = 0;
        w.targets[0].components.clear();
      },
      "no component");
  refused([](wire::mixture_t& w) { --w.targets[0].num_components; }, "beyond the count");
  refused([](wire::mixture_t& w) { --w.num_targets; }, "targets beyond the count");
  refused(
      [](wire::mixture_t& w) {
        wire::mixture_component_t& other = w.targets[0].components[1];
        const int dim = other.dim == 2 ? 3 : 2;
        other.dim = dim;
        other.mean.assign(static_cast<std::size_t>(dim), 0.0);
        other.covariance.assign(static_cast<std::size_t>(dim),
                                std::vector<double>(static_cast<std::size_t>(dim), 0.0));
        for (int i = 0; i < dim; ++i) {
          other.covariance[static_cast<std::size_t>(i)][static_cast<std::size_t>(i)] = 1.0;
        }
      },
      "components of unlike states");
  refused([](wire::mixture_t& w) { w.targets[0].components[0].dim = 5; }, "dim 5");
  refused([](wire::mixture_t& w) { w.targets[1].target_id = w.targets[0].target_id; },
          "an id twice");
  refused([](wire::mixture_t& w) { std::swap(w.targets[0], w.targets[1]); }, "not ascending");
  refused([](wire::mixture_t& w) { w.targets[0].target_id = -1; }, "no target");
  refused([](wire::mixture_t& w) { w.step = -1; }, "negative step");
  refused([](wire::mixture_t& w) { w.robot = std::string(257, 'Q'); }, "a long name");
}

TEST(FromWirePlan, RefusesInvalidValues) {
  const auto good =
      rich_wire<models::RobotPlan>([](const auto& m) { return m.trajectory.segments.size() >= 3; });
  const auto refused = [&](void (*spoil)(wire::plan_t&), const char* what) {
    expect_refused(good, spoil, what);
  };
  refused([](wire::plan_t& w) { w.source = 3; }, "unknown source");
  refused([](wire::plan_t& w) { w.source = -1; }, "negative source");
  refused([](wire::plan_t& w) { w.start_x_world_m = kNan; }, "NaN start");
  refused([](wire::plan_t& w) { w.height_m = kInfinity; }, "infinite height");
  refused([](wire::plan_t& w) { w.segments[1].speed_mps = kNan; }, "NaN speed");
  refused([](wire::plan_t& w) { w.segments[1].yaw_rate_radps = kInfinity; }, "infinite yaw rate");
  refused([](wire::plan_t& w) { w.segments[1].duration_s = -0.1; }, "negative duration");
  refused([](wire::plan_t& w) { w.segments[1].brake_mps2 = -0.1; }, "negative brake");
  refused([](wire::plan_t& w) { w.start_y_world_m = -2e6; }, "place far away");
  refused([](wire::plan_t& w) { w.height_m = 1e300; }, "height of a star");
  refused([](wire::plan_t& w) { w.segments[1].speed_mps = -1e300; }, "speed beyond light");
  refused([](wire::plan_t& w) { w.segments[1].yaw_rate_radps = 1e9; }, "yaw rate of a rotor");
  refused([](wire::plan_t& w) { w.segments[1].brake_mps2 = 1e300; }, "brake of a wall");
  refused([](wire::plan_t& w) { w.segments[1].duration_s = 1e12; }, "motion for ever");
  refused([](wire::plan_t& w) { w.segments[1].duration_s = w.segments[2].duration_s = 1900.0; },
          "motion of more than an hour");
  refused([](wire::plan_t& w) { w.step_s = 0.0; }, "no step");
  refused([](wire::plan_t& w) { w.step_s = kNan; }, "NaN step");
  refused([](wire::plan_t& w) { w.horizon_steps = -1; }, "negative horizon");
  refused([](wire::plan_t& w) { w.cost_nat = kInfinity; }, "infinite cost");
  refused([](wire::plan_t& w) { w.lower_bound_nat = kNan; }, "NaN bound");
  refused([](wire::plan_t& w) { w.lower_bound_nat = kInfinity; }, "bound +inf");
  refused([](wire::plan_t& w) { w.epsilon = kNan; }, "NaN epsilon");
  refused([](wire::plan_t& w) { w.epsilon = -0.5; }, "negative epsilon");
  refused([](wire::plan_t& w) { w.delta_m = kNan; }, "NaN delta");
  refused([](wire::plan_t& w) { w.passes = -1; }, "negative passes");
  refused([](wire::plan_t& w) { w.nodes = -1; }, "negative nodes");
  refused([](wire::plan_t& w) { w.deadline_utime = std::int64_t{1} << 62; },
          "deadline in the far future");
  refused([](wire::plan_t& w) { w.late = 7; }, "boolean 7");
  refused([](wire::plan_t& w) { w.num_segments = 2; }, "segments beyond the count");
  refused(
      [](wire::plan_t& w) {
        w.segments.resize(10'001);
        w.num_segments = 10'001;
      },
      "too many segments");
}

TEST(FromWireVehicle, RefusesInvalidValues) {
  const auto good =
      rich_wire<models::VehicleStatus>([](const auto& m) { return !m.reasons.empty(); });
  const auto refused = [&](void (*spoil)(wire::vehicle_t&), const char* what) {
    expect_refused(good, spoil, what);
  };
  refused([](wire::vehicle_t& w) { w.state = 5; }, "unknown state");
  refused([](wire::vehicle_t& w) { w.battery_share = 1.01; }, "fuller than full");
  refused([](wire::vehicle_t& w) { w.battery_share = kNan; }, "NaN battery");
  refused([](wire::vehicle_t& w) { w.setpoint_y_world_m = kNan; }, "NaN set point");
  refused([](wire::vehicle_t& w) { w.setpoint_height_m = kInfinity; }, "infinite height");
  refused([](wire::vehicle_t& w) { w.plan_round = -2; }, "round -2");
  refused([](wire::vehicle_t& w) { w.reasons[0].assign(257, 'r'); }, "long reason");
  refused([](wire::vehicle_t& w) { w.num_reasons = 0; }, "reasons beyond the count");
}

TEST(FromWireCommand, RefusesInvalidValues) {
  const auto good = rich_wire<models::OperatorCommand>([](const auto&) { return true; });
  expect_refused<wire::command_t>(
      good, [](wire::command_t& w) { w.action = 7; }, "unknown action");
  expect_refused<wire::command_t>(
      good, [](wire::command_t& w) { w.action = -1; }, "negative action");
  expect_refused<wire::command_t>(
      good, [](wire::command_t& w) { w.robot.assign(257, 'Q'); }, "long name");
}

TEST(FromWireTruth, RefusesInvalidValues) {
  const auto good = rich_wire<models::TruthFrame>([](const auto& m) { return !m.bodies.empty(); });
  expect_refused<wire::truth_t>(
      good, [](wire::truth_t& w) { w.bodies[0].target_id = -2; }, "id -2");
  expect_refused<wire::truth_t>(
      good, [](wire::truth_t& w) { w.bodies[0].velocity_world_mps[1] = kNan; }, "NaN velocity");
  expect_refused<wire::truth_t>(
      good, [](wire::truth_t& w) { w.bodies[0].quaternion_wxyz[0] += 0.5; }, "not unit");
  expect_refused<wire::truth_t>(
      good, [](wire::truth_t& w) { w.bodies.clear(); }, "no bodies for the count");
  expect_refused<wire::truth_t>(
      good, [](wire::truth_t& w) { w.bodies[0].name = "\xFF"; }, "not UTF-8");
}

TEST(FromWireCollision, RefusesInvalidValues) {
  const auto good = rich_wire<models::CollisionReport>([](const auto&) { return true; });
  expect_refused<wire::collision_t>(
      good, [](wire::collision_t& w) { w.kind = 2; }, "unknown kind");
  expect_refused<wire::collision_t>(
      good, [](wire::collision_t& w) { w.distance_m = kNan; }, "NaN distance");
  expect_refused<wire::collision_t>(
      good, [](wire::collision_t& w) { w.body_b.assign(257, 'b'); }, "long name");
}

TEST(FromWireAttack, RefusesInvalidValues) {
  const auto good =
      rich_wire<models::AttackNotice>([](const auto& m) { return !m.jammed.empty(); });
  expect_refused<wire::attack_t>(
      good, [](wire::attack_t& w) { w.num_jammed += 1; }, "count above the names");
  expect_refused<wire::attack_t>(
      good, [](wire::attack_t& w) { w.jammed[0].assign(257, 'Q'); }, "long name");
}

TEST(FromWireHealth, RefusesInvalidValues) {
  const auto good =
      rich_wire<models::ProcessHealth>([](const auto& m) { return !m.counters.empty(); });
  expect_refused<wire::health_t>(
      good, [](wire::health_t& w) { w.state = 4; }, "unknown state");
  expect_refused<wire::health_t>(
      good, [](wire::health_t& w) { w.loops = -1; }, "negative loops");
  expect_refused<wire::health_t>(
      good, [](wire::health_t& w) { w.loop_worst_s = kNan; }, "NaN time");
  expect_refused<wire::health_t>(
      good, [](wire::health_t& w) { w.loop_worst_s = -1.0; }, "negative time");
  expect_refused<wire::health_t>(
      good, [](wire::health_t& w) { w.deadlines_missed = -1; }, "negative misses");
  expect_refused<wire::health_t>(
      good, [](wire::health_t& w) { w.counters[0].name.assign(257, 'c'); }, "long name");
  expect_refused<wire::health_t>(
      good, [](wire::health_t& w) { w.num_counters = 0; }, "counters beyond the count");
}

TEST(FromWireHost, RefusesInvalidValues) {
  const auto good =
      rich_wire<models::HostReport>([](const auto& m) { return !m.processes.empty(); });
  expect_refused<wire::host_t>(
      good, [](wire::host_t& w) { w.processes[0].phase = 4; }, "unknown phase");
  expect_refused<wire::host_t>(
      good, [](wire::host_t& w) { w.processes[0].restarts = -1; }, "negative restarts");
  expect_refused<wire::host_t>(
      good, [](wire::host_t& w) { w.processes[0].down_s = -1.0; }, "negative time");
  expect_refused<wire::host_t>(
      good, [](wire::host_t& w) { w.processes[0].cpu_share = kNan; }, "NaN share");
  expect_refused<wire::host_t>(
      good, [](wire::host_t& w) { w.processes[0].memory_bytes = -1; }, "negative memory");
  expect_refused<wire::host_t>(
      good, [](wire::host_t& w) { w.processes[0].last_end.assign(257, 'e'); }, "long end");
  expect_refused<wire::host_t>(
      good, [](wire::host_t& w) { w.host = "\xFF"; }, "not UTF-8");
  expect_refused<wire::host_t>(
      good, [](wire::host_t& w) { w.num_processes = 0; }, "processes beyond the count");
}

TEST(FromWireScenario, LimitsTheFileSize) {
  const auto good = rich_wire<models::ScenarioNotice>([](const auto&) { return true; });
  expect_accepted<wire::scenario_t>(
      good, [](wire::scenario_t& w) { w.yaml.assign(std::size_t{1} << 20U, 'y'); }, "1 MiB");
  expect_refused<wire::scenario_t>(
      good, [](wire::scenario_t& w) { w.yaml.assign((std::size_t{1} << 20U) + 1, 'y'); }, "more");
  expect_refused<wire::scenario_t>(
      good, [](wire::scenario_t& w) { w.version.assign(257, 'v'); }, "long version");
  expect_refused<wire::scenario_t>(
      good, [](wire::scenario_t& w) { w.process.assign(257, 'p'); }, "long process name");
}

TEST(ToWireMeasurement, ReceiverRefusesAWrongCovarianceShape) {
  models::RobotMeasurement set;
  set.detections.resize(1);
  set.detections[0].measurement.z = Eigen::Vector2d(1.0, 2.0);
  set.detections[0].measurement.V = Eigen::Matrix<double, 1, 1>(1.0);
  const auto wire = decode_wire<vantage_lcm::measurement_t>(test::encoded(set));
  ASSERT_TRUE(wire.has_value());
  EXPECT_FALSE(from_wire(*wire).has_value());
}

}  // namespace
}  // namespace vantage::bus
