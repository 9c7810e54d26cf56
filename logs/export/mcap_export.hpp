#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include "logs/edit/channel_rules.hpp"
#include "logs/file/log_index.hpp"

namespace vantage::logs {

struct McapExportCounts {
  std::uint64_t messages = 0;     ///< in the file
  std::int64_t not_exported = 0;  ///< events that are no message of the house
  bool is_written = false;        ///< all of it reached the file
};

/// Writes `log` as an MCAP file: each channel that `channels` takes as a topic of its name, schema
/// "vantage_lcm.<type>", and (with `with_scene`) the pictures, events and numbers that the viewer
/// shows, in the Foxglove schemas. @throws StartupError when `path` cannot be written.
McapExportCounts export_mcap(const IndexedLog& log, const std::string& path,
                             ChannelFilter& channels, bool with_scene,
                             const std::function<void(double)>& progress = {});

}  // namespace vantage::logs
