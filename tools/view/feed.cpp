#include "tools/view/feed.hpp"

namespace vantage::tools {

template <class Message>
void Feed::listen(const bus::Channel<Message>& channel) {
  bus_.subscribe<Message>(channel,
                          [this](const Message& message) { stream_.on(message, clock_.now()); });
}

Feed::Feed(bus::Transport& transport, const bus::Clock& clock, logs::foxglove::Sink& sink)
    : clock_(clock), stream_(sink), bus_(transport, bus::random_run_id()) {
  listen(bus::kScenario);
  listen(bus::kVicon);
  listen(bus::kTruth);
  listen(bus::measurement_channel("*"));
  listen(bus::belief_channel("*"));
  listen(bus::plan_channel("*"));
  listen(bus::team_proposal_channel("*"));
  listen(bus::quadrotor_channel("*"));
  listen(bus::health_channel("*"));
  listen(bus::host_channel("*"));
  listen(bus::kCollision);
  listen(bus::kAttack);
  listen(bus::kCommand);
}

}  // namespace vantage::tools
