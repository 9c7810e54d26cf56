#include "logs/file/log_index.hpp"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

#include <nlohmann/json.hpp>
#include <unistd.h>

#include "logs/file/wire_witness.hpp"

namespace vantage::logs {
namespace {

using Json = nlohmann::json;
namespace fs = std::filesystem;

constexpr int kFormat = 2;
constexpr std::size_t kEndBytes = 4096;
constexpr std::size_t kBlockNumbers = 4;  ///< of each, 64 bits
constexpr std::size_t kHashBytes = 8;     ///< at the end of the index, of all before

std::uint64_t hash_of(std::span<const std::uint8_t> bytes) {  // FNV-1a
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (const std::uint8_t byte : bytes) {
    hash = (hash ^ byte) * 0x100000001b3ULL;
  }
  return hash;
}

/// What tells this very log from another.
Json identity_of(const std::string& path, std::span<const std::uint8_t> log) {
  std::error_code error;
  const auto changed = fs::last_write_time(path, error).time_since_epoch().count();
  const std::size_t end = std::min(kEndBytes, log.size());
  return {kFormat, log.size(), changed, hash_of(log.first(end)), hash_of(log.last(end))};
}

Json to_json(const LogSurvey& survey) {
  Json channels = Json::array();
  for (const auto& [name, c] : survey.channels) {
    channels.push_back({name, c.type, c.events, c.data_bytes, to_utime(c.first), to_utime(c.last),
                        c.gap_max.count(), to_utime(c.gap_at), c.messages_lost, c.other_types,
                        Json::binary(c.in_block)});
  }
  std::vector<std::uint8_t> blocks;  // bytes: tens of thousands of lists are slow to read
  blocks.reserve(survey.blocks.size() * kBlockNumbers * sizeof(std::uint64_t));
  for (const LogBlock& b : survey.blocks) {
    for (const std::int64_t number : {static_cast<std::int64_t>(b.offset), b.first_event,
                                      to_utime(b.time_min), to_utime(b.time_max)}) {
      append_big_endian(static_cast<std::uint64_t>(number), sizeof number, blocks);
    }
  }
  Json stretches = Json::array();
  for (const DamagedStretch& s : survey.stretches) {
    stretches.push_back({s.offset, s.size_bytes, s.is_tail});
  }
  const ScanCounts& scan = survey.scan;
  return {{"size", survey.size_bytes},
          {"scan", {scan.events, scan.doubtful, scan.refused, scan.stretches, scan.bytes_damaged}},
          {"times", {to_utime(survey.first), to_utime(survey.last)}},
          {"order",
           {survey.numbers_missing, survey.number_restarts, survey.times_backward,
            survey.backward_max.count()}},
          {"scenario", survey.begins_with_scenario},
          {"channels", std::move(channels)},
          {"blocks", Json::binary(std::move(blocks))},
          {"stretches", std::move(stretches)}};
}

LogSurvey from_json(const Json& json) {
  const auto time = [](const Json& utime) { return from_utime(utime.get<std::int64_t>()); };
  LogSurvey survey;
  survey.size_bytes = json.at("size");
  const Json& scan = json.at("scan");
  survey.scan = {scan.at(0), scan.at(1), scan.at(2), scan.at(3), scan.at(4)};
  survey.first = time(json.at("times").at(0));
  survey.last = time(json.at("times").at(1));
  const Json& order = json.at("order");
  survey.numbers_missing = order.at(0);
  survey.number_restarts = order.at(1);
  survey.times_backward = order.at(2);
  survey.backward_max = Duration{order.at(3).get<std::int64_t>()};
  survey.begins_with_scenario = json.at("scenario");
  for (const Json& c : json.at("channels")) {
    survey.channels[c.at(0)] = {c.at(1),       c.at(2),
                                c.at(3),       time(c.at(4)),
                                time(c.at(5)), Duration{c.at(6).get<std::int64_t>()},
                                time(c.at(7)), c.at(8),
                                c.at(9),       c.at(10).get_binary()};
  }
  const std::vector<std::uint8_t>& blocks = json.at("blocks").get_binary();
  constexpr std::size_t kNumberBytes = sizeof(std::uint64_t);
  survey.blocks.reserve(blocks.size() / (kBlockNumbers * kNumberBytes));
  for (std::size_t at = 0; at < blocks.size(); at += kBlockNumbers * kNumberBytes) {
    const auto number = [&](std::size_t i) {
      return static_cast<std::int64_t>(
          read_big_endian(blocks.data() + at + i * kNumberBytes, kNumberBytes));
    };
    survey.blocks.push_back({static_cast<std::size_t>(number(0)), number(1), from_utime(number(2)),
                             from_utime(number(3))});
  }
  for (const Json& s : json.at("stretches")) {
    survey.stretches.push_back({s.at(0), s.at(1), s.at(2)});
  }
  return survey;
}

std::string index_path(const std::string& log_path) { return log_path + ".index"; }

}  // namespace

std::optional<LogSurvey> load_index(const std::string& log_path,
                                    std::span<const std::uint8_t> log) {
  std::ifstream in(index_path(log_path), std::ios::binary);
  if (!in) {
    return std::nullopt;
  }
  const std::vector<std::uint8_t> whole{std::istreambuf_iterator<char>(in),
                                        std::istreambuf_iterator<char>()};
  if (whole.size() < kHashBytes) {
    return std::nullopt;
  }
  const auto text = std::span(whole).first(whole.size() - kHashBytes);
  if (read_big_endian(text.data() + text.size(), kHashBytes) != hash_of(text)) {
    return std::nullopt;
  }
  const Json json = Json::from_cbor(text.begin(), text.end(), true, false);
  if (!json.is_object() || json.value("identity", Json()) != identity_of(log_path, log)) {
    return std::nullopt;
  }
  try {
    return from_json(json.at("survey"));
  } catch (const Json::exception&) {  // of another version
    return std::nullopt;
  }
}

bool save_index(const std::string& log_path, std::span<const std::uint8_t> log,
                const LogSurvey& survey) {
  std::vector<std::uint8_t> text =
      Json::to_cbor({{"identity", identity_of(log_path, log)}, {"survey", to_json(survey)}});
  const std::uint64_t hash = hash_of(text);
  append_big_endian(hash, kHashBytes, text);
  // Under another name first: who opens the log meanwhile must find a whole index or none.
  const std::string passing = index_path(log_path) + "." + std::to_string(::getpid());
  {
    std::ofstream out(passing, std::ios::binary);
    out.write(reinterpret_cast<const char*>(text.data()), std::ssize(text));
    if (!out.flush()) {
      std::remove(passing.c_str());
      return false;
    }
  }
  return std::rename(passing.c_str(), index_path(log_path).c_str()) == 0;
}

IndexedLog::IndexedLog(const std::string& path, const std::function<void(double)>& progress)
    : file_(path) {
  if (auto known = load_index(path, bytes())) {
    survey_ = std::move(*known);
    was_indexed_ = true;
    return;
  }
  survey_ = survey_log(bytes(), progress);
  static_cast<void>(save_index(path, bytes(), survey_));
}

LogScan IndexedLog::scan() const { return LogScan(bytes(), wire_testimony); }

LogScan IndexedLog::scan_from(Time from) const {
  return LogScan(bytes(), wire_testimony, seek_offset(bytes(), survey_, from));
}

}  // namespace vantage::logs
