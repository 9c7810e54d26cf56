#include "test/fuzz/vicon/harness.hpp"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <utility>

#include "drivers/vicon/driver.hpp"
#include "sim/vicon/object_stream_server.hpp"
#include "test/drivers/vicon/vicon_bench.hpp"

namespace vantage::test {
namespace {

using scenario::MocapProtocol;
using wire::vicon::Bytes;

constexpr std::size_t kOutgoingMax = std::size_t{1} << 20U;

void promise(bool is_kept, const char* what) {
  if (!is_kept) {
    std::fprintf(stderr, "broken promise: %s\n", what);
    std::abort();
  }
}

void check(const models::MocapFrame& frame) {
  promise(frame.bodies.size() <= drivers::vicon::FrameFilter::kBodiesMax, "bodies are bounded");
  promise(frame.stamp.time <= frame.arrival, "no frame is captured after its arrival");
  for (const models::MocapBody& body : frame.bodies) {
    promise(!body.name.empty() && body.name.size() <= 128, "bodies have names");
    promise(body.world_from_body.translation_m.allFinite(), "positions are finite");
    promise(std::abs(body.world_from_body.rotation.norm() - 1.0) < 1e-9, "rotations are unit");
  }
}

scenario::MocapSpec plain_spec(MocapProtocol protocol) {
  scenario::MocapSpec spec;
  spec.protocol = protocol;
  return spec;
}

/// One driver per protocol. It reconnects for each input, since its construction costs more than
/// its use. It is replaced from time to time, because it remembers bodies.
struct Client {
  explicit Client(MocapProtocol protocol)
      : driver(plain_spec(protocol), any_session_row(protocol), check) {}
  drivers::vicon::ViconDriver driver;
  drivers::vicon::Moment now{ViconBench::kEpoch, Duration{0}};
  int inputs = 0;

  void pass(Duration time) {
    now.utime += time;
    now.steady += time;
  }
};

Client& client_of(MocapProtocol protocol) {
  static std::map<MocapProtocol, std::unique_ptr<Client>> clients;
  auto& client = clients[protocol];
  if (!client || ++client->inputs > 1000) {
    client = std::make_unique<Client>(protocol);
  }
  return *client;
}

/// Returns the size of the pieces, bytes: 1 … 64, or `size`, so that everything arrives at once.
std::size_t chunk_of(std::uint8_t first, std::size_t size) {
  return first < 128 ? std::max<std::size_t>(size, 1) : std::size_t{first} % 64 + 1;
}

/// Returns the size of the first NatNet packet of `input`, or the size of `input` if it is shorter.
std::size_t datagram_of(Bytes input) {
  const std::size_t size =
      input.size() < 4 ? input.size() : 4 + input[2] + 256 * std::size_t{input[3]};
  return std::min(size, input.size());
}

template <class Take>
void in_chunks(MocapProtocol protocol, Bytes input, const Take& take) {
  if (input.empty()) {
    return;
  }
  if (protocol.transport() == scenario::MocapTransport::kUdpRequested) {
    for (Bytes rest = input.subspan(1); !rest.empty(); rest = rest.subspan(datagram_of(rest))) {
      take(rest.first(datagram_of(rest)));
    }
    return;
  }
  const std::size_t chunk = chunk_of(input[0], input.size());
  for (std::size_t at = 1; at < input.size(); at += chunk) {
    take(input.subspan(at, std::min(chunk, input.size() - at)));
  }
}

}  // namespace

void fuzz_client(MocapProtocol protocol, Bytes input) {
  Client& client = client_of(protocol);
  drivers::vicon::ViconDriver& driver = client.driver;
  client.pass(std::chrono::seconds(3));
  driver.on_opening(client.now);
  driver.on_opened(client.now);
  in_chunks(protocol, input, [&](Bytes bytes) {
    client.pass(Duration{700});
    driver.receive(client.now, bytes);
    driver.on_time(client.now);
    promise(driver.outgoing().size() <= kOutgoingMax, "answers are bounded");
    if (protocol.transport() == scenario::MocapTransport::kUdpRequested) {
      driver.outgoing().clear();  // discards the bytes as if they had been sent
    }
  });
  client.pass(Duration{5'000});
  driver.on_time(client.now);
  driver.on_closed(client.now, "end of input");
}

void fuzz_server(MocapProtocol protocol, Bytes input) {
  sim::vicon::ServerSettings settings;
  settings.protocol = protocol;
  settings.backlog_bytes_max = std::size_t{64} << 10U;
  const std::unique_ptr<sim::vicon::Peer> peer = make_peer(settings);
  const sim::vicon::EmulatedFrame frame = circling(2, 1.0);
  bool is_talking = true;
  in_chunks(protocol, input, [&](Bytes bytes) {
    is_talking = is_talking && peer->receive(bytes);
    if (is_talking) {
      peer->on_frame(frame);
    }
    promise(peer->outgoing.size() <= kOutgoingMax, "what waits for a client is bounded");
  });
}

std::vector<std::vector<std::uint8_t>> server_samples(MocapProtocol protocol) {
  const scenario::MocapSpec spec = plain_spec(protocol);
  sim::vicon::ServerSettings settings = ViconBench::settings_for(spec);
  std::vector<std::vector<std::uint8_t>> samples;
  for (const int bodies : {0, 1, 2, 3}) {
    std::vector<std::uint8_t> sample{static_cast<std::uint8_t>(bodies == 3 ? 200 : 0)};
    if (protocol == MocapProtocol::kObjectStream) {
      sim::vicon::ObjectStreamServer server(settings);
      const auto datagram = server.encode(circling(bodies, 0.5)).front();
      sample.insert(sample.end(), datagram.begin(), datagram.end());
      samples.push_back(sample);
      continue;
    }
    drivers::vicon::ViconDriver driver(spec, any_session_row(protocol), check);
    const std::unique_ptr<sim::vicon::Peer> peer = make_peer(settings);
    drivers::vicon::Moment now{ViconBench::kEpoch, Duration{0}};
    driver.on_opening(now);
    driver.on_opened(now);
    if (protocol.transport() == scenario::MocapTransport::kUdpRequested) {
      for (int request = 0; request < 4; ++request) {  // connection, definitions, echo, keep-alive
        peer->on_frame(circling(bodies, 0.0));
        peer->outgoing.clear();
        driver.on_time(now);
        static_cast<void>(peer->receive(std::exchange(driver.outgoing(), {})));
        sample.insert(sample.end(), peer->outgoing.begin(), peer->outgoing.end());
        driver.receive(now, std::exchange(peer->outgoing, {}));
      }
    }
    for (std::uint32_t k = 0; k < 4; ++k) {
      sim::vicon::EmulatedFrame frame = circling(bodies, 0.01 * k);
      frame.number = k;
      peer->on_frame(frame);
      sample.insert(sample.end(), peer->outgoing.begin(), peer->outgoing.end());
      driver.receive(now, std::exchange(peer->outgoing, {}));
      static_cast<void>(peer->receive(std::exchange(driver.outgoing(), {})));
    }
    samples.push_back(sample);
  }
  return samples;
}

std::vector<std::vector<std::uint8_t>> client_samples(MocapProtocol protocol) {
  scenario::MocapSpec spec = plain_spec(protocol);
  std::vector<std::vector<std::uint8_t>> samples;
  for (const auto mode : {scenario::StreamMode::kPush, scenario::StreamMode::kPreFetch}) {
    spec.mode = mode;
    drivers::vicon::ViconDriver driver(spec, any_session_row(protocol), check);
    drivers::vicon::Moment now{ViconBench::kEpoch, Duration{0}};
    driver.on_opening(now);
    driver.on_opened(now);
    const std::vector<std::uint8_t> server_bytes = server_samples(protocol)[1];
    std::vector<std::uint8_t> sample{0};
    in_chunks(protocol, server_bytes, [&](Bytes bytes) {
      driver.receive(now, bytes);
      if (protocol.transport() == scenario::MocapTransport::kUdpRequested) {
        driver.on_time(now);
        sample.insert(sample.end(), driver.outgoing().begin(), driver.outgoing().end());
        driver.outgoing().clear();
      }
    });
    driver.on_time({now.utime, std::chrono::seconds(2)});
    sample.insert(sample.end(), driver.outgoing().begin(), driver.outgoing().end());
    samples.push_back(sample);
  }
  return samples;
}

}  // namespace vantage::test
