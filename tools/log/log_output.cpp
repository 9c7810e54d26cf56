#include <cstdio>
#include <filesystem>

#include <fmt/format.h>
#include <unistd.h>

#include "core/check.hpp"
#include "tools/log/log_commands.hpp"

namespace vantage::tools {

std::function<void(double)> progress_line(const std::string& what) {
  if (::isatty(STDERR_FILENO) != 1) {
    return {};
  }
  return [what](double share) {
    fmt::print(stderr, "\r{} {:3.0f} %", what, 100.0 * share);
    if (share >= 1.0) {
      fmt::print(stderr, "\r{:{}}\r", "", what.size() + 6);
    }
  };
}

std::string OutputLog::checked(const std::string& path, const std::vector<std::string>& inputs,
                               bool force) {
  std::error_code error;
  for (const std::string& input : inputs) {
    if (std::filesystem::equivalent(path, input, error)) {
      throw StartupError(path + ": is the log to be read; give the new one another name");
    }
  }
  if (!force && std::filesystem::exists(path, error)) {
    throw StartupError(path + ": exists; --force writes over it");
  }
  return path;
}

OutputLog::OutputLog(const std::string& path, const std::vector<std::string>& inputs, bool force)
    : writer_(checked(path, inputs, force),
              force ? logs::Existing::kReplace : logs::Existing::kRefuse) {}

std::optional<Error> OutputLog::close(logs::EditCounts& counts) {
  auto error = writer_.close();
  counts.written = writer_.events();
  counts.failed = writer_.events_lost();
  return error;
}

logs::EventSink OutputLog::sink() {
  return [this](const logs::LogEvent& event) {
    return writer_.write(event.time, event.channel, event.data);
  };
}

}  // namespace vantage::tools
