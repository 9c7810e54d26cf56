#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "logs/edit/channel_rules.hpp"
#include "logs/export/mcap_export.hpp"
#include "logs/file/log_index.hpp"

namespace vantage::logs {

/// The file that the table of `channel` is written to, in whatever folder: letters, digits, '_',
/// '-' and dots but the first stay, every other byte becomes %NN. So it never names another folder,
/// and different channels have different files.
std::string csv_file_name(std::string_view channel);

/// Writes each channel of `log` that `channels` takes as a table csv_file_name(channel) in
/// `folder`, which is made when absent. Its columns are those of the channel's first message;
/// events of other types are left out and counted. Told to `stop` (asked at each event), or when
/// the disk is full, every table ends with a whole line.
/// @throws StartupError "PATH: cannot be …: REASON" when the folder or a table cannot be made.
ExportCounts export_csv(
    const IndexedLog& log, const std::string& folder, ChannelFilter& channels,
    const std::function<void(double)>& progress = {},
    const std::function<bool()>& stop = [] { return false; });

}  // namespace vantage::logs
