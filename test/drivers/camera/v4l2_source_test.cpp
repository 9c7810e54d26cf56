#include "drivers/camera/v4l2_source.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <deque>
#include <vector>

#include <gtest/gtest.h>
#include <linux/videodev2.h>

namespace vantage::drivers::camera {
namespace {

constexpr Time kNow = from_utime(1'700'000'000'000'000);
constexpr Duration kMonotonic{5'000'000};
constexpr int kWidth = 64;
constexpr int kHeight = 48;

/// Image that the device has captured.
struct Shot {
  Duration stamp{};
  std::uint32_t flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
  std::uint32_t bytes = 0;
  std::uint32_t sequence = 0;
};

/// Stand-in for a V4L2 device. Answers the driver's calls as the kernel's documentation defines.
class Device {
 public:
  DeviceCalls calls() {
    return {
        .open =
            [this](const char*) {
              errno = ENOENT;
              return is_plugged ? ++opened : -1;
            },
        .control = [this](int, unsigned long request, void* at) { return control(request, at); },
        .map = [this](int, std::size_t bytes, std::int64_t offset) -> void* {
          auto& memory = memories.at(static_cast<std::size_t>(offset));
          memory.resize(bytes);
          ++mapped;
          return memory.data();
        },
        .unmap = [this](void*, std::size_t) { --mapped; },
        .close = [this](int) { ++closed; },
        .monotonic = [] { return kMonotonic; }};
  }

  bool is_plugged = true;
  std::uint32_t offered = V4L2_PIX_FMT_GREY;
  std::uint32_t width = kWidth;
  int exposure_100us = 0;  ///< 0: the device does not report its exposure
  std::deque<Shot> shots;
  int opened = 0;
  int closed = 0;
  int mapped = 0;
  int queued = 0;
  std::array<std::vector<std::uint8_t>, 4> memories;

 private:
  int fail(int why) {
    errno = why;
    return -1;
  }
  int control(unsigned long request, void* at) {
    if (!is_plugged) {
      return fail(ENODEV);
    }
    const std::uint32_t step = offered == V4L2_PIX_FMT_YUYV ? 2 : 1;
    switch (request) {
      case VIDIOC_QUERYCAP:
        static_cast<v4l2_capability*>(at)->capabilities =
            V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING;
        return 0;
      case VIDIOC_S_FMT: {
        auto& pix = static_cast<v4l2_format*>(at)->fmt.pix;
        pix.pixelformat = offered;
        pix.width = width;
        pix.bytesperline = width * step;
        return 0;
      }
      case VIDIOC_REQBUFS:
      case VIDIOC_STREAMON:
        return 0;
      case VIDIOC_QUERYBUF: {
        auto& buffer = *static_cast<v4l2_buffer*>(at);
        buffer.length = width * step * kHeight;
        buffer.m.offset = buffer.index;
        return 0;
      }
      case VIDIOC_QBUF:
        ++queued;
        return 0;
      case VIDIOC_G_CTRL:
        static_cast<v4l2_control*>(at)->value = exposure_100us;
        return exposure_100us > 0 ? 0 : fail(EINVAL);
      case VIDIOC_DQBUF: {
        if (shots.empty()) {
          return fail(EAGAIN);
        }
        auto& buffer = *static_cast<v4l2_buffer*>(at);
        buffer.index = shots.front().sequence % 4;
        buffer.sequence = shots.front().sequence;
        buffer.bytesused = shots.front().bytes;
        buffer.flags = shots.front().flags;
        buffer.timestamp.tv_sec = shots.front().stamp.count() / 1'000'000;
        buffer.timestamp.tv_usec = shots.front().stamp.count() % 1'000'000;
        shots.pop_front();
        return 0;
      }
      default:
        return fail(ENOTTY);
    }
  }
};

class V4l2SourceTest : public testing::Test {
 protected:
  V4l2SourceTest() {
    camera_.width = kWidth;
    camera_.height = kHeight;
    spec_.exposure_s = 0.01;
    spec_.readout_s = 0.004;
  }
  V4l2Source source() { return {"/dev/video0", camera_, spec_, device_.calls()}; }
  void shoot(Duration stamp, std::uint32_t sequence, std::uint32_t source_flag) {
    const std::uint32_t step = device_.offered == V4L2_PIX_FMT_YUYV ? 2 : 1;
    device_.shots.push_back({stamp, V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC | source_flag,
                             kWidth * kHeight * step, sequence});
  }

  models::CameraModel camera_;
  scenario::CameraSpec spec_;
  Device device_;
};

// All stamps are 30 ms old. A stamp at the start of a 10 ms exposure is 5 ms before the middle of
// the exposure. A stamp at the end of a 4 ms readout is 9 ms after this middle.
TEST_F(V4l2SourceTest, StampsTheMiddleOfTheExposure) {
  V4l2Source source = this->source();
  EXPECT_FALSE(source.next(kNow));
  shoot(kMonotonic - Duration{30'000}, 0, V4L2_BUF_FLAG_TSTAMP_SRC_SOE);
  EXPECT_EQ(source.next(kNow)->time, kNow - Duration{25'000});
  shoot(kMonotonic - Duration{30'000}, 1, V4L2_BUF_FLAG_TSTAMP_SRC_EOF);
  EXPECT_EQ(source.next(kNow)->time, kNow - Duration{39'000});
  device_.exposure_100us = 200;
  shoot(kMonotonic - Duration{30'000}, 2, V4L2_BUF_FLAG_TSTAMP_SRC_SOE);
  EXPECT_EQ(source.next(kNow)->time, kNow - Duration{20'000});
}

TEST_F(V4l2SourceTest, ReadsGreyLevelsFromGreyAndYuyvImages) {
  for (const std::uint32_t format : {V4L2_PIX_FMT_GREY, V4L2_PIX_FMT_YUYV}) {
    device_.offered = format;
    V4l2Source source = this->source();
    EXPECT_FALSE(source.next(kNow));
    const std::size_t step = format == V4L2_PIX_FMT_YUYV ? 2 : 1;
    device_.memories[0][step * (kWidth + 1)] = 77;
    shoot(kMonotonic, 0, V4L2_BUF_FLAG_TSTAMP_SRC_SOE);
    const auto image = source.next(kNow);
    ASSERT_TRUE(image);
    EXPECT_EQ(image->image.width, kWidth);
    EXPECT_EQ(image->image.height, kHeight);
    EXPECT_EQ(image->image.at(1, 1), 77);
    device_.memories[0][step * (kWidth + 1)] = 0;
  }
}

TEST_F(V4l2SourceTest, OpensTheDeviceAgainWhenItStallsWithoutAnError) {
  V4l2Source source = this->source();
  shoot(kMonotonic, 1, V4L2_BUF_FLAG_TSTAMP_SRC_SOE);
  EXPECT_TRUE(source.next(kNow));
  EXPECT_FALSE(source.next(kNow + std::chrono::seconds(3)));
  EXPECT_EQ(source.counts().interruptions, 0);
  const Time stalled = kNow + std::chrono::milliseconds(3'001);
  EXPECT_FALSE(source.next(stalled));
  EXPECT_EQ(source.counts().interruptions, 1);
  EXPECT_NE(source.status().find("stopped delivering images"), std::string::npos);
  shoot(kMonotonic, 1, V4L2_BUF_FLAG_TSTAMP_SRC_SOE);
  EXPECT_TRUE(source.next(stalled + kReopenPeriod));
  EXPECT_EQ(device_.opened, 2);
}

TEST_F(V4l2SourceTest, OpensTheDeviceAgainAfterItWasUnplugged) {
  V4l2Source source = this->source();
  EXPECT_FALSE(source.next(kNow));
  EXPECT_EQ(device_.mapped, 4);
  device_.is_plugged = false;
  EXPECT_FALSE(source.next(kNow));
  EXPECT_EQ(source.counts().interruptions, 1);
  EXPECT_EQ(device_.mapped, 0);
  EXPECT_EQ(device_.closed, 1);
  EXPECT_FALSE(source.next(kNow + kReopenPeriod));
  EXPECT_NE(source.status().find("cannot be opened"), std::string::npos) << source.status();
  device_.is_plugged = true;
  EXPECT_FALSE(source.next(kNow + 2 * kReopenPeriod));
  shoot(kMonotonic, 0, V4L2_BUF_FLAG_TSTAMP_SRC_SOE);
  EXPECT_TRUE(source.next(kNow + 2 * kReopenPeriod));
}

TEST_F(V4l2SourceTest, CountsDamagedUnstampedAndMissingImages) {
  V4l2Source source = this->source();
  EXPECT_FALSE(source.next(kNow));
  shoot(kMonotonic, 0, V4L2_BUF_FLAG_TSTAMP_SRC_SOE);
  device_.shots.back().bytes -= 1;
  shoot(kMonotonic, 1, V4L2_BUF_FLAG_TSTAMP_SRC_SOE);
  device_.shots.back().flags |= V4L2_BUF_FLAG_ERROR;
  shoot(kMonotonic, 2, V4L2_BUF_FLAG_TSTAMP_SRC_SOE);
  device_.shots.back().flags = V4L2_BUF_FLAG_TIMESTAMP_UNKNOWN;
  shoot(kMonotonic, 7, V4L2_BUF_FLAG_TSTAMP_SRC_SOE);
  const int queued_before = device_.queued;
  EXPECT_TRUE(source.next(kNow));
  EXPECT_EQ(source.counts().undecodable, 2);
  EXPECT_EQ(source.counts().unstamped, 1);
  EXPECT_EQ(source.counts().lost, 4);
  EXPECT_EQ(device_.queued - queued_before, 4);  // every buffer returns to the device
}

TEST_F(V4l2SourceTest, RefusesImagesWhoseSizeDiffersFromTheCalibration) {
  device_.width = 32;
  V4l2Source source = this->source();
  EXPECT_FALSE(source.next(kNow));
  EXPECT_NE(source.status().find("32 x 48 pixels, but the calibration is for 64 x 48"),
            std::string::npos)
      << source.status();
}

TEST_F(V4l2SourceTest, RefusesCompressedImages) {
  device_.offered = V4L2_PIX_FMT_MJPEG;
  V4l2Source source = this->source();
  EXPECT_FALSE(source.next(kNow));
  EXPECT_NE(source.status().find("none of the formats"), std::string::npos) << source.status();
}

}  // namespace
}  // namespace vantage::drivers::camera
