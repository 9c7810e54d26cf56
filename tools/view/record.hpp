#pragma once

#include <functional>
#include <optional>
#include <string>

#include "logs/file/seekable_log.hpp"
#include "logs/types/type_library.hpp"
#include "tools/view/web_server.hpp"

namespace vantage::tools {

/// Options of a video of a log.
struct RecordOptions {
  std::string path;  ///< path of the WebM file to write
  double from_s = 0.0;
  std::optional<double> to_s;  ///< nullopt: the end of the log
  double speed = 1.0;          ///< seconds of the log per second of the video
  int fps = 25;
  int width = 1280;
  int height = 720;
  bool is_dark = false;
  std::string link;  ///< part of a page link after its '#': view, cameras, layers
};

/// Returns the address of the page that the browser opens to make the recording.
std::string record_address(const std::string& url, const std::string& key,
                           const RecordOptions& options, double length_s);

/// Makes the video. Serves the log to this host only and starts a headless browser, which draws the
/// picture of each instant without a time limit. Writes the file when the video is complete. Calls
/// `progress` with the completed share in [0, 1]. Returns false if `stop` returned true before the
/// video was complete.
/// @throws StartupError if the browser or the page is missing, or the file cannot be written;
///   std::runtime_error if the browser fails.
bool record_log(logs::SeekableLog& log, const logs::TypeLibrary& types, WebOptions web,
                const RecordOptions& options, const std::function<void(double)>& progress,
                const std::function<bool()>& stop);

}  // namespace vantage::tools
