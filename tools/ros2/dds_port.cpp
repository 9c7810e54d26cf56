#include <algorithm>
#include <array>
#include <map>
#include <utility>
#include <vector>

#include <dds/dds.h>
#include <dds/ddsi/ddsi_serdata.h>
#include <fmt/format.h>

#include "core/check.hpp"
#include "tools/ros2/cdr_type.hpp"
#include "tools/ros2/names.hpp"
#include "tools/ros2/port.hpp"

namespace vantage::tools::ros2 {
namespace {

constexpr std::int32_t kDepth = 10;  // history depth; ROS 2's default
constexpr std::size_t kTakenMax = 32;

[[noreturn]] void fail(const std::string& what, dds_return_t code) {
  throw StartupError(fmt::format("vantage ros2: {}: {}", what, dds_strretcode(-code)));
}

dds_entity_t require_entity(dds_entity_t entity, const std::string& what) {
  if (entity < 0) {
    fail(what, entity);
  }
  return entity;
}

class Qos {
 public:
  Qos() : qos_(dds_create_qos()) {}
  ~Qos() { dds_delete_qos(qos_); }
  Qos(const Qos&) = delete;
  Qos& operator=(const Qos&) = delete;
  Qos(Qos&&) = delete;
  Qos& operator=(Qos&&) = delete;
  [[nodiscard]] dds_qos_t* get() const { return qos_; }
  void set_user_data(const std::string& text) { dds_qset_userdata(qos_, text.data(), text.size()); }

 private:
  dds_qos_t* qos_;
};

/// Returns the configuration of Cyclone DDS for one network card.
std::string configuration(const std::string& interface) {
  return fmt::format(
      "<CycloneDDS><Domain><General><Interfaces><NetworkInterface name=\"{}\"/></Interfaces>"
      "</General></Domain></CycloneDDS>",
      interface);
}

class DdsPort : public Port {
 public:
  explicit DdsPort(const scenario::Ros2Spec& spec)
      : domain_(require_entity(
            dds_create_domain(static_cast<dds_domainid_t>(spec.domain),
                              configuration(spec.interface).c_str()),
            fmt::format("cannot join domain {} on network card {}", spec.domain, spec.interface))) {
    Qos qos;
    qos.set_user_data("enclave=/;");
    dds_qset_ignorelocal(qos.get(), DDS_IGNORELOCAL_PARTICIPANT);
    participant_ =
        dds_create_participant(static_cast<dds_domainid_t>(spec.domain), qos.get(), nullptr);
    if (participant_ < 0) {
      const dds_return_t code = participant_;
      dds_delete(domain_);
      fail(fmt::format("cannot use network card {} for domain {}", spec.interface, spec.domain),
           code);
    }
  }
  ~DdsPort() override { dds_delete(domain_); }
  DdsPort(const DdsPort&) = delete;
  DdsPort& operator=(const DdsPort&) = delete;
  DdsPort(DdsPort&&) = delete;
  DdsPort& operator=(DdsPort&&) = delete;

  bool write(const std::string& topic, std::string_view type, Durability durability,
             std::string_view cdr) override {
    auto found = writers_.find(topic);
    if (found == writers_.end()) {
      found = writers_.emplace(topic, open_writer(topic, type, durability)).first;
    }
    const std::span bytes(reinterpret_cast<const std::uint8_t*>(cdr.data()), cdr.size());  // NOLINT
    return dds_writecdr(found->second.entity, new_cdr_message(found->second.type, bytes)) ==
           DDS_RETCODE_OK;
  }

  void read(const std::string& topic, std::string_view type,
            std::function<void(std::span<const std::uint8_t>)> handler) override {
    const Endpoint description = open_topic(topic, type);
    const Qos qos;
    dds_qset_reliability(qos.get(), DDS_RELIABILITY_BEST_EFFORT, 0);  // matches all writers
    set_common(qos, type);
    readers_.push_back(
        {require_entity(dds_create_reader(participant_, description.entity, qos.get(), nullptr),
                        "cannot read " + topic),
         std::move(handler)});
  }

  void take() override {
    for (const Reader& reader : readers_) {
      std::array<ddsi_serdata*, kTakenMax> messages{};
      std::array<dds_sample_info_t, kTakenMax> infos{};
      const dds_return_t count =
          dds_takecdr(reader.entity, messages.data(), kTakenMax, infos.data(), DDS_ANY_STATE);
      for (std::size_t i = 0; i < static_cast<std::size_t>(std::max(count, 0)); ++i) {
        if (infos.at(i).valid_data) {
          reader.handler(cdr_of(messages.at(i)));
        }
        ddsi_serdata_unref(messages.at(i));
      }
    }
  }

 private:
  struct Endpoint {
    dds_entity_t entity = 0;
    const ddsi_sertype* type = nullptr;
  };
  struct Reader {
    dds_entity_t entity = 0;
    std::function<void(std::span<const std::uint8_t>)> handler;
  };

  static void set_common(const Qos& qos, std::string_view type) {
    const dds_data_representation_id_t representation = DDS_DATA_REPRESENTATION_XCDR1;
    dds_qset_data_representation(qos.get(), 1, &representation);
    dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, kDepth);
    const std::string hash = type_hash_user_data(type);
    dds_qset_userdata(qos.get(), hash.data(), hash.size());
  }

  Endpoint open_topic(const std::string& topic, std::string_view type) {
    ddsi_sertype* cdr_type = new_cdr_type(dds_type(type));
    const dds_entity_t entity = dds_create_topic_sertype(participant_, dds_topic(topic).c_str(),
                                                         &cdr_type, nullptr, nullptr, nullptr);
    return {require_entity(entity, "cannot create topic " + topic), cdr_type};
  }

  Endpoint open_writer(const std::string& topic, std::string_view type, Durability durability) {
    const Endpoint description = open_topic(topic, type);
    const Qos qos;
    set_common(qos, type);
    dds_qset_reliability(qos.get(), DDS_RELIABILITY_RELIABLE, 0);  // 0: never waits for a reader
    if (durability == Durability::kTransient) {
      dds_qset_durability(qos.get(), DDS_DURABILITY_TRANSIENT_LOCAL);
      dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, 1);
    }
    return {require_entity(dds_create_writer(participant_, description.entity, qos.get(), nullptr),
                           "cannot write " + topic),
            description.type};
  }

  dds_entity_t domain_;
  dds_entity_t participant_ = 0;
  std::map<std::string, Endpoint> writers_;
  std::vector<Reader> readers_;
};

}  // namespace

std::unique_ptr<Port> open_port(const scenario::Ros2Spec& spec) {
  return std::make_unique<DdsPort>(spec);
}

}  // namespace vantage::tools::ros2
