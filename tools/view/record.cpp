#include "tools/view/record.hpp"

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <iterator>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "bus/node/bus.hpp"
#include "core/check.hpp"
#include "core/child.hpp"
#include "core/write_file.hpp"
#include "tools/view/live_view.hpp"
#include "tools/view/recording_receiver.hpp"

namespace vantage::tools {
namespace {

namespace fs = std::filesystem;

constexpr const char* kBrowsers[] = {"chromium", "chromium-browser", "google-chrome",
                                     "google-chrome-stable"};

/// Temporary folder that is removed by the destructor. Killed processes may write into the folder
/// for a short time, so the removal is tried repeatedly.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (fs::temp_directory_path() / "vantage-record.XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) {
      throw StartupError(name + ": cannot be created");
    }
    path_ = name;
  }
  ~TemporaryFolder() {
    std::error_code error;
    for (int tries = 0; tries < kTriesToRemove; ++tries) {
      fs::remove_all(path_, error);
      if (!fs::exists(path_, error)) {
        break;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  TemporaryFolder(TemporaryFolder&&) = delete;
  TemporaryFolder& operator=(TemporaryFolder&&) = delete;

  [[nodiscard]] std::string file(const std::string& name) const { return path_ / name; }

 private:
  static constexpr int kTriesToRemove = 500;  // 5 s; it is unknown when the browser's children end
  fs::path path_;
};

Child start_browser(const std::string& address, const RecordOptions& options,
                    const TemporaryFolder& folder) {
  const char* named = std::getenv("CHROMIUM");
  std::vector<std::string> names(std::begin(kBrowsers), std::end(kBrowsers));
  if (named != nullptr) {
    names = {named};
  }
  const int output = ::open(folder.file("said").c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  ChildOptions child_options;
  child_options.output = output;
  child_options.end_signal = SIGKILL;
  child_options.environment = {"TMPDIR=" +
                               folder.file("")};  // folder for the browser's temporary files
  std::optional<Child> browser;
  for (const std::string& name : names) {
    std::vector<std::string> words = {
        name, "--headless", "--no-first-run", "--mute-audio", "--hide-scrollbars",
        "--disable-extensions", "--disable-background-networking", "--disable-component-update",
        "--disable-sync", "--no-proxy-server", "--force-device-scale-factor=1",
        // without this option the browser ends once the page is loaded
        "--remote-debugging-port=0", "--user-data-dir=" + folder.file("profile"),
        fmt::format("--window-size={},{}", options.width, options.height)};
    if (::geteuid() == 0) {
      words.emplace_back("--no-sandbox");  // the browser refuses to run sandboxed as root
    }
    words.push_back(address);
    Result<Child> started = Child::start(words, child_options);
    if (started.ok()) {
      browser.emplace(std::move(started).value());
      break;
    }
  }
  ::close(output);
  if (!browser) {
    throw StartupError(
        fmt::format("no browser to record with: {} cannot be started; install Chromium or set "
                    "CHROMIUM to its path",
                    fmt::join(names, ", ")));
  }
  return std::move(*browser);
}

}  // namespace

std::string record_address(const std::string& url, const std::string& key,
                           const RecordOptions& options, double length_s) {
  std::string out = fmt::format("{}/?record={}&from={}&to={}&speed={}&fps={}&width={}&height={}",
                                url, key, options.from_s, options.to_s.value_or(length_s),
                                options.speed, options.fps, options.width, options.height);
  out += options.is_dark ? "&theme=dark" : "&theme=light";
  return options.link.empty() ? out : out + "#" + options.link;
}

bool record_log(logs::SeekableLog& log, const logs::TypeLibrary& types, WebOptions web,
                const RecordOptions& options, const std::function<void(double)>& progress,
                const std::function<bool()>& stop) {
  const double length_s = to_seconds(log.range().second - log.range().first);
  if (options.from_s >= options.to_s.value_or(length_s) || options.from_s >= length_s) {
    throw StartupError(
        fmt::format("{}: the part from {} to {} s cannot be recorded: the log is {:.1f} s long",
                    log.path(), options.from_s, options.to_s.value_or(length_s), length_s));
  }
  require_writable(options.path);
  const TemporaryFolder folder;
  RecordingReceiver receiver(fmt::format("{:016x}", bus::random_run_id()), progress);
  web.bind = "127.0.0.1";  // browsers encode video only for pages from a secure or local address
  web.port = 0;
  web.recording = &receiver;
  std::optional<Child> browser;
  const auto begin = [&](const WebServer& server) {
    if (!server.has_page()) {
      throw StartupError(
          "videos need the viewer's page, which was not built: run tools/setup and build again");
    }
    browser.emplace(start_browser(record_address(server.url(), receiver.key(), options, length_s),
                                  options, folder));
  };
  const auto is_over = [&] {
    if (!receiver.is_over() && browser && browser->wait(std::chrono::milliseconds(0))) {
      receiver.fail("the browser ended too early: " +
                    browser->wait(std::chrono::milliseconds(0))->describe());
    }
    return receiver.is_over() || stop();
  };
  serve_log(log, types, web, false, begin, is_over);
  browser.reset();
  if (!receiver.failure().empty()) {
    throw std::runtime_error("no video was made: " + receiver.failure());
  }
  const std::string video = receiver.video();
  if (video.empty()) {
    return false;
  }
  write_file(options.path, video);
  return true;
}

}  // namespace vantage::tools
