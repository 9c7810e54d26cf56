// Entry point of libFuzzer; VANTAGE_FUZZ_TARGET is a call of fuzz_client() or fuzz_server(),
// defined by build.sh.

#include "test/fuzz/vicon/harness.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  using vantage::scenario::MocapProtocol;
  const vantage::wire::vicon::Bytes input(bytes, size);
  VANTAGE_FUZZ_TARGET(input);
  return 0;
}
