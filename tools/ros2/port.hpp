#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "scenario/ros2_spec.hpp"

namespace vantage::tools::ros2 {

/// Quality of service of a topic.
enum class Durability {
  kVolatile,   ///< ROS 2's default: reliable, keeps the last 10 messages
  kTransient,  ///< for maps: reliable; a late reader gets the newest message
};

/// Connection to ROS 2 by topics, types and messages in CDR. Not thread-safe.
class Port {
 public:
  Port() = default;
  virtual ~Port() = default;
  Port(const Port&) = delete;
  Port& operator=(const Port&) = delete;
  Port(Port&&) = delete;
  Port& operator=(Port&&) = delete;

  /// Publishes a message; the first message on a topic creates its writer. Returns false if the
  /// message was not written. Never waits for readers.
  virtual bool write(const std::string& topic, std::string_view type, Durability durability,
                     std::string_view cdr) = 0;
  /// Subscribes to a topic. take() passes its messages to `handler`.
  virtual void read(const std::string& topic, std::string_view type,
                    std::function<void(std::span<const std::uint8_t> cdr)> handler) = 0;
  /// Passes all messages that have arrived to their handlers.
  virtual void take() = 0;
};

/// Joins the domain of `spec` on its network card.
/// @throws StartupError if this build has no DDS, or the domain cannot be joined.
std::unique_ptr<Port> open_port(const scenario::Ros2Spec& spec);

}  // namespace vantage::tools::ros2
