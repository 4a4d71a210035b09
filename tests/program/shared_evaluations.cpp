// evaluate of SINC, TEACH, classifiers, TM2T's descriptions and moments by several processes under mpirun, metrics of
// Guo et al., and film strips: the bytes of one process.
#include <doctest/doctest.h>

#include <map>

#include "babel_sequences.hpp"
#include "described_walks.hpp"
#include "mpirun.hpp"

namespace {

using Files = std::map<std::string, std::string>;

/// The files of a folder, which is removed.
Files taken_files(const std::filesystem::path& folder) {
  Files out;
  for (const auto& f : std::filesystem::directory_iterator(folder))
    out[f.path().filename().string()] = ml::read_file(f.path());
  std::filesystem::remove_all(folder);
  return out;
}

/// Checks that these processes write the film strips of one, and print its table.
template <class Folder>
void check_strips(const UnderMpirun<Folder>& w, const std::string& arguments, std::size_t files) {
  const std::string alone = w.table(0, arguments + " --strips strips");
  const Files strips = taken_files(w / "strips");
  CHECK(strips.size() == files);
  for (const int processes : {1, 2, 3}) {
    CAPTURE(arguments);
    CAPTURE(processes);
    CHECK(w.table(processes, arguments + " --strips strips") == alone);
    CHECK(taken_files(w / "strips") == strips);
  }
}

const std::string tiny =
    settings({"optimiser.epochs=1", "optimiser.batch=4", "network.latent_dim=8", "network.ff_size=8",
              "network.num_layers=1", "network.num_heads=2", "text.width=8", "text.vocabulary=60"});

}  // namespace

TEST_CASE("SINC, TEACH and moments of BABEL's sequences") {
  const UnderMpirun<Sequences> w;
  const std::string babel = " --data . --babel babel.json --spelling spelling.json";
  for (const std::string system : {"sinc", "teach"}) w.train("train-" + system + babel + " --out " + system + tiny);
  const std::string sinc = "sinc/model" + babel + " --part all --items all --temos sinc/model --body-parts parts.json" +
                           " --samples 2 --count 3";
  CHECK(contains(w.table(0, sinc), "labels alone, composed"));
  check_strips(w, sinc, 6);
  w.same_table({2}, "sinc/model" + babel + " --splits splits --part training --samples 1");  // its own random clips
  check_strips(w, "teach/model" + babel + " --part all --independent sinc/model --joint sinc/model --samples 2", 4);

  std::string captions;
  for (int i = 1; i <= 6; ++i) {
    ml::write_bvh(w / ("clip" + std::to_string(i) + ".bvh"), synthetic::walk({.frames = 60, .turn = 0.2 * i}));
    captions += "clip" + std::to_string(i) + (i % 2 == 0 ? "\twalk | a walk\n" : "\tturn\n");
  }
  ml::write_file(w / "captions.tsv", captions);
  w.train("train-tmr --data . --captions captions.tsv --out tmr" + tiny +
          settings({"data.min_seconds=0.5", "data.mirror=false"}));
  CHECK(contains(w.same_table({1, 2, 3}, "tmr/model" + babel + " --part all --stride 0.5"), "20 texts in 5 sequences"));
  CHECK(contains(w.same_table({1, 2, 3},
                              "tmr/model --data . --captions captions.tsv --part training --moments 5 "
                              "--joined 2 --windows 0.5,1"),
                 "10 texts in 5 motions"));
}

TEST_CASE("classifiers, and film strips of ACTOR and TEMOS") {
  const UnderMpirun<Clips> w;
  const std::string data = " --data . --labels labels.tsv", texts = " --data . --captions captions.tsv",
                    split = settings({"data.min_seconds=0.5", "data.test_share=0.25", "data.validation_share=0.25"});
  w.train("train-classifier --out classifier" + data + split +
          settings({"optimiser.epochs=1", "hidden_size=8", "clips.num_frames=12"}));
  w.train("train-actor --out actor" + data + split +
          settings({"optimiser.epochs=1", "network.latent_dim=8", "network.ff_size=8", "network.num_layers=1",
                    "network.num_heads=2", "clips.num_frames=12"}));
  w.train("train-temos --out temos" + texts + split + tiny + settings({"data.mirror=false"}));
  CHECK(contains(w.same_table({1, 2, 3}, "classifier/model --seeds 5 --part training" + data), "accuracy %"));
  check_strips(w, "actor/model --classifier classifier/model --seeds 2 --part training" + data, 2);
  check_strips(w, "temos/model --samples 2 --part training" + texts, 4);
  check_strips(w, "temos/model --samples 1 --part training --count 1" + texts, 2);
}

TEST_CASE("metrics of Guo et al., descriptions of TM2T, and generated motions that are searched") {
  const UnderMpirun<TemporaryFolder> w;
  write_walks((w / "h3d").string());
  const std::string data = " --data h3d", few = settings({"optimiser.epochs=1", "optimiser.warmup=0"});
  const std::string evaluator =
      few + settings({"movement.hidden=16", "movement.latent=16", "matching.text_hidden=16",
                      "matching.motion_hidden=24", "matching.embedding=16", "matching.word_width=8"});
  w.train("train-evaluator --stage movement --out movement" + data + evaluator);
  w.train("train-evaluator --stage matching --out matching --movement movement/model" + data + evaluator);
  for (const std::string system : {"temos", "tmr"}) w.train("train-" + system + " --out " + system + data + tiny);
  const std::string tm2t = data + few +
                           settings({"tokenizer.codes=12", "tokenizer.residual_blocks=1", "tokenizer.window=28",
                                     "motion_to_text.latent_dim=16", "motion_to_text.ff_size=16",
                                     "motion_to_text.num_layers=1", "motion_to_text.num_heads=2"}) +
                           " --set 'tokenizer.channels=[8, 8]'";
  w.train("train-tm2t --stage tokenizer --out tokenizer" + tm2t);
  w.train("train-tm2t --stage motion-to-text --tokenizer tokenizer/model --out describer" + tm2t +
          settings({"optimiser.epochs=60", "optimiser.schedule=constant", "optimiser.lr=0.005"}));  // short texts
  write_distilbert(w / "bert");

  const std::string part = data + " --part training", judge = " --evaluator matching/model";
  const std::string guo = w.same_table({1, 2, 3}, "temos/model --seeds 3 --repeats 11" + judge + part);
  CHECK(contains(guo, "multimodality of 6 texts"));
  const std::string described =
      w.same_table({1, 2, 3}, "describer/model --bert bert --bert-baseline random" + judge + part);
  CHECK(contains(described, "BERTScore"));
  CHECK(contains(described, "R@1"));
  for (const std::string model : {"tmr", "matching"})
    CHECK(contains(w.same_table({1, 2, 3}, model + "/model --synthesis --generator temos/model" + part),
                   "\n    generated"));
}
