#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "drivers/camera/image_source.hpp"

namespace vantage::drivers::camera {

/// System calls of a V4L2 device; tests replace them. Each returns −1 and sets errno on failure.
struct DeviceCalls {
  std::function<int(const char* path)> open;
  std::function<int(int device, unsigned long request, void* argument)> control;
  std::function<void*(int device, std::size_t bytes, std::int64_t offset)> map;  ///< null: failure
  std::function<void(void* memory, std::size_t bytes)> unmap;
  std::function<void(int device)> close;
  std::function<Duration()> monotonic;  ///< time of the clock that stamps images
};

/// Returns the system calls of the machine.
DeviceCalls machine_calls();

/// Returns the time from the middle of an exposure to the device's stamp, which is made at its
/// start or after the readout.
Duration stamp_delay(bool is_start, Duration exposure, Duration readout);

/// Camera with a V4L2 driver. It delivers grey images (GREY, or the luminance of YUYV, NV12 and
/// YU12) with the size given by the calibration. If the device disappears, it is opened again.
class V4l2Source : public ImageSource {
 public:
  /// @param spec  exposure_s and readout_s, used if the device does not report its exposure
  V4l2Source(std::string device, const models::CameraModel& camera,
             const scenario::CameraSpec& spec, DeviceCalls calls = machine_calls());
  ~V4l2Source() override;
  V4l2Source(const V4l2Source&) = delete;
  V4l2Source& operator=(const V4l2Source&) = delete;
  V4l2Source(V4l2Source&&) = delete;
  V4l2Source& operator=(V4l2Source&&) = delete;

  std::optional<CapturedImage> next(Time now) override;
  [[nodiscard]] SourceCounts counts() const override { return counts_; }
  [[nodiscard]] std::string status() const override { return status_; }

 private:
  struct Memory {
    void* address = nullptr;
    std::size_t bytes = 0;
  };

  void open(Time now);
  /// Returns the reason why the device cannot deliver images; empty if it can.
  std::string set_up();
  /// Maps the buffers and starts the stream. Returns the reason for a failure, as set_up() does.
  std::string start();
  void close();
  void on_failure(const std::string& what);
  [[nodiscard]] Duration exposure();

  std::string path_;
  models::CameraModel camera_;
  Duration exposure_;
  Duration readout_;
  DeviceCalls calls_;
  int device_ = -1;
  std::uint32_t format_ = 0;
  std::size_t stride_ = 0;  ///< bytes per row
  std::vector<Memory> memories_;
  std::optional<std::uint32_t> last_sequence_;
  Time next_try_{};
  Time last_image_{};  ///< time of the newest image; the time of opening if there is none
  SourceCounts counts_;
  std::string status_;
};

}  // namespace vantage::drivers::camera
