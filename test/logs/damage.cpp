#include "test/logs/damage.hpp"

#include <algorithm>
#include <string>

#include "logs/file/log_event.hpp"

namespace vantage::logs::test {
namespace {

using Rng = std::mt19937_64;
using Bytes = std::vector<std::uint8_t>;

constexpr std::size_t kSyncBytes = 4;
constexpr std::size_t kSectorBytes = 512;
constexpr std::size_t kPageBytes = 4096;
constexpr std::int64_t kStart = 1'700'000'000'000'000;

std::size_t upto(Rng& rng, std::size_t most) {
  return std::uniform_int_distribution<std::size_t>(0, most)(rng);
}

Bytes junk(Rng& rng, std::size_t size) {
  Bytes out(size);
  std::generate(out.begin(), out.end(), [&] { return static_cast<std::uint8_t>(rng()); });
  return out;
}

void append(Bytes& to, const Bytes& what) { to.insert(to.end(), what.begin(), what.end()); }

/// Returns message data that may contain pieces of logs.
Bytes data_with_traps(Rng& rng) {
  Bytes out = junk(rng, upto(rng, 100));
  switch (upto(rng, 9)) {
    case 0:
      append(out, {0xED, 0xA1, 0xDA, 0x01});
      append(out, junk(rng, upto(rng, 60)));
      break;
    case 1: {  // a header that states more data than follow
      const std::string channel = "INNER";
      const Bytes data = junk(rng, 300);
      Bytes event;
      append_event({std::int64_t{1} << 40, from_utime(1), channel, data}, event);
      event.resize(60);
      append(out, event);
      break;
    }
    case 2:  // a complete log of three events
      for (std::int64_t i = 0; i < 3; ++i) {
        const std::string channel = "INNER";
        const Bytes data = junk(rng, upto(rng, 40));
        append_event({(std::int64_t{1} << 40) + i, from_utime(1 + i), channel, data}, out);
      }
      break;
    default:
      break;
  }
  return out;
}

/// A byte and its offset in the made log; kNew if the byte was not in that log.
struct Traced {
  static constexpr std::size_t kNew = ~std::size_t{0};
  std::uint8_t value = 0;
  std::size_t origin = kNew;
};

void set(Traced& byte, std::uint8_t value) {
  byte.origin = value == byte.value ? byte.origin : Traced::kNew;
  byte.value = value;
}

void write_length(std::vector<Traced>& bytes, std::size_t at, std::size_t length) {
  for (std::size_t i = 0; i < 4 && at + i < bytes.size(); ++i) {
    set(bytes[at + i], static_cast<std::uint8_t>(length >> (8 * (3 - i))));
  }
}

/// Writes a wrong data length into the header of a random event of the made log, at the header's
/// present position.
void lie(const MadeLog& log, std::vector<Traced>& bytes, Rng& rng) {
  const std::size_t events = log.begins.size() - 1;
  const std::size_t event = upto(rng, events - 1);
  const auto here = std::find_if(bytes.begin(), bytes.end(), [&](const Traced& byte) {
    return byte.origin == log.begins[event];
  });
  if (here == bytes.end()) {
    return;
  }
  const std::size_t size = log.begins[event + 1] - log.begins[event];
  const std::size_t later = event + 1 + upto(rng, std::min<std::size_t>(5, events - event - 1));
  const std::size_t name_bytes = read_big_endian(&log.bytes[log.begins[event] + 20], 4);
  const std::size_t most = log.begins[later] - log.begins[event] - kEventHeaderBytes - name_bytes;
  std::size_t length = 0;
  switch (upto(rng, 3)) {
    case 0:
      length = most;
      break;  // the event seems to end where a later one starts
    case 1:
      length = upto(rng, size + 400);
      break;
    case 2:
      length = rng();
      break;
    default:
      length = 0xFFFFFFFFU - upto(rng, 50);
      break;
  }
  write_length(bytes, static_cast<std::size_t>(here - bytes.begin()) + 24, length);
}

void accident(const MadeLog& log, std::vector<Traced>& bytes, Rng& rng) {
  const std::size_t at = upto(rng, bytes.size() - 1);
  const std::size_t size = std::min(bytes.size() - at, upto(rng, 300));
  const auto from = bytes.begin() + static_cast<std::ptrdiff_t>(at);
  const auto to = from + static_cast<std::ptrdiff_t>(size);
  switch (upto(rng, 8)) {
    case 0:
      set(bytes[at], static_cast<std::uint8_t>(bytes[at].value ^ (1U << upto(rng, 7))));
      break;
    case 1:
      std::for_each(from, to, [&](Traced& byte) { set(byte, static_cast<std::uint8_t>(rng())); });
      break;
    case 2:
      std::for_each(from, to, [](Traced& byte) { set(byte, 0); });
      break;
    case 3:
      bytes.erase(from, to);
      break;
    case 4: {
      const Bytes added = junk(rng, size);
      std::vector<Traced> traced;
      std::transform(added.begin(), added.end(), std::back_inserter(traced),
                     [](std::uint8_t value) {
                       return Traced{value, Traced::kNew};
                     });
      bytes.insert(from, traced.begin(), traced.end());
      break;
    }
    case 5:
      bytes.resize(bytes.size() - std::min(bytes.size() - 1, size));
      break;
    case 6: {
      const std::vector<Traced> twice(from, to);
      bytes.insert(to, twice.begin(), twice.end());
      break;
    }
    case 7: {
      const std::size_t block = bytes.size() > 16 * kPageBytes ? kPageBytes : kSectorBytes;
      const std::size_t begin = at / block * block;
      const std::size_t end = std::min(bytes.size(), begin + block);
      std::for_each(bytes.begin() + static_cast<std::ptrdiff_t>(begin),
                    bytes.begin() + static_cast<std::ptrdiff_t>(end),
                    [](Traced& byte) { set(byte, 0); });
      break;
    }
    default:
      lie(log, bytes, rng);
      break;
  }
}

}  // namespace

MadeLog random_log(Rng& rng, int events) {
  MadeLog log;
  std::int64_t number = static_cast<std::int64_t>(upto(rng, 1'000'000));
  std::int64_t utime = kStart;
  for (int i = 0; i < events; ++i) {
    log.begins.push_back(log.bytes.size());
    const std::string channel = "CHANNEL_" + std::to_string(upto(rng, 12));
    const Bytes data = data_with_traps(rng);
    append_event(
        {number++, from_utime(utime += static_cast<std::int64_t>(upto(rng, 5000))), channel, data},
        log.bytes);
  }
  log.begins.push_back(log.bytes.size());
  return log;
}

DamagedLog damage(const MadeLog& log, Rng& rng) {
  std::vector<Traced> bytes(log.bytes.size());
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] = {log.bytes[i], i};
  }
  for (std::size_t n = 1 + upto(rng, 5); n > 0 && !bytes.empty(); --n) {
    accident(log, bytes, rng);
  }
  DamagedLog out;
  const auto stands = [&](std::size_t at, std::size_t origin, std::size_t size) {
    bool is_intact = at + size <= bytes.size();
    for (std::size_t i = 0; is_intact && i < size; ++i) {
      is_intact = bytes[at + i].origin == origin + i;
    }
    return is_intact;
  };
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    const std::size_t origin = bytes[at].origin;
    out.bytes.push_back(bytes[at].value);
    const bool was_sync = origin != Traced::kNew && origin + kSyncBytes <= log.bytes.size() &&
                          read_big_endian(&log.bytes[origin], kSyncBytes) == kSyncWord;
    if (was_sync && stands(at, origin, kSyncBytes)) {
      out.headers.insert(at);
    }
    const auto event = std::lower_bound(log.begins.begin(), log.begins.end(), bytes[at].origin);
    if (event == log.begins.end() || *event != bytes[at].origin || event + 1 == log.begins.end()) {
      continue;
    }
    const std::size_t size = *(event + 1) - *event;
    if (stands(at, *event, size)) {
      out.intact.emplace(at, size);
    }
  }
  return out;
}

}  // namespace vantage::logs::test
