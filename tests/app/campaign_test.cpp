// SPDX-License-Identifier: BSD-3-Clause
//
// `impactrig campaign` as a user sees it: results, summary, what is reused, what fails.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "tests/app/command_line.hpp"

namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

using impactrig::tests::Outcome;
using impactrig::tests::rig;
using impactrig::tests::samples;
using impactrig::tests::text_of;

// No more of the record than the contact, and modes enough for a restitution within its bounds.
const std::vector<std::string> quick = {"--set", "solver.model=hybrid",
                                        "--set", "solver.modes=12",
                                        "--set", "solver.duration=\"0.4 ms\""};

class CampaignCommand : public impactrig::tests::CommandLine {
 protected:
  std::string shots() const {
    std::string all;
    for (const char* name : {"1.uff", "2.uff", "3.csv", "4.csv"})
      all += samples + "shen2007-" + name + " ";
    return all;
  }

  std::string command(const std::string& recordings) const {
    std::string text = "campaign " + recordings + " --rig " + rig + " -o " + path("out");
    for (const std::string& word : quick) text += " '" + word + "'";
    return text;
  }

  json summary() const { return json::parse(text_of(path("out/summary.json"))); }
};

TEST_F(CampaignCommand, DryRunSaysWhatWouldBeDoneAndDoesNothing) {
  const std::string one = samples + "shen2007-1.uff ", two = samples + "shen2007-2.uff ";
  const Outcome before = run(command(one + path("missing.uff")) + " --dry-run");
  EXPECT_EQ(before.code, 0) << before.err;
  EXPECT_THAT(before.out, HasSubstr("fit        " + one));
  EXPECT_THAT(before.out, HasSubstr("fail       " + path("missing.uff")));
  EXPECT_THAT(before.out, testing::EndsWith("2 recordings: 1 to fit, 1 that cannot be read\n"));
  EXPECT_FALSE(fs::exists(path("out")));
  ASSERT_EQ(run(command(one)).code % 6, 0);
  fs::copy_file(samples + "shen2007-1.uff", path("copy.uff"));
  const Outcome after = run(command(one + two + path("copy.uff")) + " --dry-run --json");
  const json plan = json::parse(after.out);
  EXPECT_EQ(plan["schema"], "impactrig/campaign-plan/1");
  ASSERT_EQ(plan["recordings"].size(), 3U);
  EXPECT_EQ(plan["recordings"][0]["action"], "reuse");
  EXPECT_EQ(plan["recordings"][0]["result"], path("out") + "/fits/shen2007-1.uff.json");
  EXPECT_EQ(plan["recordings"][1]["action"], "fit");
  EXPECT_EQ(plan["recordings"][2]["action"], "leave out");
  EXPECT_THAT(plan["recordings"][2]["sentence"].get<std::string>(), HasSubstr("same recording"));
  EXPECT_EQ(summary()["shots"].size(), 1U);
  const std::string other = command(one) + " --fix contact.stiffness_factor --dry-run";
  EXPECT_THAT(run(other).out, HasSubstr("refuse     " + one));
  EXPECT_THAT(run(other + " --force").out, HasSubstr("replace    " + one));
  EXPECT_FALSE(fs::exists(path("out/fits/shen2007-2.uff.json")));
}

TEST_F(CampaignCommand, FitsEachByItselfAndReusesAllTheSecondTime) {
  const Outcome first = run(command(shots()));
  ASSERT_TRUE(first.code == 0 || first.code == 6) << first.err;
  EXPECT_THAT(first.err, HasSubstr("4 recordings: 0 results reused, 4 to fit"));
  EXPECT_THAT(first.out, HasSubstr("4 of 4 recordings fitted"));
  const json once = summary();
  EXPECT_EQ(once["schema"], "impactrig/campaign/1");
  ASSERT_EQ(once["shots"].size(), 4U);
  for (const json& shot : once["shots"]) {
    EXPECT_TRUE(fs::exists(path("out/" + shot["result"].get<std::string>())));
    EXPECT_TRUE(fs::exists(path("out/" + shot["report"].get<std::string>())));
  }
  EXPECT_EQ(once["quantities"][0]["name"], "contact.restitution");
  EXPECT_FALSE(fs::exists(path("out/failed.json")));
  EXPECT_THAT(text_of(path("out/index.html")), HasSubstr("reports/shen2007-3.csv.html"));
  // a result is what fit -o writes: report takes it
  EXPECT_EQ(run("report " + path("out/fits/shen2007-1.uff.json") + " -o " + path("one.html")).code,
            0);
  const auto written = fs::last_write_time(path("out/fits/shen2007-1.uff.json"));
  const Outcome second = run(command(shots()));
  EXPECT_EQ(second.code, first.code);
  EXPECT_THAT(second.err, HasSubstr("4 recordings: 4 results reused, 0 to fit"));
  EXPECT_EQ(fs::last_write_time(path("out/fits/shen2007-1.uff.json")), written);
  EXPECT_EQ(summary()["shots"], once["shots"]);
  EXPECT_EQ(summary()["quantities"], once["quantities"]);
}

TEST_F(CampaignCommand, GivesWhatAFitOfOneRecordingGives) {
  const std::string one = samples + "shen2007-1.uff";
  ASSERT_NE(run(command(one)).code, 5);
  std::string fit = "fit " + one + " --rig " + rig + " -o " + path("one.json");
  for (const std::string& word : quick) fit += " '" + word + "'";
  ASSERT_NE(run(fit).code, 5);
  const json alone = json::parse(text_of(path("one.json")));
  const json among = json::parse(text_of(path("out/fits/shen2007-1.uff.json")));
  EXPECT_EQ(among["parameters"], alone["parameters"]);
  EXPECT_EQ(among["provenance"]["result_key"], alone["provenance"]["result_key"]);
}

TEST_F(CampaignCommand, ABrokenRecordingFailsAloneAndIsTriedAgain) {
  fs::create_directories(path("in"));
  fs::copy_file(samples + "shen2007-1.uff", path("in/a.uff"));
  fs::copy_file(samples + "shen2007-3.csv", path("in/c.csv"));
  fs::copy_file(rig, path("in/rig.toml"));  // no recording: not taken for one
  write("in/b.csv", "Time [s],Force [N],Velocity [m/s]\n0,1,2\n1e-6,x,2\n");
  const Outcome o = run(command(path("in")));
  EXPECT_EQ(o.code, 5) << o.err;
  EXPECT_THAT(o.out, HasSubstr("2 of 3 recordings fitted"));
  const json failed = json::parse(text_of(path("out/failed.json")));
  ASSERT_EQ(failed["failed"].size(), 1U);
  EXPECT_EQ(failed["failed"][0]["file"], path("in/b.csv"));
  EXPECT_THAT(failed["failed"][0]["sentence"].get<std::string>(), HasSubstr("b.csv"));
  EXPECT_EQ(summary()["shots"].size(), 2U);
  EXPECT_THAT(text_of(path("out/summary.csv")), HasSubstr("b.csv,failed,"));
  fs::copy_file(samples + "shen2007-4.csv", path("in/b.csv"), fs::copy_options::overwrite_existing);
  const Outcome mended = run(command(path("in")));
  EXPECT_NE(mended.code, 5) << mended.err;
  EXPECT_THAT(mended.err, HasSubstr("3 recordings: 2 results reused, 1 to fit"));
  EXPECT_FALSE(fs::exists(path("out/failed.json")));
}

// A shot that a full disk lost is what a summary is looked at for.
TEST_F(CampaignCommand, EmptyFilesOfAFolderHaveFailed) {
  fs::create_directories(path("in"));
  fs::copy_file(samples + "shen2007-1.uff", path("in/a.uff"));
  for (const char* name : {"in/b.csv", "in/c.h5", "in/d.TDMS", "in/notes.md", "in/lock"})
    write(name, "");
  const Outcome plan = run(command(path("in")) + " --dry-run");
  EXPECT_THAT(plan.out, HasSubstr("fail       " + path("in/b.csv") + "   "));
  EXPECT_THAT(plan.out, HasSubstr("4 recordings: 1 to fit, 3 that cannot be read"));
  const Outcome o = run(command(path("in")) + " --no-reports");
  EXPECT_EQ(o.code, 5) << o.err;
  EXPECT_THAT(o.out, HasSubstr("1 of 4 recordings fitted"));
  const json failed = json::parse(text_of(path("out/failed.json")))["failed"];
  ASSERT_EQ(failed.size(), 3U);
  EXPECT_EQ(failed[1]["file"], path("in/c.h5"));
  for (const json& one : failed)
    EXPECT_THAT(one["sentence"].get<std::string>(), HasSubstr("the file is empty"));
}

TEST_F(CampaignCommand, NamesThatCollideAreKeptApartAndCopiesCountOnce) {
  for (const char* day : {"monday", "tuesday"}) fs::create_directories(path(day));
  fs::copy_file(samples + "shen2007-1.uff", path("monday/shot.uff"));
  fs::copy_file(samples + "shen2007-2.uff", path("tuesday/shot.uff"));
  fs::copy_file(samples + "shen2007-2.uff", path("tuesday/copy.uff"));
  const Outcome o = run(command(path("monday") + " " + path("tuesday")) + " --no-reports");
  EXPECT_NE(o.code, 5) << o.err;
  EXPECT_TRUE(fs::exists(path("out/fits/monday_shot.uff.json")));
  EXPECT_THAT(o.out, HasSubstr("left out: " + path("tuesday/shot.uff") +
                               ": is the same recording as " + path("tuesday/copy.uff")));
  EXPECT_EQ(summary()["shots"].size(), 2U);
  EXPECT_FALSE(fs::exists(path("out/reports")));
}

TEST_F(CampaignCommand, DoesNotReplaceResultsOfOtherOptionsUnasked) {
  const std::string one = command(samples + "shen2007-1.uff");
  ASSERT_NE(run(one).code, 5);
  const Outcome other = run(one + " --window 3e-4");
  EXPECT_EQ(other.code, 4);
  EXPECT_THAT(other.err, HasSubstr("holds 1 of 1 results that were made from other recordings, "
                                   "options or by another version; choose another folder, or add "
                                   "--force"));
  const Outcome forced = run(one + " --window 3e-4 --force");
  EXPECT_THAT(forced.err, HasSubstr("1 to fit"));
  EXPECT_NE(forced.code, 4);
}

// As after a full disk: what is no JSON is no result of anything else.
TEST_F(CampaignCommand, MakesABrokenResultAnew) {
  const std::string one = command(samples + "shen2007-1.uff");
  ASSERT_NE(run(one).code, 5);
  const std::string result = path("out/fits/shen2007-1.uff.json");
  const std::string whole = text_of(result);
  write("out/fits/shen2007-1.uff.json", whole.substr(0, whole.size() / 2));
  EXPECT_THAT(run(one + " --dry-run").out, HasSubstr("fit        "));
  const Outcome again = run(one);
  EXPECT_THAT(again.err, HasSubstr("0 results reused, 1 to fit"));
  EXPECT_EQ(json::parse(text_of(result))["parameters"], json::parse(whole)["parameters"]);
}

// Nothing could come of it, and a wish is not dropped in silence.
TEST_F(CampaignCommand, RefusesToShareBetweenRecordings) {
  const Outcome o = run(command(shots()) + " --shared contact.restitution");
  EXPECT_EQ(o.code, 2);
  EXPECT_THAT(o.err, HasSubstr("--shared: a campaign fits every recording by itself"));
  EXPECT_FALSE(fs::exists(path("out")));
}

TEST_F(CampaignCommand, RefusesAFolderOfSomethingElse) {
  fs::create_directories(path("out"));
  write("out/letter.txt", "dear colleague");
  const Outcome o = run(command(samples + "shen2007-1.uff"));
  EXPECT_EQ(o.code, 4);
  EXPECT_THAT(o.err, HasSubstr("is a folder with something else in it"));
}

TEST_F(CampaignCommand, NeverOverwritesWhatItReads) {
  const std::string shot = samples + "shen2007-3.csv ";
  fs::create_directories(path("out/fits"));
  const std::vector<std::string> written = {path("out/summary.csv"), path("out/failed.json"),
                                            path("out/fits/shen2007-3.csv.json")};
  for (const std::string& file : written) {
    fs::copy_file(samples + "shen2007-4.csv", file);
    for (const char* const how : {" -f", " --dry-run -f"}) {
      const Outcome o = run(command(shot + file) + how);
      EXPECT_EQ(o.code, 4) << file << how;
      EXPECT_THAT(o.err, HasSubstr(file + ": is read by this command")) << file << how;
    }
    EXPECT_EQ(text_of(file), text_of(samples + "shen2007-4.csv"));
    fs::remove(file);
  }
}

TEST_F(CampaignCommand, ABadRigFileFailsBeforeTheWork) {
  const Outcome o = run(command(shots()) + " --set beam.lenght='\"1 m\"'");
  EXPECT_EQ(o.code, 3);
  EXPECT_FALSE(fs::exists(path("out")));
}

TEST_F(CampaignCommand, GoesOnWhereItWasInterrupted) {
  std::vector<std::string> words = {IMPACTRIG_PROGRAM, "campaign"};
  for (const char* name : {"1.uff", "2.uff", "3.csv", "4.csv"})
    words.push_back(samples + "shen2007-" + name);
  for (const std::string& word :
       {std::string("--rig"), rig, std::string("-o"), path("out"), std::string("-j1")})
    words.push_back(word);
  words.insert(words.end(), quick.begin(), quick.end());
  const pid_t process = fork();
  ASSERT_GE(process, 0);
  if (process == 0) {
    std::freopen(path("stderr").c_str(), "w", stderr);
    std::freopen(path("stdout").c_str(), "w", stdout);
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    execv(IMPACTRIG_PROGRAM, arguments.data());
    _exit(127);
  }
  // as soon as there is a first result
  for (int i = 0; i < 6000 && !fs::exists(path("out/fits/shen2007-1.uff.json")); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  kill(process, SIGINT);
  int status = 0;
  waitpid(process, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 130);
  EXPECT_THAT(text_of(path("stderr")), HasSubstr("the same command goes on from there"));
  EXPECT_FALSE(fs::exists(path("out/summary.json")));
  for (const auto& entry : fs::directory_iterator(path("out/fits")))
    EXPECT_NE(entry.path().extension(), ".part");
  const Outcome again = run(command(shots()));
  EXPECT_NE(again.code, 5) << again.err;
  EXPECT_THAT(again.err, Not(HasSubstr("4 recordings: 0 results reused")));
  EXPECT_EQ(summary()["shots"].size(), 4U);
}

}  // namespace
