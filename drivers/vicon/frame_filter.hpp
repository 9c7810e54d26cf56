#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/assignment.hpp"
#include "drivers/vicon/frame_clock.hpp"
#include "drivers/vicon/pose_gate.hpp"
#include "drivers/vicon/seen_frame.hpp"
#include "models/exchange/messages.hpp"

namespace vantage::drivers::vicon {

/// Counters of the filter since its construction.
struct FrameCounts {
  std::int64_t frames = 0;           ///< published frames
  std::int64_t frames_lost = 0;      ///< number of missing frame numbers
  std::int64_t frames_repeated = 0;  ///< frames dropped: number repeated
  std::int64_t frames_late = 0;      ///< dropped: arrived after a newer frame
  std::int64_t frames_queued = 0;  ///< dropped: waited longer than kQueuedMax while a queue emptied
  std::int64_t frames_waited = 0;  ///< published, but waited longer than kQueuedMax
  std::int64_t server_restarts = 0;  ///< restarts of the frame numbers
  /// latencies not finite, negative or above kLatencyPossible_s
  std::int64_t latencies_refused = 0;
  std::int64_t poses_zero = 0;
  std::int64_t poses_refused = 0;  ///< not finite, not a rotation, or an impossibly large position
  std::int64_t poses_stuck = 0;
  std::int64_t poses_outlying = 0;
  std::int64_t poses_flipped = 0;
  /// outliers at the position of another body; they are not counted in poses_outlying
  std::int64_t poses_swapped = 0;
  std::int64_t poses_unconfirmed = 0;
  /// names that are empty, not UTF-8, or beyond the maximum number
  std::int64_t names_refused = 0;
  std::int64_t names_twice = 0;  ///< dropped: a second body of the same name in one frame
};

/// Filter that checks frames and converts them into messages. A message contains every body seen
/// since the start, or all listed bodies if the protocol sends a list, in a stable order. A body
/// without an accepted pose is marked occluded.
///
/// The capture time is the arrival time minus the latency and minus the time that the frame waited
/// in a queue (FrameClock). The latency is that stated by the server, or `latency_assumed` if the
/// stated one is not in [0, kLatencyPossible_s]. Capture times increase from frame to frame, unless
/// they would exceed the arrival time or the clock was set. While a queue empties, frames that
/// waited longer than kQueuedMax are dropped, since newer frames follow immediately. Frames of a
/// queue that does not empty are published with their latency. A frame allocates no memory once all
/// bodies are known.
class FrameFilter {
 public:
  /// Largest accepted latency, s; an overloaded server may delay frames for seconds and states this
  /// latency.
  static constexpr double kLatencyPossible_s = 10.0;
  static constexpr Duration kQueuedMax{100'000};
  static constexpr Duration kWaitedMax{10'000'000};  ///< a frame that waited longer is dropped
  static constexpr Duration kBehindFor{500'000};     ///< minimum duration for is_behind()
  static constexpr std::size_t kBodiesMax = 512;

  using Publish = std::function<void(const models::MocapFrame&)>;
  FrameFilter(const GateSettings& gate, Duration latency_assumed, Publish publish);

  void accept(const SeenFrame& seen);
  /// Reports a new connection: the frame numbers restart, bodies are kept.
  void on_opened();

  /// True if all frames have waited longer than kQueuedMax for at least kBehindFor. Only a new
  /// connection empties such a queue.
  [[nodiscard]] bool is_behind() const { return is_behind_; }
  /// Returns the time that the newest frame waited in a queue.
  [[nodiscard]] Duration waited() const { return waited_; }

  [[nodiscard]] const FrameCounts& counts() const { return counts_; }

 private:
  struct Body {
    std::string name;
    PoseGate gate;
    Duration last_listed{};
    bool is_in_frame = false;
    const SeenBody* seen = nullptr;  ///< pose in the current frame; nullptr if it has none
    /// true: the body's pose is closer to another body's prediction than to its own
    bool is_swapped = false;
  };

  [[nodiscard]] bool is_next(std::uint32_t number);
  /// Returns the accepted latency of a frame.
  [[nodiscard]] Duration latency_of(const SeenFrame& seen);
  [[nodiscard]] Duration wait_of(const SeenFrame& seen, Duration latency);
  void watch_backlog(Duration now);
  [[nodiscard]] Time capture_time(Time arrival, Duration since_capture);
  Body* find(const std::string& name, std::size_t hint);
  Body* add(const std::string& name);
  /// Assigns the positions of the frame to the predictions of the bodies, jointly for all bodies.
  /// Marks each body with a position that is assigned to another name.
  void find_swaps(Duration now);
  /// Adds a body to `compared_`.
  void compare(std::size_t body);
  void forget(const SeenFrame& seen);
  void place(const SeenBody& seen, Body& body, Duration now, models::MocapBody& out);
  [[nodiscard]] bool is_good(const SeenBody& seen, Body& body, Duration now);

  GateSettings gate_;
  Duration latency_assumed_;
  Publish publish_;
  std::vector<Body> bodies_;  ///< state of the body in out_.bodies[i]
  models::MocapFrame out_;
  std::optional<std::uint32_t> last_number_;
  int old_numbers_ = 0;      ///< number of consecutive frames with older numbers
  std::int64_t number_ = 0;  ///< last frame number, with wraps of the counter removed
  AssignmentSolver assignment_;
  std::vector<std::size_t> compared_;  ///< bodies with positions to assign; seen bodies first
  std::vector<Eigen::Vector3d> predicted_m_;
  std::vector<double> cost_m_;
  FrameClock clock_;
  Duration waited_{};
  /// start of the period in which each frame waits longer than kQueuedMax
  std::optional<Duration> waits_since_;
  bool is_behind_ = false;
  Duration echo_taken_{};  ///< arrival of the newest echo passed to `clock_`
  Time last_capture_{};
  FrameCounts counts_;
};

}  // namespace vantage::drivers::vicon
