#pragma once

#include <cstdint>
#include <vector>

#include "scenario/mocap_spec.hpp"
#include "wire/vicon/bytes.hpp"

namespace vantage::test {

/// Lets a driver hear `input` as what a server sends, cut into pieces as its first byte says, and
/// ends the program by abort() when a promise is broken: something not finite or not named is
/// published, or memory grows.
void fuzz_client(scenario::MocapProtocol protocol, wire::vicon::Bytes input);

/// Lets the emulated server hear `input` as what a client sends. Not for object streams, which have
/// no clients.
void fuzz_server(scenario::MocapProtocol protocol, wire::vicon::Bytes input);

/// What a good server sends over a few frames, first byte included: something to start from.
std::vector<std::vector<std::uint8_t>> server_samples(scenario::MocapProtocol protocol);
/// What a good client sends.
std::vector<std::vector<std::uint8_t>> client_samples(scenario::MocapProtocol protocol);

}  // namespace vantage::test
