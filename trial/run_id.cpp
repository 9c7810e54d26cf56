#include "trial/recipe.hpp"

namespace vantage::trial {

// Computes FNV-1a over the bytes of seed and name, then applies the finaliser of SplitMix64,
// because FNV-1a alone gives similar hashes for similar names.
std::int64_t deterministic_run_id(std::uint64_t seed, const std::string& node_name) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  const auto mix = [&hash](std::uint64_t byte) { hash = (hash ^ byte) * 0x100000001b3ULL; };
  for (unsigned shift = 0; shift < 64; shift += 8) {
    mix((seed >> shift) & 0xffU);
  }
  for (const char c : node_name) {
    mix(static_cast<unsigned char>(c));
  }
  hash = (hash ^ (hash >> 30U)) * 0xbf58476d1ce4e5b9ULL;
  hash = (hash ^ (hash >> 27U)) * 0x94d049bb133111ebULL;
  hash ^= hash >> 31U;
  const auto positive = static_cast<std::int64_t>(hash >> 1U);
  return positive == 0 ? 1 : positive;
}

}  // namespace vantage::trial
