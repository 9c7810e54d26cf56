#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>

#include "logs/edit/channel_rules.hpp"
#include "logs/file/log_index.hpp"

namespace vantage::logs {

struct ExportCounts {
  std::uint64_t messages = 0;  ///< written
  /// Events that are no whole message of this version, by channel; of the channels that were meant.
  std::map<std::string, std::int64_t> left_out;
  /// Messages with times that do not fit (McapWriter::times_held).
  std::int64_t times_held = 0;
  bool is_stopped = false;  ///< before the end, by who asked for it
  std::string failure;      ///< why not all could be written, with the file's name; else empty
};

/// Writes `log` as an MCAP file: each channel that `channels` takes as a topic of its name, schema
/// "vantage_lcm.<type>", and (with `with_scene`) the pictures, events and numbers that the viewer
/// shows, in the Foxglove schemas. A name that is no UTF-8 is written as readable() has it. Told to
/// `stop` (asked at each event), it ends the file where it is, whole.
/// @throws StartupError when `path` cannot be written.
ExportCounts export_mcap(
    const IndexedLog& log, const std::string& path, ChannelFilter& channels, bool with_scene,
    const std::function<void(double)>& progress = {},
    const std::function<bool()>& stop = [] { return false; });

/// Writes what of `log` has a counterpart in ROS 2 as an MCAP file of the profile "ros2", which ROS
/// 2's own tools open: CDR messages, topics and frames as docs/guide/ros2.md says. Channels of
/// which nothing has one are left out, and not counted as such.
/// @throws StartupError when `path` cannot be written.
ExportCounts export_ros2(
    const IndexedLog& log, const std::string& path, ChannelFilter& channels,
    const std::function<void(double)>& progress = {},
    const std::function<bool()>& stop = [] { return false; });

}  // namespace vantage::logs
