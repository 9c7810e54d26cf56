#include "sim/random.hpp"

#include <vector>

namespace vantage::sim {

std::mt19937_64 random_stream(std::uint64_t seed, std::string_view purpose) {
  std::vector<std::uint32_t> words{static_cast<std::uint32_t>(seed),
                                   static_cast<std::uint32_t>(seed >> 32U)};
  for (const char letter : purpose) {
    words.push_back(static_cast<std::uint32_t>(static_cast<unsigned char>(letter)));
  }
  std::seed_seq sequence(words.begin(), words.end());
  return std::mt19937_64(sequence);
}

}  // namespace vantage::sim
