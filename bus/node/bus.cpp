#include "bus/node/bus.hpp"

#include <algorithm>
#include <limits>
#include <random>
#include <utility>

#include "bus/auth/authenticator.hpp"
#include "bus/node/air_budget.hpp"
#include "bus/node/command_claim.hpp"
#include "core/deadline.hpp"
#include "models/exchange/counts.hpp"

namespace vantage::bus {
namespace {

/// Maximum number of channels that are counted separately, so that invented names cannot exhaust
/// memory. Further channels share one entry.
constexpr std::size_t kCountedChannelsMax = 1024;
constexpr const char* kOtherChannels = "(other)";

/// Maximum number of streams reported individually. If there are more, one sum per kind ("PLAN_*")
/// is reported, so that the report does not grow with the team.
constexpr std::size_t kNamedStreamsMax = 256;

std::map<std::string, StreamCounts> reported(std::map<std::string, StreamCounts> streams) {
  if (streams.size() <= kNamedStreamsMax) {
    return streams;
  }
  std::map<std::string, StreamCounts> kinds;
  for (const auto& [name, stream] : streams) {
    const std::size_t stem = name.rfind('_');
    StreamCounts& sum = kinds[stem == std::string::npos ? name : name.substr(0, stem + 1) + "*"];
    sum.fresh += stream.fresh;
    sum.lost += stream.lost;
    sum.duplicates += stream.duplicates;
    sum.reordered += stream.reordered;
    sum.old_runs += stream.old_runs;
    sum.too_far_ahead += stream.too_far_ahead;
    sum.runs += std::max<std::int64_t>(0, stream.runs - 1);
  }
  for (auto& [name, sum] : kinds) {
    ++sum.runs;  // "runs" of the sum: number of restarts plus 1
  }
  return kinds;
}

}  // namespace

std::int64_t random_run_id() {
  std::random_device entropy;
  std::uniform_int_distribution<std::int64_t> any(1);
  return any(entropy);
}

Bus::Bus(Transport& transport, std::int64_t run_id, std::string publish_prefix)
    : transport_(transport),
      run_id_(run_id),
      publish_prefix_(std::move(publish_prefix)),
      self_(std::make_shared<Bus*>(this)) {}

Bus::~Bus() = default;

void Bus::secure(std::unique_ptr<auth::Authenticator> authenticator, const Clock& clock) {
  authenticator_ = std::move(authenticator);
  signing_clock_ = &clock;
  if (authenticator_ && !authenticator_->is_replay()) {
    use_clock(clock);
  }
  if (authenticator_ && !vehicle_.empty()) {
    authenticator_->act_as_vehicle(vehicle_);
  }
}

void Bus::limit_air(std::unique_ptr<AirBudget> budget, const Clock& clock) {
  air_ = std::move(budget);
  air_clock_ = &clock;
}

std::size_t Bus::air_left(const std::string& channel) const {
  return air_ ? air_->payload_left(channel, air_clock_->now())
              : std::numeric_limits<std::size_t>::max();
}

void Bus::act_as_vehicle(const std::string& robot) {
  vehicle_ = robot;
  if (authenticator_) {
    authenticator_->act_as_vehicle(robot);
  }
}

bool Bus::renew_session() {
  if (authenticator_) {
    authenticator_->renew_session(signing_clock_->now());
  }
  return authenticator_ != nullptr;
}

void Bus::seal(const std::string& channel, const std::string& robot) {
  authenticator_->seal(channel, robot, signing_clock_->now(), buffer_);
}

bool Bus::open(Delivery& delivery) {
  if (!authenticator_) {
    receives_signed_ = receives_signed_ || auth::split(delivery.bytes).has_value();
    return true;
  }
  const auth::Authenticator::Judged judged =
      authenticator_->judge(delivery.name, delivery.bytes, signing_clock_->now(),
                            claim_of(delivery.name, delivery.bytes, vehicle_), delivery.source);
  delivery.bytes = judged.payload;
  delivery.echo = judged.echo;
  return judged.may_pass;
}

bool Bus::is_addressed_to_us(Delivery& delivery, const models::OperatorCommand& command) {
  if (delivery.echo == auth::Refusal::kNone || passes_every_filter(command)) {
    return true;
  }
  if (!command.robot.empty() && command.robot != vehicle_) {
    return false;  // addressed to another vehicle; not an error
  }
  if (!std::exchange(delivery.is_echo_counted, true)) {
    delivery.echo =
        authenticator_->refuse(delivery.name, delivery.echo) ? auth::Refusal::kNone : delivery.echo;
  }
  return delivery.echo == auth::Refusal::kNone;
}

int Bus::handle(std::chrono::microseconds timeout) { return transport_.handle(timeout); }

std::int64_t Bus::next_sequence(const std::string& channel) { return next_sequence_[channel]++; }

bool Bus::send(const std::string& channel, std::span<const std::uint8_t> bytes) {
  if (!air_) {
    return transport_.publish(channel, bytes);
  }
  if (air_->admit(channel, bytes.size(), air_clock_->now()) == Reach::kHost) {
    return transport_.publish_on_host(channel, bytes);
  }
  bool is_sent = transport_.publish(channel, bytes);
  for (int copy = 1; copy < air_->copies_on(channel); ++copy) {
    // Receivers drop a second message with the same sequence number silently, but count one with
    // the same signature as refused. Each copy is therefore signed again.
    if (const auto sealed = authenticator_ ? auth::split(buffer_) : std::nullopt) {
      buffer_.resize(sealed->payload.size());
      seal(channel, "");
    }
    air_->admit(channel, buffer_.size(), air_clock_->now());
    is_sent = transport_.publish(channel, buffer_) || is_sent;
  }
  return is_sent;
}

void Bus::add_subscription(Subscription subscription) {
  const bool is_new = !index_.contains(subscription.pattern);
  // Creates the entry at subscription, so that a flood of other names cannot exhaust the limit of
  // streams first.
  if (!subscription.pattern.ends_with('*')) {
    if (subscription.is_shared) {
      shared_streams_.try_emplace(subscription.pattern);
    } else {
      streams_.try_emplace(subscription.pattern);
    }
  }
  const std::size_t index = index_.add(subscription.pattern);
  if (index == subscriptions_.size()) {
    subscriptions_.emplace_back();
  }
  subscriptions_[index] = std::move(subscription);
  if (is_new) {
    const std::string& pattern = subscriptions_[index].pattern;
    transport_.subscribe(pattern, [self = std::weak_ptr<Bus*>(self_), pattern](
                                      std::string_view name, const Payload& bytes) {
      if (const auto bus = self.lock()) {
        (*bus)->on_message(pattern, name, bytes);
      }
    });
  }
}

void Bus::unsubscribe(const std::string& name) {
  for (const std::size_t number : index_.remove(name)) {
    subscriptions_[number] = {};
  }
  transport_.unsubscribe(name);
  if (index_.next(name, 0)) {
    return;  // a pattern subscription still receives the channel
  }
  if (const auto stream = streams_.find(name); stream != streams_.end()) {
    unsubscribed_counts_.add(stream->second.counts());
    streams_.erase(stream);
  }
  if (const auto stream = shared_streams_.find(name); stream != shared_streams_.end()) {
    unsubscribed_counts_.add(stream->second.counts());
    shared_streams_.erase(stream);
  }
}

// The transport calls this once for each distinct pattern that matches a message. Only the call for
// the first pattern delivers to all subscriptions, so that the stream is checked once.
void Bus::on_message(const std::string& pattern, std::string_view name, const Payload& bytes) {
  const auto first = index_.next(name, 0);
  if (!first || subscriptions_[*first].pattern != pattern) {
    return;
  }
  const std::int64_t start_ns = monotonic_ns();
  Delivery delivery{std::string(name), bytes};
  delivery.source = bytes.source;
  delivery.decoded = authenticator_ ? nullptr : bytes.decoded;  // signed messages are not shared
  if (!open(delivery)) {
    handling_ns_ += monotonic_ns() - start_ns;
    return;
  }
  for (auto i = first; i; i = index_.next(name, *i + 1)) {
    delivery.is_shared = subscriptions_[*i].is_shared;
    delivery.lease = subscriptions_[*i].lease;
    subscriptions_[*i].deliver(delivery);
  }
  handling_ns_ += monotonic_ns() - start_ns;
}

bool Bus::is_fresh(Delivery& delivery, const models::Stamp& stamp) {
  if (!delivery.is_fresh) {
    const bool is_known =
        streams_.contains(delivery.name) || shared_streams_.contains(delivery.name);
    if (!is_known && streams_.size() + shared_streams_.size() >= kStreamsMax) {
      ++streams_refused_;
      delivery.is_fresh = false;
    } else {
      const StreamRules rules{clock_ == nullptr ? std::nullopt : std::optional(clock_->now()),
                              delivery.lease};
      const Arrival arrival = delivery.is_shared
                                  ? shared_streams_[delivery.name].judge(stamp, rules)
                                  : streams_[delivery.name].judge(stamp, rules);
      delivery.is_fresh = arrival == Arrival::kFresh;
    }
  }
  return *delivery.is_fresh;
}

void Bus::count_fault(Delivery& delivery, std::map<std::string, std::int64_t>& counts) {
  if (!delivery.is_faulty) {
    delivery.is_faulty = true;
    const bool has_room = counts.contains(delivery.name) || counts.size() < kCountedChannelsMax;
    ++counts[has_room ? delivery.name : kOtherChannels];
  }
}

std::int64_t Bus::messages_lost() const {
  std::int64_t lost = unsubscribed_counts_.lost;
  for (const auto& [name, counts] : stream_counts()) {
    lost += air_ && air_->is_thinned(name) ? 0 : counts.lost;
  }
  return lost;
}

std::map<std::string, StreamCounts> Bus::stream_counts() const {
  std::map<std::string, StreamCounts> counts;
  for (const auto& [name, stream] : streams_) {
    counts[name] = stream.counts();
  }
  for (const auto& [name, stream] : shared_streams_) {
    if (const StreamCounts shared = stream.counts(); shared.runs > 0) {
      counts[name] = shared;
    }
  }
  return counts;
}

std::vector<models::NamedCount> Bus::counters() const {
  const TransportStats stats = transport_.stats();
  std::vector<models::NamedCount> counts{
      {"transport.messages_sent", stats.messages_sent},
      {"transport.messages_received", stats.messages_received},
      {"transport.send_errors", stats.send_errors},
      {"transport.network_losses", stats.network_losses},
      {"transport.malformed_datagrams", stats.malformed_datagrams},
      {"transport.incomplete_messages", stats.incomplete_messages},
      {"transport.queue_overflows", stats.queue_overflows},
      {"transport.oversized_messages", stats.oversized_messages},
      {"transport.duplicate_fragments", stats.duplicate_fragments},
      {"transport.kernel_drops", stats.kernel_drops},
      {"transport.receive_buffer_short_bytes", stats.receive_buffer_short_bytes},
      {"bus.streams_refused", streams_refused_}};
  if (air_) {
    const std::vector<models::NamedCount> of_air = air_->counters();
    counts.insert(counts.end(), of_air.begin(), of_air.end());
  }
  for (const auto& [name, count] : decode_errors_) {
    counts.push_back({name + ".decode_errors", count});
  }
  for (const auto& [name, count] : refused_) {
    counts.push_back({name + ".refused", count});
  }
  if (authenticator_) {
    authenticator_->count(counts);
  }
  const auto add_stream = [&](const std::string& name, const StreamCounts& stream) {
    counts.push_back({name + ".fresh", stream.fresh});
    // Senders on other hosts leave out messages of these channels.
    const bool is_thinned = air_ && air_->is_thinned(name);
    counts.push_back({name + (is_thinned ? ".skipped" : ".lost"), stream.lost});
    const bool is_repeated = air_ && air_->copies_on(name) > 1;
    counts.push_back({name + (is_repeated ? ".repeated" : ".duplicates"), stream.duplicates});
    counts.push_back({name + ".reordered", stream.reordered});
    counts.push_back({name + ".old_runs", stream.old_runs});
    counts.push_back({name + ".too_far_ahead", stream.too_far_ahead});
  };
  for (const auto& [name, stream] : reported(stream_counts())) {
    add_stream(name, stream);
    counts.push_back({name + ".restarts", std::max<std::int64_t>(0, stream.runs - 1)});
  }
  add_stream("left", unsubscribed_counts_);
  return models::nonzero(std::move(counts));
}

}  // namespace vantage::bus
