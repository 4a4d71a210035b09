// generate, evaluate, index, search and judge by several processes under mpirun: the bytes of one process. Built where
// MPI is installed. `run` starts a shell here.
#include <doctest/doctest.h>

#include <motionlang/backend/eigen.hpp>

#include "../support/official_folders.hpp"
#include "../support/small_model.hpp"
#include "mpirun.hpp"
#include "training_clips.hpp"

namespace {

using Shared = UnderMpirun<Clips>;

}  // namespace

TEST_CASE("several processes index and search: the bytes of one process") {
  const Shared w;
  const std::string shards = "index . --captions captions.tsv --shard-mib 0.03125 --stride 0.05 --threads 1 -o ",
                    file = "index . --threads 1 -o ";
  const std::string made = w.printed(0, shards + "alone");
  w.printed(0, file + "alone.index");
  REQUIRE(std::filesystem::exists(w / "alone/shard-00001.index"));
  for (const int processes : {1, 2, 3}) {
    const std::string out = "by" + std::to_string(processes);
    CHECK(w.printed(processes, shards + out).substr(3) == made.substr(5));
    for (const auto& entry : std::filesystem::directory_iterator(w / "alone"))
      CHECK(ml::read_file(w.path / out / entry.path().filename()) == ml::read_file(entry.path()));
    w.printed(processes, file + out + ".index");
    CHECK(ml::read_file(w / (out + ".index")) == ml::read_file(w / "alone.index"));
  }
  for (const std::string query :
       {"alone 'a person walks' --moments --json", "alone 'a person turns left' --top 3",
        "alone 'someone walks' --captions", "alone --like clip3.bvh --moments", "alone.index 'a person walks'"}) {
    const std::string answer = w.printed(0, "search " + query);
    for (const int processes : {2, 3}) CHECK(w.printed(processes, "search " + query) == answer);
  }
  std::filesystem::remove(w / "alone/shard-00001.index");
  const Outcome missing = w.call(2, "search alone walk");
  CHECK(missing.code == 1);
  CHECK_MESSAGE(contains(missing.text, "shard-00001.index is missing: shard 2 of "), missing.text);
}

TEST_CASE("several processes judge: the output of one process") {
  const Shared w;
  const std::string judge = "judge --bench own --seeds 3 --steps 2 --details --threads 1";
  const std::string alone = w.printed(0, judge);
  CHECK(contains(alone, "walk"));
  CHECK(w.printed(2, judge) == alone);
  const Outcome refused = w.call(2, "judge --compare 2");
  CHECK(refused.code == 2);
  CHECK_MESSAGE(contains(refused.text, "judge --compare runs in one process, not in 2"), refused.text);
}

TEST_CASE("several processes generate: the files and the output of one process, in the order of the input") {
  const Shared w;
  const auto config = small::config(5);
  ml::save_stmc(w / "model.safetensors", small::model<ml::EigenBackend<float>>(config), config, {{"license", "MIT"}});
  ml::write_file(w / "list.txt",
                 std::string_view("walk forward # 0 # 1 # legs\nraise both arms # 0.2 # 0.8 # left arm\n"
                                  "\nwave # 0 # 2\n\nturn # 0 # 0.5\nblorp # 0.5 # 1\n"));
  const auto files = [&] {
    std::map<std::string, std::string> out;
    for (const auto& f : std::filesystem::directory_iterator(w / "out"))
      out[f.path().filename().string()] = ml::read_file(f.path());
    std::filesystem::remove_all(w / "out");
    return out;
  };
  const std::string generate = "generate --model model.safetensors --out out --threads 1 --seed 4 --timeline ";
  for (const std::string how : {"list.txt", "list.txt --samples 2 --overlay-arms", "list.txt --mode sinc"}) {
    const std::string alone = w.printed(0, generate + how);
    const auto made = files();
    REQUIRE(made.contains("list.html"));
    for (const int processes : {2, 3}) {
      CAPTURE(processes);
      CHECK(w.printed(processes, generate + how) == alone);
      CHECK(files() == made);
    }
  }
  const std::string alone = w.printed(0, generate + "- < list.txt");
  const auto made = files();
  CHECK(w.printed(2, generate + "- < list.txt") == alone);
  CHECK(files() == made);
  ml::write_file(w / "plain.txt", std::string_view("wave # 0 # 1\n\nwalk # 0 # 1\n"));  // no body parts
  const Outcome said = w.call(0, generate + "plain.txt --guess-parts > none"),
                once = w.call(2, generate + "plain.txt --guess-parts > none");
  CHECK_MESSAGE(contains(said.text, "wave"), said.text);
  const auto notes = [](const Outcome& o) { return o.text.substr(0, o.text.find("generating")); };
  CHECK(notes(once) == notes(said));
  files();
  const Outcome record = w.call(2, generate + "list.txt --record");
  CHECK(record.code == 2);
  CHECK_MESSAGE(contains(record.text, "[motionlang.config.102] --record is a file of all timelines"), record.text);
}

TEST_CASE("a list whose motions depend on each other is refused, and no process waits") {
  const Shared w;
  auto sizes = official::small();
  sizes.mdm.arch = ml::MdmArch::gru;  // goes over the motions of a batch, as published
  official::write_mdm_run(w / "mdm", sizes);
  official::write_clip(w / "clip", sizes);
  ml::write_file(w / "list.txt", std::string_view("walk # 0 # 1\n\nwalk # 0 # 1\n"));
  const std::string generate = "generate --model mdm --steps 2 --threads 1 --timeline list.txt";
  CHECK(w.call(0, generate + " --out alone").code == 0);
  for (const int processes : {2, 3}) {
    const Outcome refused = w.call(processes, generate + " --out out");
    CHECK(refused.code == 2);
    CHECK_MESSAGE(contains(refused.text, "[motionlang.config.102] a motion of this model depends on the other"),
                  refused.text);
    CHECK_FALSE(std::filesystem::exists(w / "out/list.html"));
  }
  CHECK(w.call(2, "generate --model mdm --steps 2 --threads 1 --text walk").code == 0);  // one motion has no others
}

TEST_CASE("several processes evaluate: the table of one process") {
  const Shared w;
  const auto trained = [&](const std::string& command, const std::string& out, std::vector<std::string> more = {}) {
    std::string line = command + " --data . --out " + out + " --preset small --threads 1";
    line += command == "train-temos" ? " --captions captions.tsv" : " --labels labels.tsv";
    for (const char* a : {"data.min_seconds=0.5", "data.test_share=0.25", "data.validation_share=0.25",
                          "optimiser.batch=2", "optimiser.epochs=1"})
      more.push_back(a);
    for (const std::string& a : more) line += " --set " + a;
    const Outcome o = w.call(0, line);
    REQUIRE_MESSAGE(o.code == 0, o.text);
  };
  const std::vector<std::string> network{"network.latent_dim=8", "network.ff_size=8", "network.num_layers=1",
                                         "network.num_heads=2"};
  auto actor = network, temos = network;
  actor.push_back("clips.num_frames=12");
  temos.insert(temos.end(), {"data.mirror=false", "text.width=8", "text.vocabulary=40"});
  trained("train-actor", "actor", actor);
  trained("train-classifier", "classifier", {"hidden_size=8", "clips.num_frames=12"});
  trained("train-temos", "temos", temos);
  const std::string of_actor = "actor/model --data . --labels labels.tsv --classifier classifier/model --seeds 3";
  for (const std::string& arguments : {of_actor, of_actor + " --durations 8,12",
                                       std::string("temos/model --data . --captions captions.tsv --samples 3")}) {
    CHECK(w.same_table({2, 4}, arguments + " --part training").size() > 100);
  }
}

TEST_CASE("several processes evaluate STMC: the tables of one process") {
  const Shared w;
  const auto config = small::config(5);
  ml::save_stmc(w / "model.safetensors", small::model<ml::EigenBackend<float>>(config), config, {{"license", "MIT"}});
  ml::write_file(w / "texts.txt",
                 std::string_view("walk forward # legs\nraise both arms # left arm # right arm\nturn # legs\n"
                                  "wave # right arm\n"));
  CHECK(contains(w.same_table({2, 3},
                              "model.safetensors --texts texts.txt --first 5 --steps 2 --batch 2 "
                              "--modes stmc,sinc"),
                 "SINC without lerp"));
}
