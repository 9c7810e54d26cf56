#include <filesystem>
#include <memory>
#include <string>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "bus/convert/channels.hpp"
#include "core/check.hpp"
#include "drivers/camera/folder_source.hpp"
#include "sim/camera/app/node.hpp"
#include "test/support/bus_pair.hpp"
#include "test/support/rendered_tags.hpp"
#include "test/support/temporary_folder.hpp"

namespace vantage::sim {
namespace {

constexpr Time kStart = from_utime(1'700'000'000'000'000);

class CameraEmulator : public testing::Test {
 protected:
  void SetUp() override {
    if (const auto pattern = tag_pattern("tag36h11", 0); !pattern.ok()) {
      GTEST_SKIP() << pattern.error().message;
    }
    scenario_.name = "test";
    scenario_.world.bounds = {{-4.0, -2.0}, {4.0, 2.0}};
    scenario_.planner.step_s = 0.5;
    spec_.robot = "Q1";
    spec_.simulated_folder = parent_.file("own/test-Q1");
    spec_.body_from_camera = test::looking_down(0.0, radians(60.0));
    spec_.tags = {{0, test::kRenderedSize_m, scenario::TagCarrier::kTarget, 0, "R1"}};
  }

  std::unique_ptr<CameraEmulatorNode> start() {
    return std::make_unique<CameraEmulatorNode>(
        buses_.own, clock_,
        std::make_unique<TagScene>(scenario_, spec_, test::rendered_camera(),
                                   std::vector<scenario::LandmarkSpec>()));
  }
  void send_truth(Duration after_start) {
    clock_.set(kStart + after_start);
    models::TruthFrame truth;
    truth.stamp.time = clock_.now();
    truth.bodies = {{"Q1", -1, lift({0.0, 0.0, 0.0}, 1.5)}, {"R1", 0, lift({0.9, 0.0, 0.0}, 0.0)}};
    buses_.other.publish(bus::kTruth, truth);
    buses_.own.handle(std::chrono::microseconds(0));
  }

  const test::TemporaryFolder parent_;
  scenario::Scenario scenario_;
  scenario::CameraSpec spec_;
  bus::VirtualClock clock_{kStart};
  test::BusPair buses_{1, 2};
};

// The emulator writes one image per period. The image shows the tag of R1 at the time of the truth.
TEST_F(CameraEmulator, WritesImagesForTheCamera) {
  const auto node = start();
  drivers::camera::FolderSource source(spec_.simulated_folder);
  EXPECT_FALSE(source.next(kStart));
  for (int i = 0; i < 50; ++i) {
    send_truth(i * Duration{20'000});
  }
  auto detector = drivers::camera::make_tag_detector("tag36h11");
  for (const Duration after_start : {Duration{0}, Duration{500'000}}) {
    const auto image = source.next(clock_.now());
    ASSERT_TRUE(image);
    EXPECT_EQ(image->time, kStart + after_start);
    const auto tags = detector.value()->detect(image->image);
    ASSERT_EQ(tags.size(), 1U);
    EXPECT_EQ(tags[0].id, 0);
  }
  EXPECT_FALSE(source.next(clock_.now()));
  EXPECT_TRUE(node->counters().empty());
}

TEST_F(CameraEmulator, RemovesOldImagesAndItsFolder) {
  auto node = start();
  send_truth(Duration{0});
  const auto files = [&] {
    return std::distance(std::filesystem::directory_iterator(spec_.simulated_folder), {});
  };
  EXPECT_EQ(files(), 1);
  clock_.set(kStart + Duration{2'500'000});
  node->tick(clock_.now());
  EXPECT_EQ(files(), 0);
  node.reset();
  EXPECT_FALSE(std::filesystem::exists(spec_.simulated_folder));
}

TEST_F(CameraEmulator, CountsImagesThatItCannotWrite) {
  const auto node = start();
  std::filesystem::remove_all(spec_.simulated_folder);
  send_truth(Duration{0});
  ASSERT_EQ(node->counters().size(), 1U);
  EXPECT_EQ(node->counters()[0].name, "camera_emulator.images_unwritten");
}

// Another user could replace the images in a folder that others can access.
TEST_F(CameraEmulator, RefusesAFolderThatOthersCanAccess) {
  std::filesystem::create_directory(parent_.file("own"));
  ASSERT_EQ(::chmod(parent_.file("own").c_str(), 0755), 0);
  EXPECT_THROW(start(), StartupError);
}

}  // namespace
}  // namespace vantage::sim
