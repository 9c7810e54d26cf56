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

/// Vehicle controlled by real firmware: a Multirotor and its sensors in a separate thread. The
/// simulation is synchronised with the firmware at the other end of a link and with the machine's
/// monotonic clock.
///
/// If the firmware is late, the simulation waits for at most kPatience and then catches up. After a
/// longer gap the motors are assumed off, and the body falls. If the thread itself was suspended
/// for more than twice kPatience, the missed time is skipped.
class FirmwareFlight {
 public:
  static constexpr Duration kPatience{250'000};

  /// State of the body at one instant of the monotonic clock.
  struct Sample {
    std::int64_t monotonic_ns = 0;
    Pose3 world_from_body;
    Eigen::Vector3d velocity_world_mps = Eigen::Vector3d::Zero();
  };
  struct Counts {
    std::int64_t steps = 0;
    std::int64_t silences = 0;  ///< gaps longer than kPatience without a message of the firmware
    std::int64_t resumed = 0;   ///< suspensions of the thread; the missed time was skipped
    std::int64_t dropped = 0;   ///< packets that the link could not relay
  };

  FirmwareFlight(const MultirotorParameters& parameters, const SensorNoise& noise,
                 std::uint64_t seed, const Pose2& start, std::unique_ptr<FirmwareLink> link);
  ~FirmwareFlight();
  FirmwareFlight(const FirmwareFlight&) = delete;
  FirmwareFlight& operator=(const FirmwareFlight&) = delete;
  FirmwareFlight(FirmwareFlight&&) = delete;
  FirmwareFlight& operator=(FirmwareFlight&&) = delete;

  /// Returns the state at `monotonic_ns`, interpolated between the two samples around it, or
  /// extrapolated by at most 20 ms beyond the newest.
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
  mutable std::mutex mutex_;  ///< protects the members below
  std::array<Sample, kSamples> samples_;
  std::size_t newest_ = 0;
  Counts counts_;
  double battery_share_ = 1.0;
  std::atomic<bool> is_over_{false};
  std::thread thread_;  ///< last member, since the thread uses all others
};

}  // namespace vantage::sim
