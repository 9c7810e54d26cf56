#include "drivers/camera/v4l2_source.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <time.h>
#include <unistd.h>

namespace vantage::drivers::camera {
namespace {

constexpr std::uint32_t kBuffers = 4;
constexpr std::int64_t kExposureUnit_us = 100;  // unit of V4L2_CID_EXPOSURE_ABSOLUTE
constexpr std::int64_t kExposureMax_us = 1'000'000;
// Cameras may stall without an error. Longer than the longest exposure.
constexpr Duration kStallMax = std::chrono::seconds(3);

struct Format {
  std::uint32_t code;
  std::size_t step;  // bytes from one grey value to the next
};
// In order of preference. The first plane of NV12 and YU12 is grey.
constexpr std::array<Format, 4> kFormats = {{{V4L2_PIX_FMT_GREY, 1},
                                             {V4L2_PIX_FMT_NV12, 1},
                                             {V4L2_PIX_FMT_YUV420, 1},
                                             {V4L2_PIX_FMT_YUYV, 2}}};

std::size_t step_of(std::uint32_t format) {
  const auto found = std::find_if(kFormats.begin(), kFormats.end(),
                                  [&](const Format& each) { return each.code == format; });
  return found == kFormats.end() ? 1 : found->step;
}

int retried_ioctl(int device, unsigned long request, void* argument) {
  int result = -1;
  do {
    result = ::ioctl(device, request, argument);
  } while (result < 0 && errno == EINTR);
  return result;
}

v4l2_buffer empty_buffer() {
  v4l2_buffer out{};
  out.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  out.memory = V4L2_MEMORY_MMAP;
  return out;
}

std::string failure(const char* what) { return fmt::format("{}: {}", what, std::strerror(errno)); }

}  // namespace

DeviceCalls machine_calls() {
  return {
      .open = [](const char* path) { return ::open(path, O_RDWR | O_NONBLOCK | O_CLOEXEC); },
      .control = retried_ioctl,
      .map =
          [](int device, std::size_t bytes, std::int64_t offset) {
            void* const at =
                ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, device, offset);
            return at == MAP_FAILED ? nullptr : at;
          },
      .unmap = [](void* memory, std::size_t bytes) { ::munmap(memory, bytes); },
      .close = [](int device) { ::close(device); },
      .monotonic =
          [] {
            timespec now{};
            ::clock_gettime(CLOCK_MONOTONIC, &now);
            return Duration{static_cast<std::int64_t>(now.tv_sec) * 1'000'000 + now.tv_nsec / 1000};
          }};
}

Duration stamp_delay(bool is_start, Duration exposure, Duration readout) {
  return is_start ? -exposure / 2 : exposure / 2 + readout;
}

V4l2Source::V4l2Source(std::string device, const models::CameraModel& camera,
                       const scenario::CameraSpec& spec, DeviceCalls calls)
    : path_(std::move(device)),
      camera_(camera),
      exposure_(from_seconds(spec.exposure_s)),
      readout_(from_seconds(spec.readout_s)),
      calls_(std::move(calls)),
      status_("camera " + path_ + " is not open yet") {}

V4l2Source::~V4l2Source() { close(); }

void V4l2Source::close() {
  for (const Memory& each : memories_) {
    calls_.unmap(each.address, each.bytes);
  }
  memories_.clear();
  last_sequence_.reset();
  if (device_ >= 0) {
    calls_.close(device_);
    device_ = -1;
  }
}

std::string V4l2Source::set_up() {
  v4l2_capability able{};
  if (calls_.control(device_, VIDIOC_QUERYCAP, &able) < 0) {
    return failure("it is not a V4L2 device");
  }
  const std::uint32_t caps =
      (able.capabilities & V4L2_CAP_DEVICE_CAPS) != 0U ? able.device_caps : able.capabilities;
  if ((caps & V4L2_CAP_VIDEO_CAPTURE) == 0U || (caps & V4L2_CAP_STREAMING) == 0U) {
    return "it does not stream images; use the device of the camera's images";
  }
  v4l2_format format{};
  for (const Format& wanted : kFormats) {
    format = {};
    format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    format.fmt.pix.width = static_cast<std::uint32_t>(camera_.width);
    format.fmt.pix.height = static_cast<std::uint32_t>(camera_.height);
    format.fmt.pix.pixelformat = wanted.code;
    format.fmt.pix.field = V4L2_FIELD_NONE;
    if (calls_.control(device_, VIDIOC_S_FMT, &format) == 0 &&
        format.fmt.pix.pixelformat == wanted.code) {
      format_ = wanted.code;
      break;
    }
    format_ = 0;
  }
  if (format_ == 0) {
    return "it offers none of the formats GREY, NV12, YU12 and YUYV";
  }
  if (format.fmt.pix.width != static_cast<std::uint32_t>(camera_.width) ||
      format.fmt.pix.height != static_cast<std::uint32_t>(camera_.height)) {
    return fmt::format(
        "its images have {} x {} pixels, but the calibration is for {} x {}: calibrate at this "
        "size, or choose another device",
        format.fmt.pix.width, format.fmt.pix.height, camera_.width, camera_.height);
  }
  stride_ = std::max<std::size_t>(format.fmt.pix.bytesperline,
                                  static_cast<std::size_t>(camera_.width) * step_of(format_));
  return start();
}

std::string V4l2Source::start() {
  v4l2_requestbuffers request{};
  request.count = kBuffers;
  request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  request.memory = V4L2_MEMORY_MMAP;
  if (calls_.control(device_, VIDIOC_REQBUFS, &request) < 0 || request.count == 0) {
    return failure("it gives no buffers; another program may use it");
  }
  for (std::uint32_t i = 0; i < request.count; ++i) {
    v4l2_buffer buffer = empty_buffer();
    buffer.index = i;
    if (calls_.control(device_, VIDIOC_QUERYBUF, &buffer) < 0) {
      return failure("its buffers cannot be read");
    }
    void* const at = calls_.map(device_, buffer.length, buffer.m.offset);
    if (at == nullptr) {
      return failure("its buffers cannot be mapped");
    }
    memories_.push_back({at, buffer.length});
    if (calls_.control(device_, VIDIOC_QBUF, &buffer) < 0) {
      return failure("its buffers cannot be queued");
    }
  }
  int type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
  return calls_.control(device_, VIDIOC_STREAMON, &type) < 0 ? failure("it does not start") : "";
}

void V4l2Source::open(Time now) {
  if (now < next_try_) {
    return;
  }
  next_try_ = now + kReopenPeriod;
  device_ = calls_.open(path_.c_str());
  const std::string fault =
      device_ < 0 ? failure("it cannot be opened; check the cable, the name and the permission")
                  : set_up();
  if (!fault.empty()) {
    status_ = "camera " + path_ + ": " + fault;
    close();
    return;
  }
  last_image_ = now;
  status_ = fmt::format("camera {} delivers {} x {} pixels", path_, camera_.width, camera_.height);
}

void V4l2Source::on_failure(const std::string& what) {
  ++counts_.interruptions;
  status_ = "camera " + path_ + ": " + what;
  close();
}

Duration V4l2Source::exposure() {
  v4l2_control control{};
  control.id = V4L2_CID_EXPOSURE_ABSOLUTE;
  if (calls_.control(device_, VIDIOC_G_CTRL, &control) == 0 && control.value > 0) {
    return Duration{std::min(control.value * kExposureUnit_us, kExposureMax_us)};
  }
  return exposure_;
}

std::optional<CapturedImage> V4l2Source::next(Time now) {
  if (device_ < 0) {
    open(now);
  }
  while (device_ >= 0) {
    v4l2_buffer buffer = empty_buffer();
    if (calls_.control(device_, VIDIOC_DQBUF, &buffer) < 0) {
      if (errno != EAGAIN) {
        on_failure(failure("it no longer delivers images"));
      } else if (now - last_image_ > kStallMax) {
        on_failure("it stopped delivering images without an error; it is opened again");
      }
      return std::nullopt;
    }
    last_image_ = now;
    const std::uint32_t sequence = buffer.sequence;
    counts_.lost += last_sequence_ ? static_cast<std::int64_t>(std::min<std::uint32_t>(
                                         sequence - *last_sequence_ - 1, 1000))
                                   : 0;
    last_sequence_ = sequence;
    std::optional<CapturedImage> out;
    const std::size_t needed = stride_ * static_cast<std::size_t>(camera_.height);
    const bool is_complete =
        buffer.index < memories_.size() && memories_[buffer.index].bytes >= needed &&
        buffer.bytesused >= needed && (buffer.flags & V4L2_BUF_FLAG_ERROR) == 0U;
    const bool is_stamped =
        (buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
    if (!is_complete) {
      ++counts_.undecodable;
    } else if (!is_stamped) {
      ++counts_.unstamped;
    } else {
      const auto* const from = static_cast<const std::uint8_t*>(memories_[buffer.index].address);
      out.emplace();
      out->image = {camera_.width, camera_.height, {}};
      out->image.pixels.reserve(static_cast<std::size_t>(camera_.width) *
                                static_cast<std::size_t>(camera_.height));
      const std::size_t step = step_of(format_);
      for (int row = 0; row < camera_.height; ++row) {
        const std::uint8_t* at = from + static_cast<std::size_t>(row) * stride_;
        for (int column = 0; column < camera_.width; ++column, at += step) {
          out->image.pixels.push_back(*at);
        }
      }
      const bool is_start =
          (buffer.flags & V4L2_BUF_FLAG_TSTAMP_SRC_MASK) == V4L2_BUF_FLAG_TSTAMP_SRC_SOE;
      const Duration stamp{static_cast<std::int64_t>(buffer.timestamp.tv_sec) * 1'000'000 +
                           buffer.timestamp.tv_usec};
      out->time = now - (calls_.monotonic() - stamp) - stamp_delay(is_start, exposure(), readout_);
    }
    if (calls_.control(device_, VIDIOC_QBUF, &buffer) < 0) {
      on_failure(failure("its buffers cannot be queued"));
    }
    if (out) {
      return out;
    }
  }
  return std::nullopt;
}

}  // namespace vantage::drivers::camera
