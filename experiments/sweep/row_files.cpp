#include "experiments/sweep/row_files.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include "core/check.hpp"
#include "experiments/sweep/manifest.hpp"

namespace vantage::experiments {
namespace {

std::string text_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  if (!file) {
    throw StartupError(path.string() + ": cannot be read");
  }
  return std::move(text).str();
}

RowProcess process_of_line(const std::string& line, const SweepPlan& plan,
                           const SweepIdentity& identity) {
  const auto header = nlohmann::json::parse(line);
  const auto& json = header.at("process");
  const std::string difference =
      difference_of(header.value("run", nlohmann::json()).dump(), identity, plan);
  if (!difference.empty()) {
    throw StartupError("rows of another run: " + difference);
  }
  RowProcess process;
  process.machine = json.at("machine").get<std::string>();
  process.cores = json.at("cores").get<int>();
  process.jobs = json.at("jobs").get<int>();
  process.shard = json.at("shard").get<std::string>();
  process.started = json.at("started").get<std::string>();
  return process;
}

void keep(StoredRows& stored, RowProcess& process, const SweepPlan& plan, const std::string& line) {
  auto [unit, rows] = unit_of_line(plan, line);
  ++process.units;
  for (const auto& [part, cpu_s] : rows.times_s) {
    process.cpu_s += part == "unit" ? cpu_s : 0.0;
  }
  if (unit.trial >= plan.trials) {
    return;
  }
  const auto [there, is_new] = stored.done.try_emplace(unit, std::move(rows));
  if (!is_new && there->second.tables != rows.tables) {
    throw StartupError(fmt::format("setting '{}', trial {}: was run twice with different rows",
                                   plan.settings[unit.setting].cells, unit.trial));
  }
}

void read_file(const std::filesystem::path& path, const SweepPlan& plan,
               const SweepIdentity& identity, StoredRows& stored) {
  const std::string text = text_of(path);
  RowProcess process;
  std::size_t number = 1;
  for (std::size_t begin = 0; begin < text.size(); ++number) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const bool is_last = end + 1 >= text.size();
    const std::string line = text.substr(begin, end - begin);
    begin = end + 1;
    if (end == text.size()) {  // the last line is incomplete
      ++stored.torn;
      break;
    }
    try {
      if (number == 1) {
        process = process_of_line(line, plan, identity);
      } else {
        keep(stored, process, plan, line);
      }
    } catch (const StartupError& error) {
      throw StartupError(fmt::format("{}:{}: {}", path.string(), number, error.what()));
    } catch (const std::exception& error) {
      if (!is_last) {
        throw StartupError(
            fmt::format("{}:{}: not a row of this run: {}", path.string(), number, error.what()));
      }
      ++stored.torn;
    }
  }
  stored.processes.push_back(process);
}

}  // namespace

std::string unit_line(const SweepPlan& plan, const Unit& unit, const UnitRows& rows) {
  nlohmann::ordered_json json;
  json["setting"] = plan.settings[unit.setting].cells;
  json["trial"] = unit.trial;
  json["rows"] = rows.tables;
  json["times_s"] = rows.times_s;
  return json.dump();
}

std::pair<Unit, UnitRows> unit_of_line(const SweepPlan& plan, const std::string& line) {
  const auto json = nlohmann::json::parse(line);
  const auto cells = json.at("setting").get<std::string>();
  const auto setting = std::find_if(plan.settings.begin(), plan.settings.end(),
                                    [&](const Setting& s) { return s.cells == cells; });
  if (setting == plan.settings.end()) {
    throw std::runtime_error("unknown setting '" + cells + "'");
  }
  UnitRows rows;
  json.at("rows").get_to(rows.tables);
  json.at("times_s").get_to(rows.times_s);
  return {{static_cast<std::size_t>(setting - plan.settings.begin()), json.at("trial").get<int>()},
          std::move(rows)};
}

StoredRows read_rows(const std::string& directory, const SweepPlan& plan,
                     const SweepIdentity& identity) {
  StoredRows stored;
  const std::filesystem::path folder = std::filesystem::path(directory) / "rows";
  std::vector<std::filesystem::path> paths;
  if (std::filesystem::is_directory(folder)) {
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      if (entry.path().extension() == ".jsonl") {
        paths.push_back(entry.path());
      }
    }
  }
  std::sort(paths.begin(), paths.end());
  for (const std::filesystem::path& path : paths) {
    read_file(path, plan, identity, stored);
  }
  return stored;
}

RowWriter::RowWriter(const std::string& directory, const RowProcess& process,
                     const SweepIdentity& identity, const SweepPlan& plan) {
  const std::filesystem::path folder = std::filesystem::path(directory) / "rows";
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  std::string shard = process.shard;
  std::replace(shard.begin(), shard.end(), '/', '_');
  for (int k = 0; descriptor_ < 0; ++k) {
    path_ = folder / fmt::format("{}-{}-{}-{}.jsonl", shard, host_name(), ::getpid(), k);
    descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0644);
    if (descriptor_ < 0 && errno != EEXIST) {
      throw StartupError(path_ + ": cannot be created: " + std::strerror(errno));
    }
  }
  nlohmann::ordered_json json;
  json["process"] = {{"machine", process.machine},
                     {"cores", process.cores},
                     {"jobs", process.jobs},
                     {"shard", process.shard},
                     {"started", process.started}};
  json["run"] = nlohmann::ordered_json::parse(identity_text(identity, plan));
  append(json.dump());
}

RowWriter::~RowWriter() {
  if (descriptor_ >= 0) {
    ::close(descriptor_);
  }
}

void RowWriter::append(const std::string& line) {
  const std::string text = line + "\n";
  std::size_t written = 0;
  while (written < text.size()) {
    const ssize_t count = ::write(descriptor_, text.data() + written, text.size() - written);
    if (count < 0 && errno == EINTR) {
      continue;
    }
    if (count < 0) {
      const int why = errno;
      // The incomplete line is removed, so that other units are not appended to it.
      if (::ftruncate(descriptor_, whole_bytes_) != 0) {
        ::close(std::exchange(descriptor_, -1));
      }
      throw std::runtime_error(path_ + ": cannot be written: " + std::strerror(why));
    }
    written += static_cast<std::size_t>(count);
  }
  whole_bytes_ += static_cast<off_t>(text.size());
}

}  // namespace vantage::experiments
