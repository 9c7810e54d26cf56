#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/check.hpp"
#include "core/write_file.hpp"
#include "sim/vicon/recorded_flight.hpp"
#include "test/drivers/vicon/vicon_bench.hpp"
#include "test/support/near.hpp"
#include "test/support/temporary_folder.hpp"

namespace vantage::drivers::vicon {
namespace {

using scenario::MocapProtocol;
using scenario::MocapSpec;
using test::circling;
using test::is_near;
using test::kPeriod;
using test::spec_of;
using test::ViconBench;

TEST(ReadFlight, RequiresEvenlySpacedTimesAndUnitQuaternions) {
  const vantage::test::TemporaryFolder folder;
  const auto is_taken = [&](const std::string& third_row) {
    const std::string path = folder.file("flight.csv");
    write_file(path,
               "t,x,y,z,qw,qx,qy,qz\n1,0,0,1,1,0,0,0\n1.01,0,0,1,1,0,0,0\n" + third_row + "\n");
    try {
      return sim::vicon::read_flight(path).world_from_body.size() == 3;
    } catch (const StartupError&) {
      return false;
    }
  };
  EXPECT_TRUE(is_taken("1.02,0,0,1,0.6,0,0,-0.8"));
  EXPECT_FALSE(is_taken("1.025,0,0,1,1,0,0,0"));
  EXPECT_FALSE(is_taken("1.015,0,0,1,1,0,0,0"));
  EXPECT_FALSE(is_taken("1.02,0,0,1,1.01,0,0,0"));
  EXPECT_FALSE(is_taken("1.02,0,0,1,0.99,0,0,0"));
  EXPECT_FALSE(is_taken("1.02,0,0,1,1,0,0"));
}

/// A protocol and, for DataStream, a request mode.
struct StreamCase {
  std::string name;
  MocapProtocol protocol;
  scenario::StreamMode mode = scenario::StreamMode::kPush;
  std::size_t chunk_bytes = 0;
  bool is_y_up = false;
  std::size_t block_bytes = 256;
};

class ViconMode : public ::testing::TestWithParam<StreamCase> {
 protected:
  ViconMode() : spec(spec_of(GetParam().protocol)) {
    spec.mode = GetParam().mode;
    if (GetParam().is_y_up && GetParam().protocol != MocapProtocol::kDataStream) {
      spec.up_axis = scenario::UpAxis::kY;
    }
    settings = ViconBench::settings_for(spec);
    settings.is_y_up = GetParam().is_y_up;
    settings.block_bytes = GetParam().block_bytes;
  }
  MocapSpec spec;
  sim::vicon::ServerSettings settings;
};

void expect_same_poses(const sim::vicon::EmulatedFrame& sent, const models::MocapFrame& got) {
  ASSERT_EQ(got.bodies.size(), sent.bodies.size());
  for (const sim::vicon::EmulatedBody& body : sent.bodies) {
    const models::MocapBody* found = got.find(body.name);
    ASSERT_NE(found, nullptr) << body.name;
    EXPECT_EQ(found->occluded, body.is_occluded) << body.name;
    if (!body.is_occluded) {
      EXPECT_TRUE(
          is_near(found->world_from_body.translation_m, body.world_from_body.translation_m, 1e-9));
      EXPECT_TRUE(is_near(found->world_from_body.rotation.toRotationMatrix(),
                          body.world_from_body.rotation.toRotationMatrix(), 1e-9));
    }
  }
}

TEST_P(ViconMode, DeliversEveryPoseOfSevenBodies) {
  ViconBench bench(spec, settings, GetParam().chunk_bytes);
  bench.pass(Duration{2'000});
  std::vector<sim::vicon::EmulatedFrame> sent;
  for (std::uint32_t k = 0; k < 300; ++k) {
    sent.push_back(circling(7, 0.01 * k));
    sent.back().number = 1000 + k;
    sent.back().bodies[k % 7].is_occluded = k % 50 > 40;
    bench.publish(sent.back());
    bench.pass(kPeriod);
  }
  ASSERT_EQ(bench.frames.size(), sent.size()) << bench.driver.status();
  for (std::size_t k = 0; k < sent.size(); ++k) {
    expect_same_poses(sent[k], bench.frames[k]);
    if (GetParam().protocol != MocapProtocol::kVrpn) {
      EXPECT_EQ(bench.frames[k].frame_number, sent[k].number);
    }
  }
  EXPECT_EQ(bench.driver.frame_counts().frames_lost, 0);
  EXPECT_EQ(bench.driver.link_counts().connections, 1);
}

const StreamCase kStreamCases[] = {
    {"DataStreamPush", MocapProtocol::kDataStream},
    {"DataStreamPull", MocapProtocol::kDataStream, scenario::StreamMode::kPull},
    {"DataStreamPreFetch", MocapProtocol::kDataStream, scenario::StreamMode::kPreFetch},
    {"DataStreamByteByByte", MocapProtocol::kDataStream, scenario::StreamMode::kPush, 1},
    {"DataStreamInSevens", MocapProtocol::kDataStream, scenario::StreamMode::kPull, 7},
    {"DataStreamYUp", MocapProtocol::kDataStream, scenario::StreamMode::kPush, 0, true},
    {"ObjectStream256", MocapProtocol::kObjectStream},
    {"ObjectStream512", MocapProtocol::kObjectStream, {}, 0, false, 512},
    {"ObjectStream1024YUp", MocapProtocol::kObjectStream, {}, 0, true, 1024},
    {"Vrpn", MocapProtocol::kVrpn},
    {"VrpnByteByByte", MocapProtocol::kVrpn, {}, 1},
    {"VrpnYUp", MocapProtocol::kVrpn, {}, 0, true}};
INSTANTIATE_TEST_SUITE_P(Protocols, ViconMode, testing::ValuesIn(kStreamCases),
                         [](const auto& way) { return way.param.name; });

class ViconFlight : public ::testing::TestWithParam<MocapProtocol> {};

TEST_P(ViconFlight, ArrivesUnchangedWithoutLoss) {
  std::vector<sim::vicon::RecordedFlight> flights;
  for (const char* name : {"v1_01", "v1_02", "v1_03"}) {
    const std::string path = std::string(VANTAGE_DATA_DIR) + "/vicon_flights/" + name + ".csv";
    if (std::FILE* file = std::fopen(path.c_str(), "r")) {
      std::fclose(file);
      flights.push_back(sim::vicon::read_flight(path));
    }
  }
  if (flights.size() != 3) {
    GTEST_SKIP() << "recorded flights are not on this machine";
  }
  const MocapSpec spec = spec_of(GetParam());
  ViconBench bench(spec, ViconBench::settings_for(spec));
  bench.pass(Duration{2'000});
  std::size_t length = flights[0].world_from_body.size();
  for (const auto& flight : flights) {
    length = std::min(length, flight.world_from_body.size());
  }
  double worst_m = 0.0;
  double worst_rad = 0.0;
  for (std::size_t k = 0; k < length; ++k) {
    sim::vicon::EmulatedFrame frame;
    frame.number = static_cast<std::uint32_t>(k);
    frame.captured = bench.now().utime;
    frame.latency_s = 0.004;
    for (const auto& flight : flights) {
      frame.bodies.push_back({flight.name, flight.world_from_body[k], false});
    }
    bench.publish(frame);
    bench.pass(kPeriod);
    ASSERT_EQ(bench.frames.size(), 1u) << "at frame " << k;
    for (const sim::vicon::EmulatedBody& body : frame.bodies) {
      const models::MocapBody* found = bench.frames[0].find(body.name);
      ASSERT_TRUE(found != nullptr && !found->occluded) << body.name << " at frame " << k;
      worst_m = std::max(
          worst_m,
          (found->world_from_body.translation_m - body.world_from_body.translation_m).norm());
      worst_rad = std::max(worst_rad, (found->world_from_body.rotation.toRotationMatrix() -
                                       body.world_from_body.rotation.toRotationMatrix())
                                          .cwiseAbs()
                                          .maxCoeff());
    }
    bench.frames.clear();
  }
  EXPECT_GT(length, 8000u);
  EXPECT_LT(worst_m, 1e-9);
  EXPECT_LT(worst_rad, 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Protocols, ViconFlight,
                         testing::Values(MocapProtocol::kDataStream, MocapProtocol::kObjectStream,
                                         MocapProtocol::kVrpn),
                         [](const auto& protocol) { return std::string(protocol.param.name()); });

}  // namespace
}  // namespace vantage::drivers::vicon
