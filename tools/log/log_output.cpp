#include <algorithm>
#include <cstdio>
#include <filesystem>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <unistd.h>

#include "bus/transport/url.hpp"
#include "core/check.hpp"
#include "core/process.hpp"
#include "core/utf8.hpp"
#include "tools/live/screen.hpp"
#include "tools/log/log_commands.hpp"

namespace vantage::tools {

std::function<void(double)> progress_line(const std::string& what) {
  if (::isatty(STDERR_FILENO) != 1) {
    return {};
  }
  return [what](double share) {
    fmt::print(stderr, "\r{} {:3.0f} %", readable(what), 100.0 * share);
    if (share >= 1.0) {
      fmt::print(stderr, "\r{:{}}\r", "", what.size() + 6);
    }
  };
}

std::string url_for_log(const std::string& url) {
  return bus::with_udpm_option(bus::url_or_default(url), "max_message_size",
                               std::to_string(kLogMessageBytesMax));
}

logs::IndexedLog open_log(const std::string& path) {
  const DefaultSignalScope reading;
  return logs::IndexedLog(path, progress_line("reading " + path));
}

std::string channel_names(const logs::LogSurvey& survey) {
  constexpr std::size_t kNamed = 20;
  std::vector<std::string> names;
  for (const auto& [name, channel] : survey.channels) {
    names.push_back(readable(name));
  }
  const std::size_t more = names.size() > kNamed ? names.size() - kNamed : 0;
  names.resize(names.size() - more);
  return fmt::format("{}{}", fmt::join(names, ", "),
                     more > 0 ? fmt::format(" and {} more", more) : "");
}

void require_channels(const logs::IndexedLog& log, const std::vector<std::string>& expressions) {
  std::vector<std::string> without;
  for (const std::string& expression : expressions) {
    logs::ChannelFilter filter({expression}, {});
    const auto& channels = log.survey().channels;
    if (std::none_of(channels.begin(), channels.end(),
                     [&](const auto& each) { return filter.takes(each.first); })) {
      without.push_back("'" + expression + "'");
    }
  }
  if (without.empty()) {
    return;
  }
  const std::string words =
      fmt::format("{}: no channel's whole name matches {}; the log has {}", log.path(),
                  fmt::join(without, " or "), channel_names(log.survey()));
  if (without.size() == expressions.size()) {
    throw StartupError(words);
  }
  print_line("vantage: " + words, stderr);
}

std::string OutputLog::checked(const std::string& path, const std::vector<std::string>& inputs,
                               bool force) {
  std::error_code error;
  for (const std::string& input : inputs) {
    if (std::filesystem::equivalent(path, input, error)) {
      throw StartupError(path + ": is an input log; choose another name for the output");
    }
  }
  if (!force && std::filesystem::exists(path, error)) {
    throw StartupError(path +
                       ": exists already; choose another name, or overwrite it with --force");
  }
  return path;
}

OutputLog::OutputLog(const std::string& path, const std::vector<std::string>& inputs, bool force)
    : writer_(checked(path, inputs, force),
              force ? logs::Existing::kReplace : logs::Existing::kRefuse) {}

std::string OutputLog::finish() {
  const std::optional<Error> error = writer_.close();
  return error ? error->message : std::string();
}

logs::EventSink OutputLog::sink() {
  return [this](const logs::LogEvent& event) {
    return writer_.write(event.time, event.channel, event.data);
  };
}

}  // namespace vantage::tools
