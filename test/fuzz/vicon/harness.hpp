#pragma once

#include <cstdint>
#include <vector>

#include "scenario/mocap_spec.hpp"
#include "wire/vicon/bytes.hpp"

namespace vantage::test {

/// Passes `input` to a driver as the bytes of a server, cut into pieces according to its first
/// byte. Calls abort() if a value that is not finite or a body without a name is published, or if
/// memory grows.
void fuzz_client(scenario::MocapProtocol protocol, wire::vicon::Bytes input);

/// Passes `input` to the emulated server as the bytes of a client. Not for object streams, which
/// have no clients.
void fuzz_server(scenario::MocapProtocol protocol, wire::vicon::Bytes input);

/// Returns the initial inputs for a client: the bytes of a correct server over a few frames, after
/// the first byte that selects the size of the pieces.
std::vector<std::vector<std::uint8_t>> server_samples(scenario::MocapProtocol protocol);
/// Returns the initial inputs for a server: the bytes of a correct client.
std::vector<std::vector<std::uint8_t>> client_samples(scenario::MocapProtocol protocol);

}  // namespace vantage::test
