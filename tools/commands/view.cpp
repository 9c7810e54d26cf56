#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "bus/transport/transport.hpp"
#include "bus/transport/url.hpp"
#include "core/check.hpp"
#include "core/process.hpp"
#include "logs/file/seekable_log.hpp"
#include "tools/command_line/numbers.hpp"
#include "tools/commands/commands.hpp"
#include "tools/console/operator_desk.hpp"
#include "tools/console/operator_link.hpp"
#include "tools/live/screen.hpp"
#include "tools/log/log_commands.hpp"
#include "tools/view/live_view.hpp"
#include "tools/view/log_view.hpp"
#include "tools/view/origin_check.hpp"
#include "tools/view/record.hpp"

namespace vantage::tools {
namespace {

constexpr auto kWait = std::chrono::milliseconds(50);

struct ViewArguments {
  std::string log;
  std::vector<std::string> types;
  std::string url;
  std::string scenario;
  bool is_playing = false;
  bool is_operating = false;
  WebOptions web;
  RecordOptions record;
};

bool has_message_of(const logs::SeekableLog& log, const logs::TypeLibrary& types) {
  logs::LogScan scan(log.bytes());
  while (const auto event = scan.next()) {
    if (types.find(event->data) != nullptr) {
      return true;
    }
  }
  return false;
}

logs::SeekableLog open_seekable(const std::string& path) {
  const DefaultSignalScope reading;
  return logs::SeekableLog(path);
}

/// Completes the first pass over the log and shows the progress.
void survey(logs::SeekableLog& log) {
  constexpr std::size_t kStepBytes = std::size_t{16} << 20U;
  const DefaultSignalScope reading;
  const auto progress = progress_line("reading " + log.path());
  while (log.advance(kStepBytes)) {
    if (progress) {
      progress(log.surveyed_share());
    }
  }
  if (progress) {
    progress(1.0);
  }
}

bool has_message(const logs::SeekableLog& log) {
  const auto& channels = log.survey().channels;
  return std::any_of(channels.begin(), channels.end(), [](const auto& each) {
    return !each.second.type.empty() || each.second.other_types > 0;
  });
}

/// @throws StartupError if the log has no message of a known type, so that nothing can be shown.
void require_messages(logs::SeekableLog& log, const logs::TypeLibrary& types) {
  if (has_message(log) || (types.size() > 0 && has_message_of(log, types))) {
    return;
  }
  survey(log);
  if (!has_message(log)) {
    throw StartupError(fmt::format(
        "{}: nothing to show: none of its {} events is a message of this version of vantage{}; its "
        "channels are {}; name the .lcm files of other messages with --types; details: `vantage "
        "log info`",
        log.path(), log.survey().scan.events,
        types.size() == 0 ? "" : fmt::format(" or of the {} types that were given", types.size()),
        channel_names(log.survey())));
  }
}

int record(logs::SeekableLog& log, const logs::TypeLibrary& types, const ViewArguments& arguments) {
  constexpr int kStep_percent = 10;
  std::atomic<int> shown_percent = 0;
  const auto show_progress = [&](double share) {
    const int percent = static_cast<int>(100.0 * share) / kStep_percent * kStep_percent;
    if (percent > shown_percent.exchange(percent)) {
      print_line(fmt::format("record   {:3} %", percent));
    }
  };
  const bool is_whole =
      record_log(log, types, arguments.web, arguments.record, show_progress, stop_requested);
  print_line(is_whole ? "record   " + arguments.record.path
                      : "record   interrupted: the video is incomplete");
  return is_whole ? 0 : 1;
}

/// Function that returns the error that ended the work behind a view; empty while the work goes on.
using Failure = std::function<std::string()>;

/// Serves a live view until a stop is requested. `announce` is called once with the server.
int watch(const ViewArguments& arguments, const std::string& url, logs::TypeLibrary types,
          const std::function<void(const WebServer&)>& announce,
          const Failure& failure_behind = {}) {
  WebOptions web = arguments.web;
  web.source = bus::url_or_default(url);
  const LiveView view(bus::open_transport(url), web, std::move(types));
  announce_view(view.server(), "live");
  if (announce) {
    announce(view.server());
  }
  const auto failure = [&] {
    std::string words = view.failure();
    return words.empty() && failure_behind ? failure_behind() : words;
  };
  while (!stop_requested() && failure().empty()) {
    std::this_thread::sleep_for(kWait);
  }
  if (!failure().empty()) {
    throw std::runtime_error(failure());
  }
  return 0;
}

/// Serves a live view with an operator page.
/// @throws StartupError if other machines could reach the page and --host is not given.
int operate(const ViewArguments& arguments, logs::TypeLibrary types) {
  if (!is_loopback(arguments.web.bind) && arguments.web.hosts.empty()) {
    throw StartupError(fmt::format(
        "--bind {} opens the operator page to other machines; allow it with --host NAME, the name "
        "under which browsers reach this machine",
        arguments.web.bind));
  }
  OperatorLink link(arguments.url, arguments.scenario);
  const std::string key = new_secret();
  OperatorDesk desk(link, key);
  ViewArguments operating = arguments;
  operating.web.operate = [&desk](const std::string& what, const std::string& secret,
                                  const std::string& token, const std::string& body) {
    DeskAnswer answer = desk.answer(what, secret, token, body);
    return std::pair(answer.code, std::move(answer.json));
  };
  return watch(
      operating, link.url(), std::move(types),
      [&key](const WebServer& server) {
        print_line("operate  " + server.url() + "/#operate=" + key +
                   "   (everyone with this address can command the vehicles)");
      },
      [&desk] { return desk.failure(); });
}

int run(const ViewArguments& arguments) {
  logs::TypeLibrary types(arguments.types);
  if (!arguments.log.empty()) {
    logs::SeekableLog log = open_seekable(arguments.log);
    require_messages(log, types);
    if (log.bytes().size() <= kWholeBytesMax || !arguments.record.path.empty()) {
      survey(log);
    }
    if (!arguments.record.path.empty()) {
      return record(log, types, arguments);
    }
    serve_log(
        log, types, arguments.web, arguments.is_playing,
        [&](const WebServer& server) { announce_view(server, arguments.log); }, stop_requested);
    return 0;
  }
  return arguments.is_operating ? operate(arguments, std::move(types))
                                : watch(arguments, arguments.url, std::move(types), {});
}

/// Returns the folder of the viewer's page: the installed one if it exists, else the one of this
/// build.
std::string page_folder() {
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::filesystem::path installed =
      program.parent_path().parent_path() / "share/vantage/page";
  return std::filesystem::exists(installed / "index.html", error) ? installed.string()
                                                                  : VANTAGE_PAGE_FOLDER;
}

}  // namespace

void announce_view(const WebServer& server, const std::string& what) {
  print_line("view     " + server.url() + "   (" + what + ")");
  if (!server.has_page()) {
    print_line("         the page was not built (npm is missing); use Foxglove or Lichtblick:");
  }
  print_line("         Foxglove, Lichtblick: ws" + server.url().substr(4));
}

void add_web_options(CLI::App& command, WebOptions& web) {
  web.page_folder = page_folder();
  command.add_option("--port", web.port, "TCP port to serve on; 0: any free port")
      ->check(number_between(0, 65535))
      ->capture_default_str();
  command
      .add_option("--bind", web.bind, "address to serve on; 0.0.0.0: all addresses of this host")
      ->capture_default_str();
  command.add_option("--host", web.hosts,
                     "further host name that browsers may use to reach this host; repeatable");
  command.add_option("--origin", web.origins,
                     "other server whose pages may connect (https://NAME); repeatable");
  command.add_option("--page", web.page_folder,
                     "folder of the built page (default: the page of this build)");
}

void add_record_options(CLI::App& command, CLI::Option* log, RecordOptions& record) {
  constexpr int kSideMax_px = 4096;
  auto* path =
      command
          .add_option("--record", record.path,
                      "file for a video of the log (WebM), recorded by a browser without a window")
          ->needs(log);
  command
      .add_option("--from-s", record.from_s,
                  "start of the video, s after the start of the log (default: 0)")
      ->check(non_negative_number())
      ->needs(path);
  command
      .add_option("--to-s", record.to_s,
                  "end of the video, s after the start of the log (default: its end)")
      ->check(non_negative_number())
      ->needs(path);
  command.add_option("--speed", record.speed, "seconds of the log per second of the video")
      ->check(number_between(0.01, 1000))
      ->needs(path)
      ->capture_default_str();
  command.add_option("--fps", record.fps, "frames of the video per second")
      ->check(number_between(1, 60))
      ->needs(path)
      ->capture_default_str();
  command.add_option("--width", record.width, "width of the video, pixels")
      ->check(number_between(320, kSideMax_px))
      ->needs(path)
      ->capture_default_str();
  command.add_option("--height", record.height, "height of the video, pixels")
      ->check(number_between(240, kSideMax_px))
      ->needs(path)
      ->capture_default_str();
  command.add_flag("--dark", record.is_dark, "record the video with a dark background")
      ->needs(path);
  command
      .add_option(
          "--link", record.link,
          "settings for the video: the part of a page link after its # (camera, layers, followed "
          "robot)")
      ->needs(path);
}

void add_view_command(CLI::App& root, Runner& chosen) {
  CLI::App* command = root.add_subcommand("view", "Show live messages or a log in the browser.");
  auto arguments = std::make_shared<ViewArguments>();
  auto* log =
      command->add_option("log", arguments->log, "LCM log to play (default: live messages)");
  command->add_option("--types", arguments->types,
                      ".lcm files, or folders with them, that define messages of other programs");
  command->add_option("--url", arguments->url, "LCM URL to listen to (default: $LCM_DEFAULT_URL)")
      ->excludes(log);
  auto* is_operating =
      command
          ->add_flag("--operate", arguments->is_operating,
                     "serve an operator page as well: arm, take off, follow, hold, land, emergency "
                     "stop; only one page at a time can operate; its heartbeat ends when the page "
                     "is closed")
          ->excludes(log);
  command
      ->add_option("--scenario", arguments->scenario,
                   "scenario file; its security keys sign the commands of the operator page")
      ->needs(is_operating);
  command
      ->add_flag("--play", arguments->is_playing, "start playing the log at once (default: paused)")
      ->needs(log);
  add_record_options(*command, log, arguments->record);
  add_web_options(*command, arguments->web);
  command->footer(
      "Serves a web page and the Foxglove WebSocket protocol on one port; Foxglove and Lichtblick\n"
      "can connect without an extension. The view is read-only: it publishes nothing on the bus,\n"
      "except with --operate. The operator page needs the address that --operate prints.\n"
      "Ends with Ctrl-C.\n"
      "Examples:\n"
      "  vantage view\n"
      "  vantage view --operate --scenario config/lab-hil.yaml\n"
      "  vantage view demo-out/lab.lcmlog\n"
      "  vantage view arm.lcmlog --types arm/lcmtypes\n"
      "  vantage view demo-out/lab.lcmlog --record lab.webm --from-s 10 --to-s 40\n"
      "  vantage view --url 'udpm://239.255.76.67:7667?ttl=1' --bind 0.0.0.0 --port 8080");
  command->callback([&chosen, arguments] { chosen = [arguments] { return run(*arguments); }; });
}

}  // namespace vantage::tools
