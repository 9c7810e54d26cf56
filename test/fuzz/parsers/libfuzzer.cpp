// Entry point of libFuzzer; VANTAGE_FUZZ_TARGET is one of the functions of
// stream_parsers.hpp and mocap_parsers.hpp.

#include "test/fuzz/parsers/mocap_parsers.hpp"
#include "test/fuzz/parsers/stream_parsers.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  vantage::test::VANTAGE_FUZZ_TARGET({bytes, size});
  return 0;
}
