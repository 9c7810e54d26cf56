#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "logs/edit/channel_rules.hpp"
#include "logs/export/mcap_export.hpp"
#include "logs/file/log_index.hpp"

namespace vantage::logs {

/// Returns the file name of the table of `channel`. Letters, digits, '_', '-' and dots except a
/// leading one are kept; every other byte becomes %NN. So the name cannot refer to another folder,
/// and different channels have different files.
std::string csv_file_name(std::string_view channel);

/// Writes each channel of `log` that `channels` selects as a table csv_file_name(channel) in
/// `folder`, which is created if absent. The columns are those of the channel's first message.
/// Events of other types are left out and counted. After a stop (`stop` is called for each event),
/// or if the disk is full, every table ends with a complete line.
/// @throws StartupError "PATH: cannot be …: REASON" if the folder or a table cannot be created.
ExportCounts export_csv(
    const IndexedLog& log, const std::string& folder, ChannelFilter& channels,
    const std::function<void(double)>& progress = {},
    const std::function<bool()>& stop = [] { return false; });

}  // namespace vantage::logs
