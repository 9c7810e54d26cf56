#include "experiments/sweep/slurm_job.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <set>
#include <string>
#include <tuple>

#include <gtest/gtest.h>

#include "core/child.hpp"
#include "experiments/sweep/slurm_client.hpp"
#include "test/support/temporary_folder.hpp"

namespace vantage::experiments {
namespace {

// Runs `script` in a shell as array task `task` and returns its output.
std::string said_by(const std::string& script, const std::string& task) {
  const Result<CommandOutput> answer = run_command(
      {"env", "SLURM_ARRAY_TASK_ID=" + task, "sh", "-c", script.substr(script.find('\n'))});
  EXPECT_TRUE(answer.ok() && answer.value().exit.is_success());
  return answer.ok() ? answer.value().text : "";
}

TEST(SlurmScripts, PassArgumentsAndTheShardOfTheTask) {
  const SlurmScripts scripts =
      slurm_scripts({"printf", "<%s>\n", "two words", "it's", "$HOME `ls` \"*\" \\", ""}, 12);
  const std::string words = "<two words>\n<it's>\n<$HOME `ls` \"*\" \\>\n<>\n";
  EXPECT_EQ(said_by(scripts.collect, "3"), words);
  EXPECT_EQ(said_by(scripts.shards, "3"), words + "<--shard>\n<3/12>\n");
  EXPECT_EQ(scripts.shards.substr(0, 10), "#!/bin/sh\n");
}

// The listed shards together contain all missing units, and every listed shard contains at least
// one of them.
TEST(IncompleteShards, ContainAllMissingUnits) {
  std::mt19937 rng(7);
  for (int round = 0; round < 200; ++round) {
    SweepPlan plan;
    plan.settings = {{"a"}, {"b", true}, {"c"}};
    plan.trials = 1 + static_cast<int>(rng() % 5);
    const int of = 1 + static_cast<int>(rng() % 9);
    std::map<Unit, UnitRows> done;
    std::set<Unit> undone;
    for (const Unit& unit : units_of(plan, {})) {
      if (rng() % 2 == 0) {
        done[unit];
      } else {
        undone.insert(unit);
      }
    }
    for (const int shard : incomplete_shards(plan, of, done)) {
      const std::size_t before = undone.size();
      for (const Unit& unit : units_of(plan, {shard, of})) {
        undone.erase(unit);
      }
      EXPECT_LT(undone.size(), before);
    }
    EXPECT_TRUE(undone.empty());
  }
}

TEST(ArrayText, JoinsConsecutiveNumbers) {
  EXPECT_EQ(array_text({}), "");
  EXPECT_EQ(array_text({4}), "4");
  EXPECT_EQ(array_text({1, 2, 3, 7, 9, 10}), "1-3,7,9-10");
}

TEST(JobOf, ParsesJobNumberAndCluster) {
  EXPECT_EQ(job_of("1234\n"), "1234");
  EXPECT_EQ(job_of("sbatch: warning: 12 nodes\n77;east\n"), "77;east");
  EXPECT_EQ(job_of("sbatch: error: invalid partition specified: none\n"), "");
  EXPECT_EQ(job_of(""), "");
}

TEST(StatesOf, ReportWhichJobsMayStillWrite) {
  const auto states = states_of("12_1|RUNNING\n12_2|OUT_OF_MEMORY\n13|PENDING\nnonsense\n");
  ASSERT_EQ(states.size(), 3U);
  EXPECT_TRUE(is_live(states.at("12_1")));
  EXPECT_FALSE(is_live(states.at("12_2")));
  EXPECT_TRUE(is_live(states.at("13")));
  EXPECT_FALSE(is_live("CANCELLED"));
  EXPECT_TRUE(is_failure("CANCELLED"));
  EXPECT_FALSE(is_failure("COMPLETED"));
  EXPECT_FALSE(is_failure("RUNNING"));
  EXPECT_FALSE(is_live(""));
  EXPECT_FALSE(is_failure(""));
}

// The node of a completing job has not answered yet. The job may have ended, or Slurm may run it
// again.
TEST(SlurmState, CompletingJobIsNotReportedAsEnded) {
  EXPECT_TRUE(is_live("COMPLETING"));
  EXPECT_FALSE(is_running_or_pending("COMPLETING"));
  EXPECT_FALSE(is_failure("COMPLETING"));
  EXPECT_TRUE(is_running_or_pending("REQUEUED"));
  EXPECT_FALSE(is_running_or_pending("COMPLETED"));
}

/// Replaces squeue and scancel during its lifetime by programs that record their arguments.
class FakeSlurm {
 public:
  FakeSlurm() {
    for (const char* program : {"squeue", "scancel"}) {
      const std::string path = folder_.file(program);
      std::ofstream(path) << "#!/bin/sh\necho \"$(basename \"$0\") $*\" >> "
                          << folder_.file("words")
                          << "\necho 'CLUSTER: east'\necho '77_1|RUNNING'\necho '78|PENDING'\n";
      std::filesystem::permissions(path, std::filesystem::perms::owner_all);
    }
    ::setenv("PATH", (folder_.path() + ":" + path_before_).c_str(), 1);
  }
  ~FakeSlurm() { ::setenv("PATH", path_before_.c_str(), 1); }
  FakeSlurm(const FakeSlurm&) = delete;
  FakeSlurm& operator=(const FakeSlurm&) = delete;
  FakeSlurm(FakeSlurm&&) = delete;
  FakeSlurm& operator=(FakeSlurm&&) = delete;

  [[nodiscard]] std::string words() const {
    std::ifstream file(folder_.file("words"));
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
  }

 private:
  test::TemporaryFolder folder_;
  std::string path_before_ = std::getenv("PATH");
};

TEST(SlurmClient, UsesTheClusterOfTheJobs) {
  const std::tuple<SlurmJobs, std::string, std::string> cases[] = {
      {{"77", "78", 1}, "", "jobs 77 and 78 are"},
      {{"77;east", "78;east", 1}, "--clusters=east ", "jobs 77 and 78 on cluster east are"}};
  for (const auto& [jobs, option, sentence] : cases) {
    const FakeSlurm fake;
    const Result<SlurmQueue> queue = query_queue(jobs);
    ASSERT_TRUE(queue.ok());
    EXPECT_EQ(queue.value().tasks.at(1), "RUNNING");
    EXPECT_EQ(queue.value().collector, "PENDING");
    cancel_job(jobs.collector, {"--state=PENDING"});
    const std::string arguments =
        std::string("--jobs=77,78") + (option.empty() ? "" : " ") + option;
    EXPECT_NE(fake.words().find(arguments.substr(0, arguments.find_last_not_of(' ') + 1) + "\n"),
              std::string::npos)
        << fake.words();
    EXPECT_NE(fake.words().find("scancel --quiet --state=PENDING " + option + "78\n"),
              std::string::npos)
        << fake.words();
    EXPECT_EQ(cancel_command(jobs), "scancel " + option + "77 78");
    EXPECT_EQ(jobs.subject_and_verb(), sentence);
  }
}

}  // namespace
}  // namespace vantage::experiments
