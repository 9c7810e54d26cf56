#include "trial/replay/output_comparison.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "bus/auth/trailer.hpp"
#include "logs/json/wire_json.hpp"

namespace vantage::trial {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kFingerprintBytes = 8;
/// Offset of run id and sequence number in a message, bytes: they follow fingerprint and utime.
constexpr std::size_t kOriginBegin = 16;
constexpr std::size_t kOriginEnd = 32;

/// Calls `visit` for each scalar that differs between `a` and `b`.
void for_each_difference(const Json& a, const Json& b, const std::string& path, const auto& visit) {
  if (a.type() == b.type() && a.is_object()) {
    for (const auto& [name, value] : a.items()) {
      for_each_difference(value, b.value(name, Json()), path.empty() ? name : path + "." + name,
                          visit);
    }
  } else if (a.type() == b.type() && a.is_array() && a.size() == b.size()) {
    for (std::size_t i = 0; i < a.size(); ++i) {
      for_each_difference(a[i], b[i], fmt::format("{}[{}]", path, i), visit);
    }
  } else if (a != b) {
    visit(path, a, b);
  }
}

std::string dumped(const Json& value) {
  return value.dump(-1, ' ', false, Json::error_handler_t::replace);
}

OutputDifference difference_of(std::int64_t index, const Json& logged, const Json& replayed) {
  OutputDifference out;
  out.index = index;
  out.time = from_utime(logged.at("utime").get<std::int64_t>());
  for_each_difference(logged, replayed, "",
                      [&](const std::string& path, const Json& a, const Json& b) {
                        if (path == "run_id" || path == "sequence") {
                          return;
                        }
                        if (++out.members_different == 1) {
                          out.member = path;
                          out.logged = dumped(a);
                          out.replayed = dumped(b);
                        }
                      });
  if (out.members_different == 0) {
    out.member = "(bits)";
  }
  for (const Json& input : logged.value("inputs", Json::array())) {
    out.inputs.push_back(fmt::format("{} {}/{}", input.at("channel").get<std::string>(),
                                     input.at("run_id").get<std::int64_t>(),
                                     input.at("sequence").get<std::int64_t>()));
  }
  return out;
}

}  // namespace

std::optional<OutputComparison::Key> OutputComparison::key_of(
    std::span<const std::uint8_t> message) {
  const auto json = logs::message_json(message);
  for (const char* name : {"round", "step"}) {
    if (!json || !json->contains(name)) {
      continue;
    }
    Key key;
    for (std::size_t i = 0; i < kFingerprintBytes; ++i) {
      key.type = key.type << 8U | message[i];
    }
    key.index = json->at(name).get<std::int64_t>();
    if (const auto history = json->find("history"); history != json->end() && !history->empty()) {
      key.solution = history->back().get<std::int64_t>();
    }
    return key;
  }
  return std::nullopt;
}

void OutputComparison::add_logged(std::span<const std::uint8_t> signed_message) {
  const auto message = bus::auth::payload_of(signed_message);
  const auto key = key_of(message);
  if (!key) {
    ++unreadable_;
    return;
  }
  ++logged_count_;
  logged_[*key] = Bytes(message.begin(), message.end());
}

bool OutputComparison::has_logged(std::span<const std::uint8_t> signed_message) const {
  const auto key = key_of(bus::auth::payload_of(signed_message));
  return key && logged_.contains(*key);
}

void OutputComparison::add_replayed(std::span<const std::uint8_t> signed_message) {
  const auto message = bus::auth::payload_of(signed_message);
  const auto key = key_of(message);
  if (!key) {
    ++unreadable_;
    return;
  }
  ++replayed_;
  const auto found = logged_.find(*key);
  if (found == logged_.end()) {
    ++unexpected_;
    return;
  }
  const Bytes& logged = found->second;
  const auto same = [&](std::size_t begin, std::size_t end) {
    return std::equal(logged.begin() + static_cast<std::ptrdiff_t>(begin),
                      logged.begin() + static_cast<std::ptrdiff_t>(end),
                      message.begin() + static_cast<std::ptrdiff_t>(begin));
  };
  if (logged.size() == message.size() && same(0, kOriginBegin) && same(kOriginEnd, logged.size())) {
    return;
  }
  ++different_;
  if (!first_ || key->index < first_->index) {
    first_ = difference_of(key->index, *logs::message_json(logged), *logs::message_json(message));
  }
}

std::vector<std::string> describe(const OutputDifference& difference) {
  std::vector<std::string> out;
  out.push_back(fmt::format("first difference: number {}, valid at {} µs, {} fields differ",
                            difference.index, to_utime(difference.time),
                            difference.members_different));
  out.push_back(fmt::format("  {}", difference.member));
  out.push_back(fmt::format("    logged    {}", difference.logged));
  out.push_back(fmt::format("    replayed  {}", difference.replayed));
  out.emplace_back("  inputs of this output");
  for (const std::string& input : difference.inputs) {
    out.push_back("    " + input);
  }
  return out;
}

}  // namespace vantage::trial
