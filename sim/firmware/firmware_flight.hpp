#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <thread>

#include <Eigen/Core>

#include "core/pose.hpp"
#include "core/time.hpp"
#include "sim/firmware/firmware_link.hpp"
#include "sim/firmware/firmware_sensors.hpp"
#include "sim/firmware/multirotor.hpp"

namespace vantage::sim {

/// One vehicle that real firmware flies: a Multirotor and its sensors, in step with the firmware at
/// the other end of a link, at the pace of the machine's monotonic clock, on a thread of its own.
///
/// While the firmware is late the body waits with it for at most kPatience, and then catches up; a
/// firmware that is silent for longer has lost its motors, and the body falls. Time that the thread
/// itself was not given is not caught up beyond kPatience.
class FirmwareFlight {
 public:
  static constexpr Duration kPatience{250'000};

  /// A body at one instant of the monotonic clock.
  struct Sample {
    std::int64_t monotonic_ns = 0;
    Pose3 world_from_body;
    Eigen::Vector3d velocity_world_mps = Eigen::Vector3d::Zero();
  };
  struct Counts {
    std::int64_t steps = 0;
    std::int64_t silences = 0;  ///< of the firmware, longer than kPatience
    std::int64_t resumed = 0;   ///< the thread was away for longer than kPatience
  };

  FirmwareFlight(const MultirotorParameters& parameters, const SensorNoise& noise,
                 std::uint64_t seed, const Pose2& start, std::unique_ptr<FirmwareLink> link);
  ~FirmwareFlight();
  FirmwareFlight(const FirmwareFlight&) = delete;
  FirmwareFlight& operator=(const FirmwareFlight&) = delete;
  FirmwareFlight(FirmwareFlight&&) = delete;
  FirmwareFlight& operator=(FirmwareFlight&&) = delete;

  /// Where it was at `monotonic_ns`: between the two samples around it; carried on by at most
  /// 20 ms beyond the newest.
  [[nodiscard]] Sample at(std::int64_t monotonic_ns) const;
  [[nodiscard]] Counts counts() const;
  [[nodiscard]] double battery_share() const;

 private:
  static constexpr std::size_t kSamples = 64;
  void run();
  void record(std::int64_t monotonic_ns);

  Multirotor body_;
  SensorBoard board_;
  std::unique_ptr<FirmwareLink> link_;
  mutable std::mutex mutex_;  ///< of what follows
  std::array<Sample, kSamples> samples_;
  std::size_t newest_ = 0;
  Counts counts_;
  double battery_share_ = 1.0;
  std::atomic<bool> is_over_{false};
  std::thread thread_;  ///< last: it uses everything else
};

}  // namespace vantage::sim
