#include "logs/export/mcap_export.hpp"

#include "core/utf8.hpp"
#include "logs/export/mcap_writer.hpp"
#include "logs/export/ros2_messages.hpp"
#include "logs/file/message_visit.hpp"
#include "logs/foxglove/stream.hpp"
#include "logs/json/wire_json.hpp"

namespace vantage::logs {
namespace {

class McapSink : public foxglove::Sink {
 public:
  explicit McapSink(McapWriter& writer) : writer_(writer) {}

  bool wants(const std::string& topic, foxglove::Schema schema, bool /*is_state*/) override {
    topics_[topic] = writer_.topic(topic, foxglove::name_of(schema), foxglove::json_schema(schema));
    return true;
  }
  void write(const std::string& topic, Time time, const foxglove::Json& content) override {
    writer_.write(topics_.at(topic), time, time,
                  content.dump(-1, ' ', false, foxglove::Json::error_handler_t::replace));
  }

 private:
  McapWriter& writer_;
  std::map<std::string, std::uint16_t> topics_;
};

// Calls `take(event)` for each event until the caller stops it or writing fails.
template <class Take>
void go_through(const IndexedLog& log, McapWriter& writer, ExportCounts& counts,
                const std::function<void(double)>& progress, const std::function<bool()>& stop,
                const Take& take) {
  LogScan scan = log.scan();
  while (const auto event = scan.next()) {
    counts.is_stopped = stop();
    if (counts.is_stopped || !writer.failure().empty()) {
      break;
    }
    if (progress && scan.counts().events % kEventsPerReport == 0) {
      progress(static_cast<double>(event->offset) / static_cast<double>(log.bytes().size()));
    }
    take(*event);
  }
  writer.finish();
  counts.failure = writer.failure();
  counts.messages = writer.messages();
  counts.times_held = writer.times_held();
  std::erase_if(counts.left_out, [](const auto& each) { return each.second == 0; });
  if (progress) {
    progress(1.0);
  }
}

}  // namespace

ExportCounts export_mcap(const IndexedLog& log, const std::string& path, ChannelFilter& channels,
                         bool with_scene, const std::function<void(double)>& progress,
                         const std::function<bool()>& stop) {
  McapWriter writer(path);
  McapSink sink(writer);
  foxglove::Stream scene(sink);
  ExportCounts counts;
  go_through(log, writer, counts, progress, stop, [&](const LogEvent& event) {
    const bus::WireSchema* schema = type_of(event.data);
    const auto json = message_json(event.data);
    const bool is_meant = channels.takes(event.channel);
    if (schema == nullptr || !json) {
      counts.left_out[std::string(event.channel)] += is_meant ? 1 : 0;
      return;
    }
    if (is_meant) {
      const std::uint16_t topic =
          writer.topic(readable(event.channel), "vantage_lcm." + std::string(schema->name),
                       dumped(json_schema(*schema)));
      const Time valid = from_utime(json->at("utime").get<std::int64_t>());
      writer.write(topic, event.time, valid, dumped(*json));
    }
    if (with_scene) {
      scene.on_publisher(event.channel, bus::run_id_of(event.data), event.time);
      visit_message(event, [&](const auto& message) { scene.on(message, event.time); });
    }
  });
  return counts;
}

ExportCounts export_ros2(const IndexedLog& log, const std::string& path, ChannelFilter& channels,
                         const std::function<void(double)>& progress,
                         const std::function<bool()>& stop) {
  McapWriter writer(path, {"ros2", "cdr", "ros2msg"});
  ExportCounts counts;
  go_through(log, writer, counts, progress, stop, [&](const LogEvent& event) {
    if (!channels.takes(event.channel)) {
      return;
    }
    const bool is_whole = visit_message(event, [&]<class Message>(const Message& message) {
      if constexpr (requires { ros2::to_ros2(message); }) {
        for (const ros2::Message& each : ros2::to_ros2(message)) {
          const std::string type(each.type);
          const auto topic = writer.topic(each.topic, type, ros2::definition_of(type));
          writer.write(topic, event.time, each.valid, each.cdr);
        }
      }
    });
    const bool is_damaged = !is_whole && !is_external(event.channel);
    counts.left_out[std::string(event.channel)] += is_damaged ? 1 : 0;
  });
  return counts;
}

}  // namespace vantage::logs
