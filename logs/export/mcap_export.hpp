#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>

#include "logs/edit/channel_rules.hpp"
#include "logs/file/log_index.hpp"

namespace vantage::logs {

struct ExportCounts {
  std::uint64_t messages = 0;  ///< number of messages written
  /// Number of events on selected channels that are not a complete message of this version, by
  /// channel.
  std::map<std::string, std::int64_t> left_out;
  /// Number of messages with times out of range (McapWriter::times_held).
  std::int64_t times_held = 0;
  bool is_stopped = false;  ///< ended early by the caller's request
  std::string failure;      ///< reason of an incomplete export, with the file's name; else empty
};

/// Writes `log` as an MCAP file. Each channel that `channels` selects becomes a topic of the same
/// name with schema "vantage_lcm.<type>". With `with_scene`, it adds the drawings, events and
/// numbers of the viewer in the Foxglove schemas. Names that are not UTF-8 are written as
/// readable() converts them. After a stop (`stop` is called for each event) the file is valid and
/// contains the events before the stop.
/// @throws StartupError if `path` cannot be written.
ExportCounts export_mcap(
    const IndexedLog& log, const std::string& path, ChannelFilter& channels, bool with_scene,
    const std::function<void(double)>& progress = {},
    const std::function<bool()>& stop = [] { return false; });

/// Writes the parts of `log` that have a counterpart in ROS 2 as an MCAP file of the profile
/// "ros2", which the ROS 2 tools open: CDR messages, topics and frames as in docs/guide/ros2.md.
/// Channels without a counterpart are left out and are not counted in `left_out`.
/// @throws StartupError if `path` cannot be written.
ExportCounts export_ros2(
    const IndexedLog& log, const std::string& path, ChannelFilter& channels,
    const std::function<void(double)>& progress = {},
    const std::function<bool()>& stop = [] { return false; });

}  // namespace vantage::logs
