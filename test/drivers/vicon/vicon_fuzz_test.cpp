#include <algorithm>
#include <array>
#include <cstdlib>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "test/fuzz/vicon/harness.hpp"
#include "test/support/random.hpp"

// Seeded mutations of valid conversations with a mocap server. The harness aborts on a violated
// invariant; with AddressSanitizer it also finds out-of-bounds accesses.

namespace vantage::test {
namespace {

using scenario::MocapProtocol;
using Sample = std::vector<std::uint8_t>;

/// Returns the number of inputs. VANTAGE_FUZZ_INPUTS increases it, for example for a run overnight.
int inputs() {
  const char* wanted = std::getenv("VANTAGE_FUZZ_INPUTS");
  return wanted != nullptr ? std::atoi(wanted) : 100'000;
}

constexpr std::array<std::uint32_t, 8> kBoundaryValues{
    0, 1, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF, 0xFFFFFFFE, 0x40000000, 0x00010000};

std::size_t place_in(const Sample& sample, Random& random) {
  return static_cast<std::size_t>(random.integer(0, static_cast<int>(sample.size()) - 1));
}

void mutate(Sample& sample, const std::vector<Sample>& samples, Random& random) {
  const std::size_t at = place_in(sample, random);
  const auto here = sample.begin() + static_cast<std::ptrdiff_t>(at);
  switch (random.integer(0, 6)) {
    case 0:
      sample[at] = static_cast<std::uint8_t>(sample[at] ^ (1U << random.integer(0, 7)));
      break;
    case 1:
      sample[at] = static_cast<std::uint8_t>(random.integer(0, 255));
      break;
    case 2: {  // a count or length in either byte order
      const std::uint32_t number = kBoundaryValues[static_cast<std::size_t>(random.integer(0, 7))];
      const bool is_big = random.coin();
      for (std::size_t i = 0; i < 4 && at + i < sample.size(); ++i) {
        sample[at + i] = static_cast<std::uint8_t>(number >> (8U * (is_big ? 3 - i : i)));
      }
      break;
    }
    case 3:
      sample.resize(at + 1);
      break;
    case 4:
      sample.erase(here, std::min(here + random.integer(1, 8), sample.end()));
      break;
    case 5:
      sample.insert(here, static_cast<std::size_t>(random.integer(1, 8)),
                    static_cast<std::uint8_t>(random.integer(0, 255)));
      break;
    default: {
      const Sample& other = samples[static_cast<std::size_t>(
          random.integer(0, static_cast<int>(samples.size()) - 1))];
      const std::size_t from = place_in(other, random);
      sample.insert(here, other.begin() + static_cast<std::ptrdiff_t>(from), other.end());
      sample.resize(std::min<std::size_t>(sample.size(), 8192));
      break;
    }
  }
  if (sample.empty()) {
    sample.push_back(0);
  }
}

template <class Fuzz>
void run(MocapProtocol protocol, const std::vector<Sample>& samples, const Fuzz& fuzz) {
  const auto all = scenario::all_mocap_protocols();
  Random random(20 + static_cast<std::uint64_t>(std::ranges::find(all, protocol) - all.begin()));
  const int count = inputs();
  for (int i = 0; i < count; ++i) {
    Sample input = samples[static_cast<std::size_t>(i) % samples.size()];
    for (int k = random.integer(1, 4); k > 0; --k) {
      mutate(input, samples, random);
    }
    fuzz(protocol, wire::vicon::Bytes(input));
  }
}

class ViconFuzz : public ::testing::TestWithParam<MocapProtocol> {};

TEST_P(ViconFuzz, DriverKeepsItsInvariants) {
  run(GetParam(), server_samples(GetParam()), fuzz_client);
}

class ViconServerFuzz : public ::testing::TestWithParam<MocapProtocol> {};

TEST_P(ViconServerFuzz, KeepsItsInvariants) {
  run(GetParam(), client_samples(GetParam()), fuzz_server);
}

std::string name_of(const ::testing::TestParamInfo<MocapProtocol>& protocol) {
  return protocol.param.name();
}

INSTANTIATE_TEST_SUITE_P(Protocols, ViconFuzz,
                         testing::Values(MocapProtocol::kDataStream, MocapProtocol::kObjectStream,
                                         MocapProtocol::kVrpn, MocapProtocol::kNatNet,
                                         MocapProtocol::kQtm),
                         name_of);
INSTANTIATE_TEST_SUITE_P(Protocols, ViconServerFuzz,
                         testing::Values(MocapProtocol::kDataStream, MocapProtocol::kVrpn,
                                         MocapProtocol::kNatNet, MocapProtocol::kQtm),
                         name_of);

}  // namespace
}  // namespace vantage::test
