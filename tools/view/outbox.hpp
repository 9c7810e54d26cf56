#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>

namespace vantage::tools {

/// One WebSocket message on its way to a client. The body is shared with other clients.
struct Frame {
  enum class Kind : std::uint8_t {
    kControl,  ///< never dropped
    kState,    ///< only the newest of a subscription matters
    kFlow,     ///< the oldest is dropped first
  };
  Kind kind = Kind::kControl;
  bool is_text = false;
  std::uint32_t subscription_id = 0;  ///< of kState
  std::string head;
  std::shared_ptr<const std::string> body;  ///< may be null

  [[nodiscard]] std::size_t size() const { return head.size() + (body ? body->size() : 0); }
};

/// What waits for one client, bounded: a reader that is too slow loses the oldest of the flow and
/// the outdated states, never a control message, and costs a fixed amount of memory. Not
/// thread-safe.
class Outbox {
 public:
  /// @param bytes_max   of the flow; one frame always fits
  /// @param control_max control messages waiting; beyond it the client is beyond help
  explicit Outbox(std::size_t bytes_max = 8U << 20U, std::size_t control_max = 4096)
      : bytes_max_(bytes_max), control_max_(control_max) {}

  void push(Frame frame);
  /// Oldest first; nullopt when nothing waits.
  std::optional<Frame> pop();

  [[nodiscard]] bool empty() const { return frames_.empty(); }
  [[nodiscard]] std::size_t bytes() const { return bytes_; }
  /// Frames of the flow dropped since the start.
  [[nodiscard]] std::int64_t dropped() const { return dropped_; }
  /// True once more control messages wait than may.
  [[nodiscard]] bool is_hopeless() const { return control_waiting_ > control_max_; }

 private:
  void make_room();

  std::size_t bytes_max_;
  std::size_t control_max_;
  std::deque<Frame> frames_;
  std::size_t bytes_ = 0;       ///< of all
  std::size_t flow_bytes_ = 0;  ///< of the flow
  std::size_t control_waiting_ = 0;
  std::int64_t dropped_ = 0;
};

}  // namespace vantage::tools
