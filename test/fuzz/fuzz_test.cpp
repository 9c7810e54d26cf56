// Runs every harness on its initial inputs, on inputs that once broke it (test/fuzz/corpus), and on
// mutations of both. VANTAGE_FUZZ_RUNS is the number of mutations (default 300), VANTAGE_FUZZ_SEED
// the seed of their random numbers.

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <random>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "test/fuzz/bus/compact_path.hpp"
#include "test/fuzz/bus/datagram_input.hpp"
#include "test/fuzz/bus/packet_path.hpp"
#include "test/fuzz/bus/receive_path.hpp"
#include "test/fuzz/parsers/mocap_parsers.hpp"
#include "test/fuzz/parsers/stream_parsers.hpp"
#include "test/fuzz/parsers/text_parsers.hpp"
#include "test/fuzz/vicon/harness.hpp"
#include "test/support/resident_memory.hpp"

namespace vantage::test {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::uint8_t>;
using scenario::MocapProtocol;

struct Harness {
  const char* name = "";
  std::function<void(std::span<const std::uint8_t>)> run;
  std::function<std::vector<Bytes>()> samples;
  /// Returns the number of datagrams in an input.
  std::function<std::int64_t(std::span<const std::uint8_t>)> datagrams = nullptr;
};

std::int64_t datagrams_of(std::span<const std::uint8_t> input) {
  std::int64_t count = 0;
  while (take_datagram(input)) {
    ++count;
  }
  return count;
}

std::vector<Bytes> files_of(const fs::path& folder, const std::string& extension) {
  std::vector<fs::path> paths;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(folder, none)) {
    if (extension.empty() || entry.path().extension() == extension) {
      paths.push_back(entry.path());
    }
  }
  std::sort(paths.begin(), paths.end());
  std::vector<Bytes> out;
  for (const fs::path& path : paths) {
    std::ifstream file(path, std::ios::binary);
    out.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  }
  return out;
}

std::vector<Harness> harnesses() {
  const fs::path source = VANTAGE_SOURCE_DIR;
  const auto vicon = [](MocapProtocol protocol) {
    return std::pair{[protocol](std::span<const std::uint8_t> in) { fuzz_client(protocol, in); },
                     [protocol] { return server_samples(protocol); }};
  };
  const auto datastream = vicon(MocapProtocol::kDataStream);
  const auto objects = vicon(MocapProtocol::kObjectStream);
  const auto vrpn = vicon(MocapProtocol::kVrpn);
  return {
      {"packet", fuzz_packet_path, packet_path_samples, datagrams_of},
      {"compact", fuzz_compact_path, compact_path_samples},
      {"receive", fuzz_receive_path, receive_path_samples, datagrams_of},
      {"mavlink", fuzz_mavlink, mavlink_samples},
      {"crtp", fuzz_crtp, crtp_samples},
      {"log", fuzz_log, log_samples},
      {"viewer", fuzz_viewer, viewer_samples},
      {"datastream", datastream.first, datastream.second},
      {"object_stream", objects.first, objects.second},
      {"vrpn", vrpn.first, vrpn.second},
      {"natnet", fuzz_natnet, natnet_samples},
      {"qtm", fuzz_qtm, qtm_samples},
      {"scenario", fuzz_scenario, [=] { return files_of(source / "config", ".yaml"); }},
      {"problem", fuzz_problem, [=] { return files_of(source / "test/tools/problems", ".json"); }}};
}

/// Returns `bytes` with a few bits, bytes or pieces changed, removed, duplicated or taken from
/// `other`.
Bytes changed(Bytes bytes, const Bytes& other, std::mt19937_64& rng) {
  for (auto times = 1 + rng() % 4; times > 0; --times) {
    const std::size_t size = bytes.size();
    const auto at = static_cast<std::ptrdiff_t>(size == 0 ? 0 : rng() % size);
    const auto length = static_cast<std::ptrdiff_t>(
        std::min<std::uint64_t>(rng() % 16, size - static_cast<std::size_t>(at)));
    const auto from = bytes.begin() + at;
    switch (size == 0 ? 4 : rng() % 6) {
      case 0:
        *from ^= static_cast<std::uint8_t>(1U << (rng() % 8));
        break;
      case 1:
        *from = static_cast<std::uint8_t>(std::array{0, 1, 127, 128, 255}[rng() % 5]);
        break;
      case 2:
        bytes.erase(from, from + length);
        break;
      case 3: {
        const Bytes piece(from, from + length);
        bytes.insert(bytes.begin() + at, piece.begin(), piece.end());
        break;
      }
      case 4: {
        const std::size_t begin = other.empty() ? 0 : rng() % other.size();
        const std::size_t count = std::min<std::size_t>(rng() % 200, other.size() - begin);
        const auto first = other.begin() + static_cast<std::ptrdiff_t>(begin);
        bytes.insert(bytes.begin() + at, first, first + static_cast<std::ptrdiff_t>(count));
        break;
      }
      default:
        bytes.resize(static_cast<std::size_t>(at));
    }
  }
  return bytes;
}

/// Returns the number in the environment variable, or `usual` if it is not set.
long long number_or(const char* variable, long long usual) {
  const char* const text = std::getenv(variable);
  return text == nullptr ? usual : std::atoll(text);
}

/// The progress of the runs, printed after every tenth of them if VANTAGE_FUZZ_RUNS is set.
class Progress {
 public:
  Progress(const Harness& harness, long long runs) : harness_(harness), runs_(runs) {}

  void count(const Bytes& input) {
    ++done_;
    datagrams_ += harness_.datagrams ? harness_.datagrams(input) : 0;
    if (done_ == runs_ / kParts) {
      settled_kib_ = resident_kib();
    }
    if (done_ % std::max(1LL, runs_ / kParts) == 0 && std::getenv("VANTAGE_FUZZ_RUNS") != nullptr) {
      print();
    }
  }

  /// Returns the growth of resident memory after the first tenth of the runs, KiB.
  [[nodiscard]] std::int64_t growth_kib() const { return resident_kib() - settled_kib_; }

 private:
  static constexpr long long kParts = 10;

  void print() const {
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin_;
    std::printf("%s: %lld inputs in %.1f s, %.0f a second", harness_.name, done_, took.count(),
                static_cast<double>(done_) / took.count());
    if (harness_.datagrams) {
      std::printf("; %lld datagrams", static_cast<long long>(datagrams_));
    }
    std::printf("; %lld KiB resident\n", static_cast<long long>(resident_kib()));
    std::fflush(stdout);
  }

  const Harness& harness_;
  long long runs_;
  long long done_ = 0;
  std::int64_t datagrams_ = 0;
  std::int64_t settled_kib_ = 0;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

class FuzzTarget : public ::testing::TestWithParam<Harness> {};

TEST_P(FuzzTarget, StaysWithinItsLimitsForAnyInput) {
  constexpr long long kManyRuns = 100'000;  // the heap stops growing after a tenth of these
  constexpr std::int64_t kGrowthMaxKib = 1'024;
  const long long runs = number_or("VANTAGE_FUZZ_RUNS", 300);
  std::vector<Bytes> inputs = GetParam().samples();
  ASSERT_FALSE(inputs.empty());
  const fs::path corpus = fs::path(VANTAGE_SOURCE_DIR) / "test/fuzz/corpus" / GetParam().name;
  const std::vector<Bytes> kept = files_of(corpus, "");
  inputs.insert(inputs.end(), kept.begin(), kept.end());
  for (const Bytes& input : inputs) {
    GetParam().run(input);
  }
  std::mt19937_64 rng(static_cast<std::uint64_t>(number_or("VANTAGE_FUZZ_SEED", 20)));
  Progress progress(GetParam(), runs);
  for (long long i = 0; i < runs; ++i) {
    const Bytes& one = inputs[rng() % inputs.size()];
    const Bytes& other = inputs[rng() % inputs.size()];
    const Bytes input = changed(one, other, rng);
    GetParam().run(input);
    progress.count(input);
  }
  if (runs >= kManyRuns && !kKeepsFreedMemory) {
    EXPECT_LT(progress.growth_kib(), kGrowthMaxKib);
  }
}

INSTANTIATE_TEST_SUITE_P(Harnesses, FuzzTarget, ::testing::ValuesIn(harnesses()),
                         [](const auto& of) { return std::string(of.param.name); });

}  // namespace
}  // namespace vantage::test
