// Measures how long `log play` takes to seek an instant in a log of many gigabytes:
//   seek_bench LOG GIB SEEKS     e.g. seek_bench /tmp/big.lcmlog 10 200
// Creates LOG if it does not exist (random bytes of unknown and known types), and indexes LOG if it
// has no index. Then reopens LOG and seeks, once with the present page cache and once after the
// kernel has dropped the cache. Prints ms.

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "bus/convert/convert.hpp"
#include "core/deadline.hpp"
#include "logs/file/log_index.hpp"

namespace {

using namespace vantage;

double ms_since(std::int64_t begin_ns) {
  return 1e-6 * static_cast<double>(monotonic_ns() - begin_ns);
}

/// Writes 1000 events per second: VICON frames of `bodies`; every tenth event is an unknown type of
/// 20 kB.
void make_log(const std::string& path, double gib) {
  constexpr std::int64_t kStart_us = 1'700'000'000'000'000;
  constexpr std::size_t kOtherBytes = 20'000;
  constexpr std::size_t kBufferBytes = std::size_t{16} << 20U;
  constexpr int kBodies = 8;
  vantage_lcm::mocap_frame_t frame{};
  frame.num_bodies = kBodies;
  frame.bodies.resize(kBodies);
  for (auto& body : frame.bodies) {
    body.name = "ROBOT";
  }
  std::mt19937_64 rng(1);
  const int fd = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL, 0644);
  std::vector<std::uint8_t> buffer;
  std::vector<std::uint8_t> other(kOtherBytes);
  std::int64_t number = 0;
  for (double written = 0.0; fd >= 0 && written < gib * 1024 * 1024 * 1024;) {
    const Time time = from_utime(kStart_us + number * 1000);
    if (number % 10 == 9) {
      std::generate(other.begin(), other.end(), [&] { return static_cast<std::uint8_t>(rng()); });
      logs::append_event({number, time, "CAMERA", other}, buffer);
    } else {
      frame.utime = to_utime(time);
      frame.sequence = number;
      std::vector<std::uint8_t> data(static_cast<std::size_t>(frame.getEncodedSize()));
      frame.encode(data.data(), 0, static_cast<int>(data.size()));
      logs::append_event({number, time, "VICON", data}, buffer);
    }
    ++number;
    if (buffer.size() > kBufferBytes) {
      written += static_cast<double>(buffer.size());
      if (::write(fd, buffer.data(), buffer.size()) != std::ssize(buffer)) {
        break;
      }
      buffer.clear();
    }
  }
  ::fsync(fd);
  ::close(fd);
}

void forget_pages(const std::string& path) {
  const int fd = ::open(path.c_str(), O_RDONLY);
  ::posix_fadvise(fd, 0, 0, POSIX_FADV_DONTNEED);
  ::close(fd);
}

void measure(const std::string& path, int seeks, bool forgets) {
  if (forgets) {
    forget_pages(path);
  }
  const std::int64_t opening = monotonic_ns();
  const logs::IndexedLog log(path);
  const double opening_ms = ms_since(opening);
  std::mt19937_64 rng(7);
  std::vector<double> took_ms;
  for (int i = 0; i < seeks; ++i) {
    const double at_s = std::uniform_real_distribution(0.0, log.survey().duration_s())(rng);
    if (forgets) {
      forget_pages(path);
    }
    const std::int64_t begin = monotonic_ns();
    logs::LogScan scan = log.scan_from(log.survey().first + from_seconds(at_s));
    if (!scan.next()) {
      fmt::print("nothing at {} s\n", at_s);
    }
    took_ms.push_back(ms_since(begin));
  }
  std::sort(took_ms.begin(), took_ms.end());
  const auto quantile = [&](double q) {
    return took_ms[static_cast<std::size_t>(q * static_cast<double>(took_ms.size() - 1))];
  };
  fmt::print("| {} | {:.1f} | {:.2f} | {:.2f} | {:.2f} | {} of {} |\n",
             forgets ? "forgotten" : "as they are", opening_ms, quantile(0.5), quantile(0.95),
             quantile(1.0),
             std::count_if(took_ms.begin(), took_ms.end(), [](double each) { return each > 50.0; }),
             seeks);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 4) {
    fmt::print(stderr, "seek_bench LOG GIB SEEKS\n");
    return 2;
  }
  const std::string path = argv[1];
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  if (!std::filesystem::exists(path)) {
    make_log(path, std::atof(argv[2]));
  }
  const std::int64_t begin = monotonic_ns();
  const logs::IndexedLog log(path);
  fmt::print("{:.2f} GiB, {} events; {} in {:.1f} s\n",
             static_cast<double>(log.bytes().size()) / (1024.0 * 1024.0 * 1024.0),
             log.survey().scan.events, log.was_indexed() ? "index read" : "first pass",
             1e-3 * ms_since(begin));
  fmt::print(
      "| pages | opened in ms | seek p50 | p95 | worst | over 50 ms "
      "|\n|---|---|---|---|---|---|\n");
  for (int run = 0; run < 3; ++run) {
    measure(path, std::atoi(argv[3]), false);
    measure(path, std::atoi(argv[3]), true);
  }
}
