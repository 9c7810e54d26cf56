#include "python/binding/live.hpp"

#include <chrono>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <pybind11/stl.h>

#include "bus/auth/authenticator.hpp"
#include "bus/node/bus.hpp"
#include "bus/node/clock.hpp"
#include "bus/node/command_claim.hpp"
#include "bus/transport/transport.hpp"
#include "core/check.hpp"
#include "models/exchange/counts.hpp"
#include "python/binding/bind.hpp"
#include "python/binding/custom_nodes.hpp"
#include "python/binding/scenario.hpp"

namespace vantage::python {
namespace {

// Converts a channel name to a str. Names from other systems may contain any bytes.
py::str text_of(std::string_view name) {
  return py::reinterpret_steal<py::str>(
      PyUnicode_DecodeUTF8(name.data(), static_cast<Py_ssize_t>(name.size()), "surrogateescape"));
}

// Transport of bytes under channel names. The Python module vantage.live converts them to messages.
class LiveBus {
 public:
  LiveBus(const std::string& url, std::shared_ptr<Scenario> scenario)
      : scenario_(std::move(scenario)) {
    const py::gil_scoped_release release;
    transport_ = bus::open_transport(url.empty() && scenario_ ? scenario_->value.network.url : url);
    if (scenario_) {
      authenticator_ = bus::auth::authenticator_for(scenario_->value);
    }
  }
  ~LiveBus() {
    const py::gil_scoped_release release;
    transport_.reset();
  }
  LiveBus(const LiveBus&) = delete;
  LiveBus& operator=(const LiveBus&) = delete;
  LiveBus(LiveBus&&) = delete;
  LiveBus& operator=(LiveBus&&) = delete;

  // Calls `action` with exclusive access to the bus, without the interpreter's lock. The mutex is
  // recursive because a handler may publish.
  template <class Action>
  auto exclusively(const Action& action) {
    const py::gil_scoped_release release;
    const std::lock_guard lock(mutex_);
    return action();
  }

  void subscribe(const std::string& channel, const py::function& handler) {
    const KeptFunction call = kept(handler);
    exclusively([&] {
      transport_->subscribe(channel, [this, call](std::string_view name, const auto& payload) {
        const std::span<const std::uint8_t> bytes = payload;
        if (const auto content = opened(name, bytes)) {
          const py::gil_scoped_acquire acquire;
          (*call)(text_of(name),
                  py::bytes(reinterpret_cast<const char*>(content->data()), content->size()));
        }
      });
    });
  }

  bool publish(const std::string& channel, const py::bytes& message) {
    const std::string_view text(message);
    constexpr std::size_t kChannelMax = 63;
    require(!channel.empty() && channel.size() <= kChannelMax,
            "channel: must have 1 to 63 bytes, has " + std::to_string(channel.size()));
    std::vector<std::uint8_t> bytes(text.begin(), text.end());
    return exclusively([&] {
      if (authenticator_) {
        authenticator_->seal(channel, "", clock_.now(), bytes);
      }
      return transport_->publish(channel, bytes);
    });
  }

  int handle(double timeout_s) {
    require(timeout_s >= 0.0 && timeout_s <= 3600.0, "timeout_s: must be ≥ 0 and ≤ 3600");
    return exclusively([&] {
      require(!is_handling_, "handle: must not be called from the function of a subscription");
      is_handling_ = true;
      const Handling handling{is_handling_};
      return transport_->handle(from_seconds(timeout_s));
    });
  }

  [[nodiscard]] std::vector<models::NamedCount> counters() {
    return exclusively([&] {
      const bus::TransportStats stats = transport_->stats();
      std::vector<models::NamedCount> counts{
          {"transport.messages_sent", stats.messages_sent},
          {"transport.messages_received", stats.messages_received},
          {"transport.send_errors", stats.send_errors},
          {"transport.malformed_datagrams", stats.malformed_datagrams},
          {"transport.incomplete_messages", stats.incomplete_messages},
          {"transport.queue_overflows", stats.queue_overflows},
          {"transport.oversized_messages", stats.oversized_messages},
          {"transport.kernel_drops", stats.kernel_drops}};
      if (authenticator_) {
        authenticator_->count(counts);
      }
      return models::nonzero(std::move(counts));
    });
  }

  [[nodiscard]] std::int64_t now_utime() const { return to_utime(clock_.now()); }

 private:
  struct Handling {
    bool& flag;
    ~Handling() { flag = false; }
  };

  // Returns the payload of a message without the signature; nullopt if the message is refused.
  std::optional<std::span<const std::uint8_t>> opened(std::string_view channel,
                                                      std::span<const std::uint8_t> bytes) {
    if (!authenticator_) {
      return bytes;
    }
    const auto judged =
        authenticator_->judge(channel, bytes, clock_.now(), bus::claim_of(channel, bytes, ""));
    return judged.may_pass ? std::optional(judged.payload) : std::nullopt;
  }

  std::shared_ptr<Scenario> scenario_;
  bus::SteadyClock clock_;
  std::recursive_mutex mutex_;
  bool is_handling_ = false;
  std::unique_ptr<bus::Transport> transport_;
  std::unique_ptr<bus::auth::Authenticator> authenticator_;
};

}  // namespace

void bind_live(py::module_& module) {
  py::class_<LiveBus>(module, "_Bus", "Transport of bytes; see vantage.live.Bus.")
      .def(py::init([](const std::string& url, const py::object& scenario) {
             std::shared_ptr<Scenario> of;
             if (!scenario.is_none()) {
               of = py::cast<std::shared_ptr<Scenario>>(scenario);
             }
             return std::make_unique<LiveBus>(url, std::move(of));
           }),
           py::arg("url"), py::arg("scenario"))
      .def("subscribe", &LiveBus::subscribe, py::arg("channel"), py::arg("handler"))
      .def("publish", &LiveBus::publish, py::arg("channel"), py::arg("message"))
      .def("handle", &LiveBus::handle, py::arg("timeout_s"))
      .def("counters",
           [](LiveBus& self) {
             py::dict out;
             for (const models::NamedCount& each : self.counters()) {
               out[py::str(each.name)] = each.count;
             }
             return out;
           })
      .def("now_utime", &LiveBus::now_utime)
      .def_static("random_run_id", &bus::random_run_id);
}

}  // namespace vantage::python
