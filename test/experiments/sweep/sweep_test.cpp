#include <atomic>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/check.hpp"
#include "experiments/sweep/compare.hpp"
#include "experiments/sweep/row_files.hpp"
#include "experiments/sweep/sweep_run.hpp"

namespace vantage::experiments {
namespace {

namespace fs = std::filesystem;

const SweepIdentity kIdentity{"counting", "1.0+abc", 5, false};

// Returns a sweep of three settings, one of which has a single unit. `runs` counts the units that
// have run.
Sweep counting_sweep(std::atomic<int>& runs) {
  Sweep sweep;
  sweep.plan.setting_columns = "name,size";
  sweep.plan.settings = {{"small,1"}, {"picture,0", true}, {"large,3"}};
  sweep.plan.trials = 4;
  sweep.plan.parameters = {{"depth", "7"}};
  sweep.plan.tables = {{"values", "index,value"}};
  sweep.run = [&runs](std::size_t setting, std::uint64_t seed) {
    ++runs;
    UnitRows rows;
    for (std::size_t i = 0; i <= setting; ++i) {
      rows.tables["values"].push_back(
          fmt::format("{},{:.6f}", i, static_cast<double>(seed * 10 + setting) / 7.0));
    }
    rows.times_s = {{"part", 0.25}};
    return rows;
  };
  sweep.summarise = [](const Tables& tables) {
    Sample sample;
    for (const Record& record : tables.at("values")) {
      sample.add(record.number(1));
    }
    Summary summary;
    summary.files["summary.csv"] = fmt::format("mean\n{:.9f}\n", sample.mean());
    summary.compared = {compare_number("mean", sample, 10.0, "m")};
    summary.lines = {"all is counted"};
    summary.time_lines = {fmt::format("{} times", tables.at("times").size())};
    return summary;
  };
  return sweep;
}
constexpr int kUnits = 9;

// A fixture with a temporary directory per test.
class Sweeps : public ::testing::Test {
 protected:
  Sweeps() {
    root_ =
        fs::path(::testing::TempDir()) /
        fmt::format("sweep_{}_{}", ::testing::UnitTest::GetInstance()->current_test_info()->name(),
                    ::getpid());
    fs::remove_all(root_);
    fs::create_directories(root_);
  }
  ~Sweeps() override { fs::remove_all(root_); }

  [[nodiscard]] std::string dir(const std::string& name) const { return root_ / name; }

  SweepOutcome run(const std::string& name, SweepOptions options = {}) {
    options.directory = dir(name);
    return run_sweep(counting_sweep(runs_), kIdentity, "Counting", options);
  }

  int runs_since() { return runs_.exchange(0); }

  std::atomic<int> runs_{0};
  fs::path root_;
};

std::string text_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return std::move(text).str();
}

// Returns the files, by name, that must not depend on how a sweep was run.
std::map<std::string, std::string> results_in(const fs::path& directory) {
  std::map<std::string, std::string> results;
  for (const auto& entry : fs::directory_iterator(directory)) {
    const std::string name = entry.path().filename();
    if (entry.is_regular_file() && name != "manifest.json" && name.rfind("times", 0) != 0) {
      results[name] = text_of(entry.path());
    }
  }
  return results;
}

fs::path only_rows_file(const fs::path& directory) {
  fs::path found;
  for (const auto& entry : fs::directory_iterator(directory / "rows")) {
    EXPECT_TRUE(found.empty());
    found = entry.path();
  }
  return found;
}

std::string refusal_of(const std::function<void()>& start) {
  try {
    start();
  } catch (const StartupError& error) {
    return error.what();
  }
  return "";
}

TEST_F(Sweeps, WriteTablesSummaryReportAndManifest) {
  const SweepOutcome outcome = run("a");
  EXPECT_FALSE(outcome.is_stopped);
  EXPECT_EQ(runs_since(), kUnits);
  const auto results = results_in(dir("a"));
  EXPECT_EQ(results.at("values.csv").substr(0, 52),
            "name,size,trial,index,value\nsmall,1,0,0,7.142857\nsma");
  EXPECT_NE(results.at("report.md").find("| mean | "), std::string::npos);
  EXPECT_NE(results.at("report.md").find("--seed 5 --trials 4"), std::string::npos);
  EXPECT_EQ(text_of(fs::path(dir("a")) / "times.txt"), "18 times\n");
  const std::string manifest = text_of(fs::path(dir("a")) / "manifest.json");
  for (const char* key : {"\"version\": \"1.0+abc\"", "\"depth\": \"7\"", "\"machine\"",
                          "\"cores\"", "\"settings_sha256\"", "\"started\"", "\"units\": 9"}) {
    EXPECT_NE(manifest.find(key), std::string::npos) << key;
  }
}

TEST_F(Sweeps, AreIdenticalForAnyNumberOfJobs) {
  run("one");
  SweepOptions options;
  options.jobs = 4;
  run("four", options);
  EXPECT_EQ(results_in(dir("one")), results_in(dir("four")));
}

TEST_F(Sweeps, RunOnlyNamedSettings) {
  SweepOptions options;
  options.only = {"large", "small,1"};
  const SweepOutcome outcome = run("some", options);
  EXPECT_EQ(outcome.progress.units, 8U);
  EXPECT_EQ(runs_, 8);
  EXPECT_FALSE(outcome.is_stopped);
  EXPECT_TRUE(fs::exists(dir("some") + "/values.csv"));
  EXPECT_FALSE(fs::exists(dir("some") + "/summary.csv")) << "a summary needs all settings";
  run("some");
  EXPECT_EQ(runs_, kUnits) << "existing units are not run again";
  run("whole");
  EXPECT_EQ(results_in(dir("whole")), results_in(dir("some")));
}

TEST_F(Sweeps, RefuseAnUnknownSetting) {
  SweepOptions options;
  options.only = {"large", "lar"};
  EXPECT_THROW(run("none", options), StartupError);
  EXPECT_FALSE(fs::exists(dir("none")));
  EXPECT_EQ(runs_, 0);
}

TEST_F(Sweeps, AreIdenticalIfDividedIntoShards) {
  run("whole");
  for (int number = 3; number >= 1; --number) {
    SweepOptions options;
    options.shard = Shard{number, 3};
    const SweepOutcome outcome = run("shards", options);
    EXPECT_FALSE(outcome.is_stopped);
    EXPECT_TRUE(results_in(dir("shards")).empty()) << "a shard writes rows only";
  }
  EXPECT_EQ(runs_since(), 2 * kUnits);
  run("shards");
  EXPECT_EQ(runs_since(), 0);
  EXPECT_EQ(results_in(dir("whole")), results_in(dir("shards")));
}

TEST_F(Sweeps, ResumeFromATruncatedFile) {
  run("whole");
  runs_since();
  const fs::path rows = only_rows_file(dir("whole"));
  const std::string all = text_of(rows);
  const auto results = results_in(dir("whole"));
  for (std::size_t end = 0; end <= all.size(); end += 1 + all.size() / 37) {
    const std::string name = fmt::format("cut{}", end);
    fs::create_directories(fs::path(dir(name)) / "rows");
    fs::copy_file(fs::path(dir("whole")) / "manifest.json", fs::path(dir(name)) / "manifest.json");
    std::ofstream(fs::path(dir(name)) / "rows" / rows.filename()) << all.substr(0, end);
    const auto lines = std::count(all.begin(), all.begin() + static_cast<long>(end), '\n');
    run(name);
    EXPECT_EQ(runs_since(), kUnits - std::max(0L, lines - 1)) << end;
    ASSERT_EQ(results_in(dir(name)), results) << end;
  }
}

TEST_F(Sweeps, EndOnRequestAndResume) {
  run("whole");
  runs_since();
  SweepOptions options;
  options.stop = [this] { return runs_ >= 4; };
  const SweepOutcome outcome = run("stopped", options);
  EXPECT_TRUE(outcome.is_stopped);
  EXPECT_EQ(outcome.progress.done, 4U);
  EXPECT_TRUE(results_in(dir("stopped")).empty());
  EXPECT_EQ(runs_since(), 4);
  run("stopped");
  EXPECT_EQ(runs_since(), kUnits - 4);
  EXPECT_EQ(results_in(dir("whole")), results_in(dir("stopped")));
}

TEST_F(Sweeps, AddTrialsToAFinishedRun) {
  run("a");
  runs_since();
  Sweep more = counting_sweep(runs_);
  more.plan.trials = 6;
  SweepOptions options;
  options.directory = dir("a");
  run_sweep(more, kIdentity, "Counting", options);
  EXPECT_EQ(runs_since(), 4);
}

TEST_F(Sweeps, KeepFinishedUnitsWhenAUnitFails) {
  Sweep sweep = counting_sweep(runs_);
  const auto good = sweep.run;
  sweep.run = [&](std::size_t setting, std::uint64_t seed) {
    if (setting == 2 && seed == 6) {
      throw std::runtime_error("no plan");
    }
    return good(setting, seed);
  };
  SweepOptions options;
  options.directory = dir("a");
  try {
    run_sweep(sweep, kIdentity, "Counting", options);
    FAIL() << "it went on";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "setting 'large,3', trial 1: no plan");
  }
  const int done = runs_since();
  EXPECT_EQ(done, 4);
  run("a");
  EXPECT_EQ(runs_since(), kUnits - done);
}

TEST_F(Sweeps, RefuseTheFolderOfAnotherRunAndNameTheDifference) {
  run("a");
  SweepOptions options;
  options.directory = dir("a");
  const Sweep same = counting_sweep(runs_);
  Sweep deeper = same;
  deeper.plan.parameters["depth"] = "8";
  const auto refused = [&](const Sweep& sweep, const SweepIdentity& identity) {
    return refusal_of([&] { run_sweep(sweep, identity, "Counting", options); });
  };
  SweepIdentity other = kIdentity;
  other.seed = 6;
  EXPECT_NE(refused(same, other).find("different seed: 5, but this run has 6"), std::string::npos);
  other = kIdentity;
  other.version = "1.1";
  EXPECT_NE(refused(same, other).find("different version"), std::string::npos);
  other = kIdentity;
  other.is_smoke = true;
  EXPECT_NE(refused(same, other).find("different smoke"), std::string::npos);
  other = kIdentity;
  other.planning_share = 0.2;
  EXPECT_NE(refused(same, other).find("different planning_share"), std::string::npos);
  other = kIdentity;
  other.experiment = "other";
  EXPECT_NE(refused(same, other).find("different experiment"), std::string::npos);
  EXPECT_NE(refused(deeper, kIdentity).find("different settings_sha256"), std::string::npos);
  EXPECT_EQ(refused(same, kIdentity), "");
}

TEST_F(Sweeps, RefuseAFolderWithForeignFiles) {
  fs::create_directories(dir("full"));
  std::ofstream(fs::path(dir("full")) / "thesis.tex") << "chapter";
  EXPECT_NE(refusal_of([&] { run("full"); }).find("is not empty"), std::string::npos);
  EXPECT_EQ(runs_since(), 0);
  fs::create_directories(dir("empty"));
  EXPECT_EQ(refusal_of([&] { run("empty"); }), "");
  std::ofstream(fs::path(dir("empty")) / "manifest.json") << "{\"exper";
  EXPECT_NE(refusal_of([&] { run("empty"); }).find("not the manifest"), std::string::npos);
}

TEST_F(Sweeps, RefuseInvalidRows) {
  run("a");
  const fs::path rows = only_rows_file(dir("a"));
  const std::string all = text_of(rows);
  std::string damaged = all;
  damaged[all.find("small")] = '\n';  // within the second line
  std::ofstream(rows) << damaged;
  EXPECT_NE(refusal_of([&] { run("a"); }).find(":2: not a row"), std::string::npos);
  std::ofstream(rows) << all;
  std::string twice = all;
  twice.replace(twice.find("7.142857"), 8, "7.142858");
  std::ofstream(rows.parent_path() / "another.jsonl") << twice;
  EXPECT_NE(refusal_of([&] { run("a"); }).find("twice with different rows"), std::string::npos);
}

// Shards on separate machines write separate directories. The rows of these directories are then
// copied into one.
TEST_F(Sweeps, RefuseRowsOfAnotherRun) {
  const auto share = [&](const std::string& name, int number, const SweepIdentity& identity) {
    SweepOptions options;
    options.directory = dir(name);
    options.shard = Shard{number, 2};
    run_sweep(counting_sweep(runs_), identity, "Counting", options);
    return fs::path(dir(name)) / "rows";
  };
  SweepIdentity newer = kIdentity;
  newer.version = "1.0+abd";
  const fs::path first = share("a", 1, kIdentity);
  const fs::path second = share("b", 2, kIdentity);
  const fs::path other = share("c", 2, newer);
  fs::copy(other, first);
  EXPECT_NE(refusal_of([&] { run("a"); }).find("different version: \"1.0+abd\""),
            std::string::npos);
  fs::remove(first / only_rows_file(dir("c")).filename());
  fs::copy(second, first);
  EXPECT_EQ(refusal_of([&] { run("a"); }), "");
}

TEST_F(Sweeps, KeepCompleteLinesOnAFullDisk) {
  run("whole");
  const std::string all = text_of(only_rows_file(dir("whole")));
  const std::size_t first = all.find('\n') + 1;
  const std::size_t second = all.find('\n', first) + 1;
  const std::size_t third = all.find('\n', second) + 1;
  fs::create_directories(dir("full"));
  const SweepPlan plan = counting_sweep(runs_).plan;
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  const auto old_handler = ::signal(SIGXFSZ, SIG_IGN);
  {
    RowWriter writer(dir("full"), this_process(1, {}), kIdentity, plan);
    const rlimit full{fs::file_size(only_rows_file(dir("full"))) + 20, before.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &full);
    EXPECT_THROW(writer.append(all.substr(first, second - first - 1)), std::runtime_error);
    ::setrlimit(RLIMIT_FSIZE, &before);
    writer.append(all.substr(second, third - second - 1));
    writer.append(all.substr(first, second - first - 1));
  }
  ::signal(SIGXFSZ, old_handler);
  const StoredRows stored = read_rows(dir("full"), plan, kIdentity);
  EXPECT_EQ(stored.done.size(), 2U);
  EXPECT_EQ(stored.torn, 0U);
}

// Several processes start simultaneously, so some create their rows before others have checked the
// directory.
TEST_F(Sweeps, AllowSimultaneousShards) {
  const SweepPlan plan = counting_sweep(runs_).plan;
  for (int turn = 0; turn < 100; ++turn) {
    const std::string directory = dir(fmt::format("t{}", turn));
    std::vector<pid_t> shards;
    for (int shard = 0; shard < 8; ++shard) {
      const pid_t child = ::fork();
      if (child == 0) {
        try {
          claim_directory(directory, kIdentity, plan);
          RowWriter writer(directory, this_process(1, {shard + 1, 8}), kIdentity, plan);
          ::_exit(0);
        } catch (const std::exception& error) {
          std::fprintf(stderr, "%s\n", error.what());
        }
        ::_exit(1);
      }
      shards.push_back(child);
    }
    for (const pid_t child : shards) {
      int status = 0;
      ::waitpid(child, &status, 0);
      ASSERT_EQ(status, 0) << "turn " << turn;
    }
  }
}

TEST(Sample, MatchesATextbookExample) {
  Sample sample;
  for (const double value : {2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0}) {
    sample.add(value);
  }
  EXPECT_DOUBLE_EQ(sample.mean(), 5.0);
  EXPECT_NEAR(sample.deviation(), std::sqrt(32.0 / 7.0), 1e-12);
  EXPECT_NEAR(sample.half_interval(), 2.365 * std::sqrt(32.0 / 7.0 / 8.0), 1e-12);
  EXPECT_EQ(Sample().mean(), 0.0);
}

TEST(UnitsOf, DividesUnitsAmongShardsAndSpreadsSettings) {
  SweepPlan plan;
  plan.settings = {{"a"}, {"b", true}, {"c"}};
  plan.trials = 10;
  std::set<Unit> all;
  std::size_t count = 0;
  for (int number = 1; number <= 4; ++number) {
    std::map<std::size_t, int> by_setting;
    for (const Unit& unit : units_of(plan, {number, 4})) {
      all.insert(unit);
      ++count;
      ++by_setting[unit.setting];
    }
    EXPECT_GE(by_setting[0], 2) << number;
    EXPECT_GE(by_setting[2], 2) << number;
  }
  EXPECT_EQ(count, 21U);
  EXPECT_EQ(all.size(), 21U);
}

TEST(ProgressText, ContainsShareAndRemainingTime) {
  EXPECT_EQ(progress_text({90, 37, 17, 100.0, false}), "41 % 37 of 90 units, 4 min 25 s left");
  EXPECT_EQ(progress_text({90, 17, 17, 3.0, false}), "18 % 17 of 90 units, … left");
  EXPECT_EQ(progress_text({10, 10, 0, 3.0, false}), "100 % 10 of 10 units, 0 s left");
  EXPECT_EQ(progress_text({1000, 1, 0, 30.0, false}), "0 % 1 of 1000 units, 8 h 19 min left");
}

TEST(Compare, ReportsTheDeviation) {
  Sample sample;
  sample.add(1.0);
  sample.add(3.0);
  EXPECT_EQ(compare_number("x", sample, 0.5, "m").deviation, "+1.5 m (× 4), within our interval");
  EXPECT_EQ(compare_range("x", 70.0, 80.0, 92.0, "%").deviation, "10 % below the range");
  EXPECT_EQ(compare_range("x", 85.0, 80.0, 92.0, "%").deviation,
            "none: within the published range");
  EXPECT_EQ(compare_claim("x", "1", "> 2", false).deviation, "**does not hold here**");
}

}  // namespace
}  // namespace vantage::experiments
