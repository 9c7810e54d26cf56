#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "bus/auth/authenticator.hpp"
#include "bus/auth/keyring.hpp"
#include "core/check.hpp"
#include "test/bus/auth/auth_support.hpp"

namespace vantage::bus::auth {
namespace {

namespace fs = std::filesystem;
using test::TemporaryFolder;

std::string path_of(const std::string& folder, const Key& key, const char* suffix = nullptr) {
  return folder + "/" + key_name(key) + "." + (suffix == nullptr ? name_of(key.use) : suffix);
}

std::string refusal_of(const std::string& folder) {
  try {
    static_cast<void>(load_keyring(folder));
  } catch (const StartupError& error) {
    return error.what();
  }
  return "loaded";
}

class KeyFolder : public ::testing::Test {
 protected:
  void SetUp() override { make_keys(folder()); }
  [[nodiscard]] std::string folder() const { return outer_.file("keys"); }
  [[nodiscard]] std::string file_of(Role role, const char* suffix = nullptr) const {
    const Keyring keyring = load_keyring(folder());
    for (const Key& key : keyring.keys()) {
      if (key.role == role) {
        return path_of(folder(), key, suffix);
      }
    }
    return "";
  }
  TemporaryFolder outer_;
};

TEST_F(KeyFolder, HasAPrivateKeyFilePerRole) {
  const Keyring keyring = load_keyring(folder());
  EXPECT_EQ(keyring.keys().size(), kRoles.size());
  for (const Role role : kRoles) {
    ASSERT_NE(keyring.signing(role), nullptr) << name_of(role);
  }
  struct stat status {};
  ASSERT_EQ(stat(folder().c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0700U);
  int files = 0;
  for (const auto& entry : fs::directory_iterator(folder())) {
    ASSERT_EQ(stat(entry.path().c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777U, 0600U) << entry.path();
    ++files;
  }
  EXPECT_EQ(files, 6) << "five keys and the operator's seed";
}

TEST_F(KeyFolder, IsNotOverwritten) { EXPECT_THROW(make_keys(folder()), StartupError); }

TEST_F(KeyFolder, KeysDifferFromFolderToFolder) {
  const std::string other = outer_.file("other");
  make_keys(other);
  const Keyring ours = load_keyring(folder());
  const Keyring theirs = load_keyring(other);
  for (const Role role : kRoles) {
    EXPECT_EQ(theirs.find(ours.signing(role)->id), nullptr);
  }
}

TEST_F(KeyFolder, IsRefusedWhenOtherUsersCanAccessAKey) {
  const std::string file = file_of(Role::kVehicle);
  for (const unsigned mode : {0640U, 0604U, 0620U, 0602U}) {
    ASSERT_EQ(chmod(file.c_str(), mode), 0);
    EXPECT_NE(refusal_of(folder()).find("chmod 600 " + file), std::string::npos) << mode;
  }
  ASSERT_EQ(chmod(file.c_str(), 0600), 0);
  EXPECT_EQ(refusal_of(folder()), "loaded");
  ASSERT_EQ(chmod(folder().c_str(), 0770), 0);
  EXPECT_NE(refusal_of(folder()).find("chmod 700"), std::string::npos);
}

TEST_F(KeyFolder, IsRefusedWhenAKeyIsALinkOrBelongsToAnotherUser) {
  const std::string file = file_of(Role::kVehicle);
  if (geteuid() == 0) {
    ASSERT_EQ(chown(file.c_str(), 12345, getegid()), 0);
    EXPECT_NE(refusal_of(folder()).find("belongs to another user"), std::string::npos);
    ASSERT_EQ(chown(file.c_str(), 0, getegid()), 0);
  }
  fs::rename(file, outer_.file("elsewhere"));
  fs::create_symlink(outer_.file("elsewhere"), file);
  EXPECT_NE(refusal_of(folder()).find(file), std::string::npos);
}

TEST_F(KeyFolder, IsRefusedWhenAFileDoesNotMatchItsName) {
  const std::string mocap = file_of(Role::kMocap);
  const std::string vehicle = file_of(Role::kVehicle);
  fs::copy_file(mocap, vehicle, fs::copy_options::overwrite_existing);
  EXPECT_NE(refusal_of(folder()).find(vehicle), std::string::npos) << refusal_of(folder());
  std::ofstream(vehicle) << "short";
  EXPECT_NE(refusal_of(folder()).find("32 bytes"), std::string::npos);
}

TEST_F(KeyFolder, IsRefusedWithTwoSigningKeysOfARole) {
  store_key(folder(), make_key(Role::kMocap));
  EXPECT_NE(refusal_of(folder()).find("has two signing keys"), std::string::npos);
}

// The keys of a vehicle's host: all except the seed that signs commands.
TEST_F(KeyFolder, WithoutTheSeedVerifiesButDoesNotSignCommands) {
  fs::remove(file_of(Role::kOperator, "sign"));
  const Keyring keyring = load_keyring(folder());
  EXPECT_EQ(keyring.signing(Role::kOperator), nullptr);
  EXPECT_EQ(keyring.keys().size(), kRoles.size());
}

TEST_F(KeyFolder, IsRefusedWithTheSeedOfAnotherOperator) {
  const std::string seed = file_of(Role::kOperator, "sign");
  fs::remove(seed);
  write_secret_file(seed, std::vector<std::uint8_t>(kSeedBytes, 3));
  EXPECT_NE(refusal_of(folder()).find("does not belong to"), std::string::npos);
}

TEST_F(KeyFolder, RotationNeverInterruptsVerification) {
  const Keyring before = load_keyring(folder());
  begin_rotation(folder(), std::nullopt);
  EXPECT_THROW(begin_rotation(folder(), std::nullopt), StartupError);
  const Keyring between = load_keyring(folder());
  EXPECT_EQ(between.keys().size(), 2 * kRoles.size());
  end_rotation(folder(), std::nullopt);
  const Keyring after = load_keyring(folder());
  EXPECT_THROW(end_rotation(folder(), std::nullopt), StartupError);
  for (const Role role : kRoles) {
    EXPECT_EQ(between.signing(role)->id, before.signing(role)->id) << "other hosts know this key";
    EXPECT_NE(after.signing(role)->id, before.signing(role)->id);
    EXPECT_NE(between.find(after.signing(role)->id), nullptr)
        << "a host without the new key still accepts the message";
    EXPECT_NE(after.find(before.signing(role)->id), nullptr) << "and its messages are accepted";
    revoke_key(folder(), key_name(*after.find(before.signing(role)->id)));
  }
  const Keyring last = load_keyring(folder());
  EXPECT_EQ(last.keys().size(), kRoles.size());
  for (const Role role : kRoles) {
    EXPECT_EQ(last.find(before.signing(role)->id), nullptr);
    EXPECT_NE(last.signing(role), nullptr);
  }
  EXPECT_THROW(revoke_key(folder(), "mocap-00000000"), StartupError);
}

TEST_F(KeyFolder, RotatesASingleRole) {
  const Keyring before = load_keyring(folder());
  begin_rotation(folder(), Role::kOperator);
  end_rotation(folder(), Role::kOperator);
  const Keyring after = load_keyring(folder());
  EXPECT_NE(after.signing(Role::kOperator)->id, before.signing(Role::kOperator)->id);
  EXPECT_EQ(after.signing(Role::kMocap)->id, before.signing(Role::kMocap)->id);
}

TEST_F(KeyFolder, KeepsForeignFiles) {
  for (const char* const name :
       {"mocap-0123456.key", "mocap-012345678.key", "mocap-0123456G.key", "mocap-0123ABCD.key",
        "mocap-01234567.bak", "mocap-01234567.key.bak", "camera-01234567.key", "mocap01234567.key",
        "README", "-01234567.key"}) {
    std::ofstream(folder() + "/" + name) << "no key";
  }
  EXPECT_EQ(load_keyring(folder()).keys().size(), kRoles.size());
}

TEST_F(KeyFolder, IsRefusedWhenOtherUsersCanWriteToIt) {
  for (const unsigned mode : {0720U, 0702U}) {
    ASSERT_EQ(chmod(folder().c_str(), mode), 0);
    EXPECT_NE(refusal_of(folder()).find("chmod 700"), std::string::npos) << mode;
  }
  ASSERT_EQ(chmod(folder().c_str(), 0755), 0);
  EXPECT_EQ(refusal_of(folder()), "loaded") << "read permission for others is allowed";
}

TEST_F(KeyFolder, RotatesRolesIndependently) {
  const Keyring before = load_keyring(folder());
  begin_rotation(folder(), Role::kMocap);
  EXPECT_THROW(begin_rotation(folder(), Role::kMocap), StartupError);
  EXPECT_THROW(begin_rotation(folder(), std::nullopt), StartupError)
      << "a rotation has begun already";
  EXPECT_THROW(end_rotation(folder(), Role::kVehicle), StartupError) << "this role has no new key";
  begin_rotation(folder(), Role::kPlanner);
  EXPECT_EQ(load_keyring(folder()).keys().size(), kRoles.size() + 2);
  end_rotation(folder(), Role::kMocap);
  const Keyring after = load_keyring(folder());
  for (const Role role : kRoles) {
    EXPECT_EQ(after.signing(role)->id == before.signing(role)->id, role != Role::kMocap)
        << name_of(role);
  }
  EXPECT_EQ(after.find(before.signing(Role::kMocap)->id)->use, KeyUse::kOld);
  end_rotation(folder(), std::nullopt);
  const Keyring last = load_keyring(folder());
  for (const Role role : kRoles) {
    EXPECT_EQ(last.signing(role)->id == before.signing(role)->id,
              role != Role::kMocap && role != Role::kPlanner)
        << name_of(role);
  }
  EXPECT_EQ(last.signing(Role::kMocap)->id, after.signing(Role::kMocap)->id)
      << "a second call does not rotate again";
}

TEST_F(KeyFolder, RevokesAKeyAndItsSeedByNameOrId) {
  const auto files = [this] {
    return std::distance(fs::directory_iterator(folder()), fs::directory_iterator());
  };
  const Keyring keyring = load_keyring(folder());
  const std::string name = key_name(*keyring.signing(Role::kOperator));
  EXPECT_EQ(name.substr(0, 9), "operator-");
  revoke_key(folder(), name.substr(9));
  EXPECT_EQ(files(), 4) << "the seed is removed";
  revoke_key(folder(), key_name(*keyring.signing(Role::kNode)));
  EXPECT_EQ(files(), 3);
  EXPECT_THROW(revoke_key(folder(), name), StartupError);
  EXPECT_EQ(files(), 3);
}

TEST_F(KeyFolder, IsCreatedInAnExistingEmptyFolder) {
  const std::string empty = outer_.file("empty");
  ASSERT_EQ(mkdir(empty.c_str(), 0700), 0);
  EXPECT_NO_THROW(make_keys(empty));
  EXPECT_EQ(load_keyring(empty).keys().size(), kRoles.size());
  EXPECT_THROW(make_keys(outer_.file("no/where")), StartupError);
}

TEST_F(KeyFolder, DoesNotPrintARefusedSecret) {
  const std::string file = outer_.file("secret");
  const std::vector<std::uint8_t> secret(16, 7);
  write_secret_file(file, secret);
  EXPECT_THROW(write_secret_file(file, secret), StartupError) << "the file exists already";
  std::vector<std::uint8_t> out(16, 9);
  read_secret_file(file, out, "secret");
  EXPECT_EQ(out, secret);
  ASSERT_EQ(chmod(file.c_str(), 0604), 0);
  EXPECT_THROW(read_secret_file(file, out, "secret"), StartupError);
  EXPECT_EQ(out, std::vector<std::uint8_t>(16, 0));
  ASSERT_EQ(chmod(file.c_str(), 0400), 0);
  EXPECT_NO_THROW(read_secret_file(file, out, "secret")) << "fewer permissions are accepted";
  for (const std::size_t size : {15U, 17U}) {
    std::vector<std::uint8_t> other(size, 9);
    EXPECT_THROW(read_secret_file(file, other, "secret"), StartupError);
    EXPECT_EQ(other, std::vector<std::uint8_t>(size, 0));
  }
}

TEST(Secret, ContainsZerosAtCreation) {
  const Secret secret(40);
  EXPECT_EQ(secret.bytes().size(), 40U);
  for (const std::uint8_t byte : secret.bytes()) {
    EXPECT_EQ(byte, 0);
  }
}

TEST(Keyring, HasOneKeyPerIdAndOneSigningKeyPerRole) {
  Keyring keyring;
  keyring.add(test::key_of(Role::kMocap, 1));
  EXPECT_THROW(keyring.add(test::key_of(Role::kMocap, 1)), UsageError);
  EXPECT_THROW(keyring.add(test::key_of(Role::kMocap, 2)), UsageError);
  for (const KeyUse use : {KeyUse::kNext, KeyUse::kOld}) {
    Key key = test::key_of(Role::kMocap, static_cast<std::uint8_t>(use == KeyUse::kNext ? 3 : 4));
    key.use = use;
    EXPECT_FALSE(key.can_sign());
    keyring.add(std::move(key));
  }
  keyring.add(test::key_of(Role::kPlanner, 5));
  EXPECT_EQ(keyring.keys().size(), 4U);
  EXPECT_EQ(keyring.signing(Role::kMocap)->id, test::key_of(Role::kMocap, 1).id);
  EXPECT_EQ(keyring.signing(Role::kPlanner)->id, test::key_of(Role::kPlanner, 5).id);
  EXPECT_EQ(keyring.signing(Role::kNode), nullptr);
  EXPECT_EQ(keyring.find(test::key_of(Role::kMocap, 4).id)->use, KeyUse::kOld);
  EXPECT_EQ(keyring.find(1), nullptr);
}

TEST_F(KeyFolder, IsIncompleteWhenOnlyTheNextKeyExists) {
  const Keyring before = load_keyring(folder());
  begin_rotation(folder(), Role::kMocap);
  revoke_key(folder(), key_name(*before.signing(Role::kMocap)));
  const scenario::SecuritySpec required{scenario::SecurityMode::kRequire, folder()};
  scenario::Scenario scenario;
  scenario.security = required;
  scenario.mocap.device = scenario::DeviceSource::kWire;
  const auto faults = security_faults(scenario);
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_NE(faults[0].find("mocap-ID.key"), std::string::npos) << faults[0];
  fs::remove(file_of(Role::kVehicle));
  fs::remove(file_of(Role::kNode));
  EXPECT_EQ(security_faults(scenario).size(), 3U);
}

TEST(LoadKeyring, ReportsHowToCreateAMissingFolder) {
  EXPECT_NE(refusal_of("/nowhere/keys").find("vantage keys new"), std::string::npos);
}

scenario::Scenario scenario_of(scenario::SecurityMode mode, const std::string& keys,
                               scenario::DeviceSource device) {
  scenario::Scenario scenario;
  scenario.security = {mode, keys};
  scenario.mocap.device = device;
  return scenario;
}

TEST_F(KeyFolder, IsRequiredForRealDevices) {
  using scenario::DeviceSource;
  using scenario::SecurityMode;
  for (const SecurityMode mode : {SecurityMode::kOff, SecurityMode::kWarn}) {
    const auto real = scenario_of(mode, folder(), DeviceSource::kReal);
    EXPECT_THROW(static_cast<void>(authenticator_for(real)), StartupError);
    EXPECT_EQ(security_faults(real).size(), 1U);
    const auto wire = scenario_of(mode, folder(), DeviceSource::kWire);
    EXPECT_NO_THROW(static_cast<void>(authenticator_for(wire)));
    EXPECT_TRUE(security_faults(wire).empty());
  }
  const auto real = scenario_of(SecurityMode::kRequire, folder(), DeviceSource::kReal);
  EXPECT_NE(authenticator_for(real), nullptr);
  EXPECT_TRUE(security_faults(real).empty());
  EXPECT_EQ(authenticator_for(scenario_of(SecurityMode::kOff, "", DeviceSource::kWire)), nullptr);
}

// A command echoes the nonces of at most 64 vehicles. Further vehicles could not be armed and would
// receive no heartbeat. The status of every robot requests a nonce, so all robots count. Without
// any driver, no process verifies commands, and there is no limit.
TEST_F(KeyFolder, LimitsTheNumberOfVehiclesPerCommand) {
  using scenario::DeviceSource;
  using scenario::SecurityMode;
  const auto faults_of = [&](SecurityMode mode, std::size_t robots, DeviceSource of_one) {
    auto scenario = scenario_of(mode, folder(), DeviceSource::kWire);
    scenario.robots.resize(robots);
    scenario.robots[0].device = of_one;
    return security_faults(scenario);
  };
  EXPECT_TRUE(faults_of(SecurityMode::kRequire, 64, DeviceSource::kWire).empty());
  for (const DeviceSource device : {DeviceSource::kWire, DeviceSource::kReal}) {
    EXPECT_EQ(faults_of(SecurityMode::kRequire, 65, device),
              (std::vector<std::string>{
                  "robots: the scenario has 65 vehicles, but a signed command can address at most "
                  "64; use fewer vehicles, or simulate them without drivers (device: direct)"}));
  }
  EXPECT_TRUE(faults_of(SecurityMode::kRequire, 65, DeviceSource::kDirect).empty());
  EXPECT_TRUE(faults_of(SecurityMode::kWarn, 65, DeviceSource::kWire).empty())
      << "in warn mode messages without an echo are accepted";
  EXPECT_TRUE(faults_of(SecurityMode::kOff, 65, DeviceSource::kWire).empty());
}

TEST_F(KeyFolder, IsReportedByNameWhenMissing) {
  using scenario::DeviceSource;
  using scenario::SecurityMode;
  const auto scenario = scenario_of(SecurityMode::kRequire, folder(), DeviceSource::kWire);
  EXPECT_NO_THROW(require_operator(scenario));
  fs::remove(file_of(Role::kOperator, "sign"));
  EXPECT_THROW(require_operator(scenario), StartupError);
  fs::remove(file_of(Role::kPlanner));
  ASSERT_EQ(security_faults(scenario).size(), 1U);
  EXPECT_NE(security_faults(scenario)[0].find("planner"), std::string::npos);
  const auto nowhere = scenario_of(SecurityMode::kRequire, "/nowhere", DeviceSource::kWire);
  EXPECT_EQ(security_faults(nowhere).size(), 1U);
  EXPECT_THROW(static_cast<void>(authenticator_for(nowhere)), StartupError);
  EXPECT_EQ(replay_authenticator_for(nowhere), nullptr) << "a replay on another host";
}

}  // namespace
}  // namespace vantage::bus::auth
