#pragma once

#include <functional>
#include <optional>
#include <string>

#include "logs/file/seekable_log.hpp"
#include "logs/types/type_library.hpp"
#include "tools/view/web_server.hpp"

namespace vantage::tools {

/// Which video of a log is to be made.
struct RecordOptions {
  std::string path;  ///< of the WebM file
  double from_s = 0.0;
  std::optional<double> to_s;  ///< none: the log's end
  double speed = 1.0;          ///< seconds of the log in one of the video
  int fps = 25;
  int width = 1280;
  int height = 720;
  bool is_dark = false;
  std::string link;  ///< what a link of the page says behind its #: view, cameras, layers
};

/// The page's address for a browser that is to record.
std::string record_address(const std::string& url, const std::string& key,
                           const RecordOptions& options, double length_s);

/// Makes the video: serves the log to this host alone, starts a browser without a window that
/// draws each picture at its instant, however long that takes, and writes the file when it is
/// whole. `progress` hears the share that is done.
/// @throws StartupError when there is no browser or page, or the file cannot be written;
///   std::runtime_error when the browser fails. False: `stop` said so before it was whole.
bool record_log(logs::SeekableLog& log, const logs::TypeLibrary& types, WebOptions web,
                const RecordOptions& options, const std::function<void(double)>& progress,
                const std::function<bool()>& stop);

}  // namespace vantage::tools
