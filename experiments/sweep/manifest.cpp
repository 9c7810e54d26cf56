#include "experiments/sweep/manifest.hpp"

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sodium.h>
#include <unistd.h>

#include "core/check.hpp"
#include "core/write_file.hpp"

namespace vantage::experiments {
namespace {

constexpr const char* kName = "manifest.json";

// Returns the plan as JSON, without the number of trials.
nlohmann::ordered_json settings_json(const SweepPlan& plan) {
  nlohmann::ordered_json json;
  json["parameters"] = plan.parameters;
  json["columns"] = plan.setting_columns;
  for (const Setting& setting : plan.settings) {
    json["settings"].push_back(setting.cells);
  }
  json["tables"] = plan.tables;
  return json;
}

nlohmann::ordered_json identity_json(const SweepIdentity& identity, const SweepPlan& plan) {
  nlohmann::ordered_json json;
  json["experiment"] = identity.experiment;
  json["version"] = identity.version;
  json["seed"] = identity.seed;
  json["smoke"] = identity.is_smoke;
  json["planning_share"] = identity.planning_share;
  json["settings_sha256"] = settings_hash(plan);
  return json;
}

nlohmann::ordered_json manifest_json(const SweepIdentity& identity, const SweepPlan& plan) {
  nlohmann::ordered_json json = identity_json(identity, plan);
  json["trials"] = plan.trials;
  json["settings"] = settings_json(plan);
  return json;
}

std::filesystem::path write_beside(const std::string& directory,
                                   const nlohmann::ordered_json& json) {
  // The name contains host name and process id, because several hosts may share the directory.
  const std::filesystem::path path =
      std::filesystem::path(directory) / fmt::format("{}.{}.{}", kName, host_name(), ::getpid());
  write_file(path, json.dump(2) + "\n");
  return path;
}

// True if the directory contains no files other than manifests. Manifests that are still being
// written by any shard do not count.
bool is_free(const std::string& directory) {
  for (const auto& entry : std::filesystem::directory_iterator(directory)) {
    if (entry.path().filename().string().rfind(kName, 0) != 0) {
      return false;
    }
  }
  return true;
}

void refuse_other(const std::string& directory, const SweepIdentity& identity,
                  const SweepPlan& plan) {
  const std::string path = std::filesystem::path(directory) / kName;
  std::ifstream file(path);
  std::ostringstream text;
  text << file.rdbuf();
  if (!nlohmann::json::accept(text.str())) {
    throw StartupError(path + ": is not the manifest of an experiment; choose another --out");
  }
  const std::string difference = difference_of(text.str(), identity, plan);
  if (!difference.empty()) {
    throw StartupError(
        fmt::format("{}: contains another run: {}; a directory holds one run; choose another --out",
                    directory, difference));
  }
}

std::string cpu_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    const std::size_t colon = line.find(": ");
    if (line.rfind("model name", 0) == 0 && colon != std::string::npos) {
      return line.substr(colon + 2);
    }
  }
  return "unknown";
}

}  // namespace

std::string settings_hash(const SweepPlan& plan) { return text_hash(settings_json(plan).dump()); }

std::string identity_text(const SweepIdentity& identity, const SweepPlan& plan) {
  return identity_json(identity, plan).dump();
}

std::string difference_of(const std::string& theirs, const SweepIdentity& identity,
                          const SweepPlan& plan) {
  const auto there = nlohmann::json::parse(theirs);
  const auto ours = identity_json(identity, plan);
  for (const auto& [key, value] : ours.items()) {
    const nlohmann::json other =
        there.is_object() && there.contains(key) ? there[key] : nlohmann::json();
    if (other != nlohmann::json(value)) {
      return fmt::format("different {}: {}, but this run has {}", key, other.dump(), value.dump());
    }
  }
  return "";
}

std::string host_name() {
  char name[256] = {};
  if (::gethostname(name, sizeof(name) - 1) != 0) {
    return "host";
  }
  return name;
}

std::string text_hash(const std::string& text) {
  std::array<unsigned char, crypto_hash_sha256_BYTES> hash{};
  const std::vector<unsigned char> bytes(text.begin(), text.end());
  require(sodium_init() >= 0, "libsodium cannot start");
  crypto_hash_sha256(hash.data(), bytes.data(), bytes.size());
  return fmt::format("{:02x}", fmt::join(hash, ""));
}

void claim_directory(const std::string& directory, const SweepIdentity& identity,
                     const SweepPlan& plan) {
  std::error_code error;
  std::filesystem::create_directories(directory, error);
  if (error) {
    throw StartupError(directory + ": cannot be created: " + error.message());
  }
  const std::filesystem::path manifest = std::filesystem::path(directory) / kName;
  if (!std::filesystem::exists(manifest)) {
    // Another shard may have created the manifest in the meantime and begun its rows.
    if (!is_free(directory) && !std::filesystem::exists(manifest)) {
      throw StartupError(directory +
                         ": is not empty and has no manifest.json; choose another --out");
    }
    // If several shards start at the same time, one creates the file; the others compare their
    // manifest with this file.
    const std::filesystem::path written = write_beside(directory, manifest_json(identity, plan));
    const int linked = ::link(written.c_str(), manifest.c_str());
    const int why = errno;
    std::filesystem::remove(written, error);
    if (linked != 0 && why != EEXIST) {
      throw StartupError(manifest.string() + ": cannot be created: " + std::strerror(why));
    }
  }
  refuse_other(directory, identity, plan);
}

void finish_manifest(const std::string& directory, const SweepIdentity& identity,
                     const SweepPlan& plan, const std::vector<RowProcess>& processes) {
  nlohmann::ordered_json json = manifest_json(identity, plan);
  double cpu_s = 0.0;
  for (const RowProcess& process : processes) {
    cpu_s += process.cpu_s;
    json["processes"].push_back({{"machine", process.machine},
                                 {"cores", process.cores},
                                 {"jobs", process.jobs},
                                 {"shard", process.shard},
                                 {"started", process.started},
                                 {"units", process.units},
                                 {"cpu_s", process.cpu_s}});
  }
  json["cpu_s"] = cpu_s;
  const std::filesystem::path written = write_beside(directory, json);
  std::error_code error;
  std::filesystem::rename(written, std::filesystem::path(directory) / kName, error);
  if (error) {
    throw StartupError(directory + ": the manifest cannot be written: " + error.message());
  }
}

RowProcess this_process(int jobs, const Shard& shard) {
  RowProcess process;
  process.machine = cpu_name();
  process.cores = static_cast<int>(std::thread::hardware_concurrency());
  process.jobs = jobs;
  process.shard = fmt::format("{}/{}", shard.number, shard.of);
  const std::time_t now = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  std::tm utc{};
  gmtime_r(&now, &utc);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &utc);
  process.started = text.data();
  return process;
}

}  // namespace vantage::experiments
