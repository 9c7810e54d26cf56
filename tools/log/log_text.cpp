#include "tools/log/log_text.hpp"

#include <array>
#include <ctime>

#include <fmt/format.h>

#include "core/utf8.hpp"

namespace vantage::tools {
namespace {

using logs::ChannelSurvey;

double since_start_s(const logs::LogSurvey& survey, Time time) {
  return to_seconds(time - survey.begin);
}

double rate_hz(const ChannelSurvey& channel) {
  const double span_s = to_seconds(channel.last - channel.first);
  return span_s > 0.0 ? static_cast<double>(channel.events - 1) / span_s : 0.0;
}

std::string utc_text(Time time) {
  const std::int64_t utime = to_utime(time);
  const auto seconds = static_cast<std::time_t>(utime / 1'000'000);
  std::tm parts{};
  gmtime_r(&seconds, &parts);
  return fmt::format("{:04}-{:02}-{:02} {:02}:{:02}:{:02}.{:06} UTC", parts.tm_year + 1900,
                     parts.tm_mon + 1, parts.tm_mday, parts.tm_hour, parts.tm_min, parts.tm_sec,
                     utime % 1'000'000);
}

}  // namespace

std::string bytes_text(double bytes) {
  constexpr double kStep = 1024.0;
  constexpr std::array kUnits{"B", "KiB", "MiB", "GiB", "TiB"};
  std::size_t unit = 0;
  while (bytes >= kStep && unit + 1 < kUnits.size()) {
    bytes /= kStep;
    ++unit;
  }
  return fmt::format("{:.{}f} {}", bytes, unit == 0 ? 0 : 1, kUnits.at(unit));
}

std::vector<std::string> describe_content(const std::string& path, const logs::LogSurvey& survey,
                                          const std::string& flown_by) {
  std::vector<std::string> out;
  out.push_back(
      fmt::format("log       {}, {}", path, bytes_text(static_cast<double>(survey.size_bytes))));
  if (survey.scan.events == 0) {
    out.emplace_back("events    none");
    return out;
  }
  out.push_back(fmt::format("begins    {}", utc_text(survey.begin)));
  out.push_back(
      fmt::format("lasts     {:.3f} s, {} events", survey.duration_s(), survey.scan.events));
  if (survey.times_outlying > 0) {
    out.push_back(fmt::format("times     {} events are more than a day away from all others",
                              survey.times_outlying));
  }
  out.push_back(fmt::format(
      "flown by  {}", flown_by.empty() ? "unknown: the log has no SCENARIO message" : flown_by));
  std::size_t width = 7;
  for (const auto& [name, channel] : survey.channels) {
    width = std::max(width, readable(name).size());
  }
  out.push_back(fmt::format("{:{}}  {:15} {:>8} {:>8} {:>10} {:>10} {:>9} {:>6}", "channel", width,
                            "type", "events", "rate Hz", "size", "gap s", "gap at s", "lost"));
  for (const auto& [name, channel] : survey.channels) {
    const std::string type =
        (channel.type.empty() ? "?" : channel.type) + (channel.other_types > 0 ? " (mixed)" : "");
    out.push_back(fmt::format(
        "{:{}}  {:15} {:>8} {:>8.2f} {:>10} {:>10.3f} {:>9.1f} {:>6}", readable(name), width, type,
        channel.events, rate_hz(channel), bytes_text(static_cast<double>(channel.data_bytes)),
        to_seconds(channel.gap_max), since_start_s(survey, channel.gap_at), channel.messages_lost));
  }
  return out;
}

std::vector<std::string> describe_damage(const logs::LogSurvey& survey) {
  constexpr std::size_t kStretchesNamed = 20;
  std::vector<std::string> out;
  for (const logs::DamagedStretch& stretch : survey.stretches) {
    if (out.size() == kStretchesNamed) {
      out.push_back(fmt::format("… and {} more stretches",
                                survey.scan.stretches - static_cast<std::int64_t>(out.size())));
      break;
    }
    out.push_back(fmt::format("byte {}: {} that belong to no event{}", stretch.offset,
                              bytes_text(static_cast<double>(stretch.size_bytes)),
                              stretch.is_tail ? ", up to the end (cut off)" : ""));
  }
  const auto count = [&](std::int64_t number, const char* what) {
    if (number > 0) {
      out.push_back(fmt::format("{} {}", number, what));
    }
  };
  count(survey.scan.doubtful, "events whose data may be cut off");
  count(survey.numbers_missing, "event numbers missing");
  count(survey.number_restarts, "decreases of the event number");
  if (survey.times_backward > 0) {
    out.push_back(fmt::format("{} events are earlier than the event before them, by up to {:.6f} s",
                              survey.times_backward, to_seconds(survey.backward_max)));
  }
  count(survey.times_outlying,
        "events are more than a day away from all others; durations leave them out");
  for (const auto& [raw_name, channel] : survey.channels) {
    const std::string name = readable(raw_name);
    if (channel.messages_lost > 0) {
      out.push_back(
          fmt::format("{}: {} messages lost before they were logged", name, channel.messages_lost));
    }
    if (channel.has_two_publishers) {
      out.push_back(name + ": two processes published at the same time");
    }
    if (channel.other_types > 0) {
      out.push_back(
          channel.type.empty()
              ? fmt::format("{}: {} of {} events have types of vantage, the others have "
                            "types unknown to this version",
                            name, channel.other_types, channel.events)
              : fmt::format("{}: {} of {} events are not of type {}, the type of the first event",
                            name, channel.other_types, channel.events, channel.type));
    }
  }
  if (survey.scan.events > 0 && !survey.begins_with_scenario) {
    out.emplace_back("the first event is not SCENARIO");
  }
  return out;
}

nlohmann::ordered_json to_json(const std::string& path, const logs::LogSurvey& survey) {
  nlohmann::ordered_json stretches = nlohmann::ordered_json::array();
  for (const logs::DamagedStretch& stretch : survey.stretches) {
    stretches.push_back(
        {{"offset", stretch.offset}, {"bytes", stretch.size_bytes}, {"is_tail", stretch.is_tail}});
  }
  nlohmann::ordered_json channels = nlohmann::ordered_json::object();
  for (const auto& [name, channel] : survey.channels) {
    channels[readable(name)] = {{"type", channel.type},
                                {"events", channel.events},
                                {"bytes", channel.data_bytes},
                                {"rate_hz", rate_hz(channel)},
                                {"first_s", since_start_s(survey, channel.first)},
                                {"last_s", since_start_s(survey, channel.last)},
                                {"gap_max_s", to_seconds(channel.gap_max)},
                                {"gap_at_s", since_start_s(survey, channel.gap_at)},
                                {"messages_lost", channel.messages_lost},
                                {"other_types", channel.other_types},
                                {"two_publishers", channel.has_two_publishers}};
  }
  return {{"log", path},
          {"bytes", survey.size_bytes},
          {"events", survey.scan.events},
          {"begin_utime", to_utime(survey.begin)},
          {"end_utime", to_utime(survey.end)},
          {"duration_s", survey.duration_s()},
          {"is_whole", survey.is_whole()},
          {"events_doubtful", survey.scan.doubtful},
          {"damaged_stretches", survey.scan.stretches},
          {"bytes_damaged", survey.scan.bytes_damaged},
          {"stretches", std::move(stretches)},
          {"numbers_missing", survey.numbers_missing},
          {"number_restarts", survey.number_restarts},
          {"times_backward", survey.times_backward},
          {"times_outlying", survey.times_outlying},
          {"begins_with_scenario", survey.begins_with_scenario},
          {"channels", std::move(channels)}};
}

}  // namespace vantage::tools
