// train-sinc and train-teach: on made-up sequences in the form of AMASS with labels in that of BABEL, in seconds.
#include <doctest/doctest.h>

#include <numeric>

#include <motionlang/formats/bvh.hpp>
#include <motionlang/weights/embedding_cache.hpp>

#include "babel_sequences.hpp"

namespace {

double mean(std::span<const float> x) {
  return std::accumulate(x.begin(), x.end(), 0.0) / static_cast<double>(x.size());
}

std::vector<std::string> operator+(std::vector<std::string> a, const std::vector<std::string>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

const std::vector<std::string> all{"--babel", "babel.json", "--splits", "splits"};
const std::vector<std::string> combined{"--body-parts", "parts.json", "--set", "data.proportion=0.5"};

}  // namespace

TEST_CASE("train-sinc and train-teach lower their losses and leave models; two halves make the same weights") {
  const Sequences w;
  struct Case {
    std::string command, counts, labels, term;
    int steps_of_epoch;
    std::vector<std::string> more;
  };
  const std::string recons = "recons_rfeats2rfeats";
  for (const Case& c : {Case{"train-sinc", "16 motions to train on, 5 for validation, 5 for tests; 5 left out",
                             "5 different labels", recons, 4, combined},
                        Case{"train-teach",
                             "6 motions to train on, 2 for validation, 2 for tests; 0 left out",
                             "3 different labels",
                             recons + "_1",
                             2,
                             {}}}) {
    CAPTURE(c.command);
    const std::string whole = c.command + "_whole", halves = c.command + "_halves";
    const auto epochs = [&](const char* number) {
      return all + c.more + std::vector<std::string>{"--set", std::string("optimiser.epochs=") + number};
    };
    const auto done = w.train(c.command, whole, epochs("30"));
    REQUIRE_MESSAGE(done.code == 0, done.text);
    CHECK_MESSAGE(contains(done.text, c.counts), done.text);
    CHECK_MESSAGE(contains(done.text, c.labels), done.text);
    const auto losses = w.losses(whole);
    REQUIRE(losses.size() == static_cast<std::size_t>(30 * c.steps_of_epoch));
    CHECK(mean(std::span(losses).last(10)) < 0.9 * mean(std::span(losses).first(10)));
    const std::string curves = ml::read_file(w / (whole + "/loss.svg"));
    for (const std::string& part : {std::string("validation"), ">" + c.term + " "})
      CHECK_MESSAGE(contains(curves, part), part);

    REQUIRE(w.train(c.command, halves, epochs("13")).code == 0);
    const auto rest = w.train(c.command, halves, epochs("30") + std::vector<std::string>{"--recompute"});
    REQUIRE_MESSAGE(rest.code == 0, rest.text);
    CHECK_MESSAGE(contains(rest.text, "continuing at step " + std::to_string(13 * c.steps_of_epoch)), rest.text);
    CHECK(w.losses(halves) == losses);
    CHECK(w.weights(halves) == w.weights(whole));
  }

  for (const char* frames : {"network.hist_frames=1", "network.hist_frames=10"}) {  // thesis table A.3
    const auto done = w.train("train-teach", frames, all + std::vector<std::string>{"--set", frames});
    CHECK_MESSAGE(done.code == 0, done.text);
  }
  CHECK(w.weights("network.hist_frames=1") != w.weights("network.hist_frames=10"));

  // actions at the same time as one sentence; actions one after the other with a gap that is filled
  const auto made = [&](const std::string& name, const std::string& timeline) {
    ml::write_file(w / "timeline.txt", timeline);
    const auto out =
        run({"generate", "--model", name + "_whole/model", "--timeline", "timeline.txt", "--out", name}, w.path);
    REQUIRE_MESSAGE(out.code == 0, out.text);
    return ml::read_bvh_motion(w / (name + "/timeline.bvh"));
  };
  const std::string both = "walk # 0 # 2 # legs\nwave # 0 # 2 # right arm\n",
                    after = "walk # 0 # 2 # legs\nturn # 2 # 4 # legs\n";
  CHECK(made("train-sinc", both).frames() == 60);
  CHECK(made("train-teach", after).frames() == 120);
  ml::write_file(w / "timeline.txt", both);
  const auto refused = run({"generate", "--model", "train-teach_whole/model", "--timeline", "timeline.txt"}, w.path);
  CHECK(refused.code == 3);
  CHECK_MESSAGE(contains(refused.text, "this model (TEACH) takes texts one after the other"), refused.text);
  for (const std::string system : {"sinc", "teach"}) {
    const auto info = run({"info", "train-" + system + "_whole/model"}, w.path);
    CHECK_MESSAGE(contains(info.text, "model of                 " + system), info.text);
  }

  // measured on the clips that they did not see, or on all of a file
  const auto evaluated = [&](const std::string& name, const std::vector<std::string>& more) {
    const auto out = run(std::vector<std::string>{"evaluate", name + "_whole/model", "--data", ".", "--babel",
                                                  "babel.json", "--spelling", "spelling.json", "--samples", "2"} +
                             more,
                         w.path);
    REQUIRE_MESSAGE(out.code == 0, out.text);
    return out.text;
  };
  const std::vector<std::string> lists{"--splits", "splits"},
      baselines{"--independent", "train-sinc_whole/model", "--joint", "train-sinc_whole/model"};
  const auto row = [](const std::string& text, const std::string& name) {
    const auto at = text.find("  " + name + " ");
    REQUIRE_MESSAGE(at != text.npos, text);
    return text.substr(at, text.find('\n', at) - at);
  };
  const std::vector<std::string> temos{"--temos", "train-sinc_whole/model"}, parts{"--body-parts", "parts.json"};
  const std::string of_sinc = evaluated("train-sinc", lists + temos + parts),
                    without_parts = evaluated("train-sinc", lists + temos),
                    other_seed = evaluated("train-sinc", lists + std::vector<std::string>{"--seed", "1"}),
                    of_teach = evaluated("train-teach", lists + baselines);
  CHECK_MESSAGE(contains(of_sinc, "1 motion of the test part"), of_sinc);
  CHECK_MESSAGE(contains(of_teach, "2 motions of the test part"), of_teach);
  CHECK(row(of_sinc, "one sample") != row(other_seed, "one sample"));
  for (const char* name : {"mean pose", "mean of the latent"}) CHECK(row(of_sinc, name) == row(other_seed, name));
  const std::string scores = of_sinc.substr(of_sinc.find("TEMOS score"));
  CHECK(contains(row(scores, "another recorded one"), "1.000"));  // itself: there is one
  const auto score = [&](const std::string& name) {
    const std::string line = row(scores, name);
    return std::stod(line.substr(line.find_last_of(' ')));
  };
  for (const char* name : {"one sample", "labels alone, composed"})
    CHECK_MESSAGE(std::abs(score(name) - 0.5) < 0.5, of_sinc);
  CHECK(score("one sample") != score("labels alone, composed"));
  CHECK_FALSE(contains(without_parts, "labels alone, composed"));
  for (const char* name :
       {"best of 2 samples", "worst of 2 samples", "independent", "joint", "random clip", "turned and moved", "moved",
        "independent, turned and moved", "independent, moved", "recorded"})
    row(of_teach, name);
  const auto counts = [&](const std::string& name, const std::vector<std::string>& more, const std::string& count) {
    const std::string text = evaluated(name, more);
    CHECK_MESSAGE(contains(text, count), text);
  };
  counts("train-sinc", lists + std::vector<std::string>{"--items", "single"}, "4 motions of the test part");
  counts("train-sinc", lists + std::vector<std::string>{"--items", "all", "--part", "validation"},
         "5 motions of the validation part");
  counts("train-teach", {"--part", "all"}, "10 motions of babel.json");
}

TEST_CASE("SINC of separate texts (STE) is trained, generated and measured; -ing forms and shuffled labels") {
  const Sequences w;
  const auto ste =
      w.train("train-sinc", "ste",
              all + std::vector<std::string>{"--set", "network.texts=separate", "--set", "data.types=spatial_pairs",
                                             "--set", "data.shuffle=true", "--set", "optimiser.epochs=40"});
  REQUIRE_MESSAGE(ste.code == 0, ste.text);
  const auto losses = w.losses("ste");
  CHECK(mean(std::span(losses).last(8)) < 0.9 * mean(std::span(losses).first(8)));
  const auto made = [&](const std::string& timeline) {
    ml::write_file(w / "together.txt", timeline);
    const auto out = run({"generate", "--model", "ste/model", "--timeline", "together.txt", "--out", "made"}, w.path);
    REQUIRE_MESSAGE(out.code == 0, out.text);
    return ml::read_bvh_motion(w / "made/together.bvh");
  };
  const auto both = made("walk # 0 # 2 # legs\nwave # 0 # 2 # right arm\n");
  CHECK(both.frames() == 60);
  const auto measured = run({"evaluate", "ste/model", "--data", ".", "--babel", "babel.json", "--spelling",
                             "spelling.json", "--samples", "2", "--splits", "splits"},
                            w.path);
  REQUIRE_MESSAGE(measured.code == 0, measured.text);
  CHECK_MESSAGE(contains(measured.text, "labels are read apart"), measured.text);
  const auto short_ones = run({"evaluate", "ste/model", "--data", ".", "--babel", "babel.json", "--spelling",
                               "spelling.json", "--samples", "2", "--splits", "splits", "--longest", "20"},
                              w.path);
  CHECK(short_ones.code == 1);  // the pair has 45 frames

  const auto first_losses = [&](const std::vector<std::string>& more) {
    const auto out = w.train(
        "train-sinc", "out",
        all + std::vector<std::string>{"--set", "data.types=spatial_pairs", "--set", "optimiser.epochs=12", "--fresh"} +
            more);
    REQUIRE_MESSAGE(out.code == 0, out.text);
    return w.losses("out");
  };
  ml::write_file(w / "tags.txt", std::string_view("walk#walk/VERB#0.0#0.0\nwave#wave/VERB#0.0#0.0\n"
                                                  "turn#turn/VERB#0.0#0.0\nsit down#sit/VERB down/ADV#0.0#0.0\n"));
  const auto plain = first_losses({}), ing = first_losses({"--tags", "tags.txt"}),
             shuffled = first_losses({"--set", "data.shuffle=true"});
  CHECK(plain != ing);
  CHECK(plain != shuffled);
  const auto refused = [&](const std::vector<std::string>& more, const char* message) {
    const auto out = w.train("train-sinc", "refused", all + more);
    CHECK(out.code == 1);
    CHECK_MESSAGE(contains(out.text, message), out.text);
  };
  refused({"--tags", "tags.txt"}, "no words of 1 label:\nstand still");
  refused({"--tags", "tags.txt", "--set", "network.texts=separate"}, "--tags are for sentences");
  refused({"--set", "network.texts=apart"}, "texts 'apart' is not joined, separate or latents");
}

TEST_CASE("body-parts: questions for labels without an answer, a table of the answers, table B.1") {
  const Sequences w;
  const auto did = [&](const std::vector<std::string>& arguments) {
    const auto out = run(arguments, w.path);
    REQUIRE_MESSAGE(out.code == 0, out.text);
    return out.text;
  };
  const std::string questions = did({"body-parts", "--babel", "babel.json", "--spelling", "spelling.json"});
  for (const char* label : {"sit down", "stand still", "turn", "walk", "wave"})
    CHECK_MESSAGE(contains(questions, std::string("{\"label\":\"") + label + "\",\"prompt\":\"Instructions: choose"),
                  questions);
  ml::write_file(w / "answers.jsonl", std::string_view("{\"label\": \"walk\", \"answer\": \"left leg\\nright leg\"}\n"
                                                       "{\"label\": \"turn\", \"answer\": \"the whole body\"}\n"));
  const std::string fewer = did({"body-parts", "--babel", "babel.json", "--spelling", "spelling.json", "--answers",
                                 "answers.jsonl", "--form", "free", "--prompts", "prompts.jsonl"});
  CHECK_MESSAGE(contains(fewer, "4 labels of 5 without an answer  prompts.jsonl"), fewer);  // turn's names no part
  CHECK(contains(ml::read_file(w / "prompts.jsonl"), "List the body parts involved in this action: turn"));
  const std::string choices =
      did({"body-parts", "--babel", "babel.json", "--spelling", "spelling.json", "--form", "list"});
  CHECK_MESSAGE(contains(choices, "{\"label\":\"walk\",\"prompt\":\""), choices);
  CHECK(choices != questions);
  CHECK(!contains(choices, "List the body parts involved in this action: walk"));  // that is the free form
  did({"body-parts", "--answers", "answers.jsonl", "--table", "table.json"});
  CHECK(contains(ml::read_file(w / "table.json"), "\"walk\""));

  ml::write_file(w / "truth.tsv", std::string_view("walk\t1\t0\t0\t0\t1\t1\nwave\t0\t0\t0\t1\t0\t0\n"));
  const std::string accuracies = did({"body-parts", "--truth", "truth.tsv", "--answers", "parts.json", "--babel",
                                      "babel.json", "--data", ".", "--spelling", "spelling.json"});
  for (const char* row : {"  velocities of motions", "  words of the label (lexicon)", "  answers "})
    CHECK_MESSAGE(contains(accuracies, row), accuracies);
  const auto answers = accuracies.find("  answers ");
  CHECK_MESSAGE(contains(accuracies.substr(answers), "1.00       1.00       1.00       1.00       1.00       1.00"),
                accuracies);
  CHECK(run({"body-parts"}, w.path).code == 2);

  // a timeline whose texts name no parts
  ml::write_file(w / "open.txt", std::string_view("wave # 0 # 2\nwalk # 0 # 2 # legs\n"));
  const auto guessed = did({"check", "open.txt", "--body-parts", "parts.json"});
  CHECK_MESSAGE(contains(guessed, "'wave' moves right arm, by the answer of a language model"), guessed);
  CHECK_MESSAGE(contains(did({"check", "open.txt", "--guess-parts"}), "'wave' moves "), guessed);
  CHECK(!contains(did({"check", "open.txt"}), "'wave' moves right arm, "));
}

TEST_CASE("TMR finds the texts of BABEL's segments in its sequences; table 5.5") {
  const Sequences w;
  std::string captions;
  for (int i = 1; i <= 6; ++i) {
    ml::write_bvh(w / ("clip" + std::to_string(i) + ".bvh"), synthetic::walk({.frames = 60, .turn = 0.2 * i}));
    captions += "clip" + std::to_string(i) + (i % 2 == 0 ? "\twalk | a walk\n" : "\tturn\n");
  }
  ml::write_file(w / "captions.tsv", captions);
  std::vector<std::string> tmr{"train-tmr", "--data", ".",     "--captions", "captions.tsv",
                               "--preset",  "small",  "--out", "tmr"};
  for (const char* a :
       {"optimiser.epochs=1", "optimiser.batch=2", "network.latent_dim=8", "network.ff_size=8", "network.num_layers=1",
        "network.num_heads=2", "text.width=8", "data.min_seconds=0.5", "data.mirror=false"})
    tmr.insert(tmr.end(), {"--set", a});
  const auto trained = run(tmr, w.path);
  REQUIRE_MESSAGE(trained.code == 0, trained.text);
  const auto found = run({"evaluate", "tmr/model", "--data", ".", "--babel", "babel.json", "--spelling",
                          "spelling.json", "--part", "all", "--stride", "0.5"},
                         w.path);
  REQUIRE_MESSAGE(found.code == 0, found.text);
  CHECK_MESSAGE(contains(found.text, "20 texts in 5 sequences of BABEL; % found"), found.text);
  for (const char* row : {"\n  1 s ", "\n  2 s ", "\n  3 s ", "\n  all lengths ", "\n  a random window "})
    CHECK_MESSAGE(contains(found.text, row), found.text);
  const auto shares =
      run({"evaluate", "tmr/model", "--data", ".", "--captions", "captions.tsv", "--part", "training", "--filtered"},
          w.path);
  REQUIRE_MESSAGE(shares.code == 0, shares.text);
  CHECK_MESSAGE(contains(shares.text, " pairs of texts ("), shares.text);
  CHECK_MESSAGE(contains(shares.text, "negatives that training leaves out, %"), shares.text);
}

TEST_CASE("items of BABEL: types of data, val.json to validate with, combined actions") {
  const Sequences w;
  const auto counted = [&](const std::string& command, const std::vector<std::string>& more,
                           const std::string& counts) {
    const auto out = w.train(command, "out", more + std::vector<std::string>{"--fresh"});
    REQUIRE_MESSAGE(out.code == 0, out.text);
    CHECK_MESSAGE(contains(out.text, counts), out.text);
  };
  const std::vector<std::string> two{"--babel", "train.json", "--babel-validation", "val.json"};
  counted("train-sinc", two, "6 motions to train on, 5 for validation, 0 for tests; 2 left out");
  counted("train-teach", two, "2 motions to train on, 2 for validation, 0 for tests; 0 left out");
  const auto type = [&](const std::string& types, const std::string& counts) {
    counted("train-sinc", two + std::vector<std::string>{"--set", "data.types=" + types}, counts);
  };
  type("seg", "4 motions to train on, 4 for validation, 0 for tests; 0 left out");
  type("seq", "1 motion to train on, 0 for validation, 0 for tests; 0 left out");
  type("spatial_pairs", "1 motion to train on, 1 for validation, 0 for tests; 2 left out");
  type("separate_pairs+seq", "3 motions to train on, 2 for validation, 0 for tests; 0 left out");

  // all single actions are combined with a partner, with the table's parts or at random
  const auto first_losses = [&](const std::vector<std::string>& more) {
    counted("train-sinc", two + more, "6 motions to train on");
    return w.losses("out");
  };
  const auto alone = first_losses({}),
             pairs = first_losses({"--body-parts", "parts.json", "--set", "data.proportion=1"}),
             by_lot = first_losses(
                 {"--body-parts", "parts.json", "--set", "data.proportion=1", "--set", "data.random=true"});
  CHECK(alone != pairs);
  CHECK(pairs != by_lot);
}

TEST_CASE("the states of a language model, from a cache") {
  const Sequences w;
  ml::EmbeddingCache states(4);
  std::vector<float> rows;
  for (const std::string text : {"walk", "turn", "sit down", "wave", "stand still"}) {
    rows.insert(rows.end(),
                {0.5f, 1.0f, static_cast<float>(text.size()), -1.0f});  // of one token more than the text before
    states.add(text, rows);
  }
  states.write(w / "states", "bert");
  const std::vector<std::string> cached{"--set", "text.encoder=distilbert", "--text-encoder", "states/bert.npy"};
  const auto teach = w.train("train-teach", "teach", all + cached);
  REQUIRE_MESSAGE(teach.code == 0, teach.text);
  ml::write_file(w / "after.txt", std::string_view("walk # 0 # 1 # legs\nturn # 1 # 2 # legs\nwalk # 2 # 3 # legs\n"));
  const auto generate = [&](const std::vector<std::string>& more) {
    return run(std::vector<std::string>{"generate", "--model", "teach/model", "--timeline", "after.txt"} + more,
               w.path);
  };
  const auto made = generate({"--text-encoder", "states/bert.npy"});
  CHECK_MESSAGE(made.code == 0, made.text);
  const auto without = generate({});
  CHECK(without.code == 1);
  CHECK_MESSAGE(contains(without.text, "the states of distilbert: --text-encoder names it"), without.text);

  const auto sinc =
      w.train("train-sinc", "sinc", all + cached + std::vector<std::string>{"--set", "data.types=seg+seq"});
  CHECK_MESSAGE(sinc.code == 0, sinc.text);
  const auto sentences = w.train("train-sinc", "sentences", all + cached);  // which the cache lacks
  CHECK(sentences.code == 1);
  CHECK_MESSAGE(contains(sentences.text, "embedding cache: no text '"), sentences.text);
}

TEST_CASE("what train-sinc and train-teach refuse") {
  const Sequences w;
  const auto refused = [&](const std::string& command, const std::vector<std::string>& more, const std::string& message,
                           int code = 1) {
    const auto out = w.train(command, "refused", more);
    CHECK(out.code == code);
    CHECK_MESSAGE(contains(out.text, message), out.text);
    CHECK(!std::filesystem::exists(w / "refused/checkpoint.safetensors"));
  };
  refused("train-sinc", {}, "[motionlang.config.102] --babel is required", 2);
  refused("train-sinc", all + std::vector<std::string>{"--babel-validation", "val.json"},
          "--babel-validation or --splits, not both", 2);
  refused("train-sinc", all + std::vector<std::string>{"--set", "data.types=seg+pairs"},
          "data.types: 'pairs' is not seg, seq, spatial_pairs or separate_pairs");
  refused("train-sinc", all + std::vector<std::string>{"--set", "data.proportion=0.5"},
          "data.proportion above 0 needs --body-parts");
  refused("train-sinc", all + std::vector<std::string>{"--body-parts", "parts.json"},
          "--body-parts is for data.proportion above 0");
  refused("train-sinc", all + std::vector<std::string>{"--set", "features=rifke"},
          "features 'rifke' is not smplvelp-published or smplvelp");
  refused("train-sinc", all + std::vector<std::string>{"--set", "text.encoder=distilbert"},
          "text.encoder = distilbert needs --text-encoder", 2);
  refused("train-teach", all + std::vector<std::string>{"--set", "data.shortest=3"},
          "data.shortest is 3, network.hist_frames 5");
  refused("train-teach", all + std::vector<std::string>{"--set", "data.longest=20"},
          "babel.json: nothing to train on (6 left out: 6 too short, too long, without words or beyond the clip (");
  ml::write_file(w / "few.json", R"({"walk": ["", "", "right leg"]})");
  refused("train-sinc", all + std::vector<std::string>{"--body-parts", "few.json", "--set", "data.proportion=0.5"},
          "--body-parts: no parts of 'wave' (seg-1-1)");
  ml::write_file(w / "elsewhere.json", R"({"7": {"babel_sid": 7, "feat_p": "CMU/CMU/01/07_poses.npz", "dur": 8.0}})");
  refused("train-teach", {"--babel", "elsewhere.json", "--set", "data.test_share=0"},
          "elsewhere.json: 7: there is no ./CMU/01/07_poses.bvh");
  ml::write_file(w / "outside.json", R"({"7": {"babel_sid": 7, "feat_p": "../07_poses.npz", "dur": 8.0}})");
  refused("train-teach", {"--babel", "outside.json"}, "'../07_poses' is not a path of a clip");
}

TEST_CASE("the published settings of SINC and TEACH") {
  const TemporaryFolder w;
  const auto printed = [&](const std::string& command, const std::vector<const char*>& lines) {
    const auto out = run({command, "--print-config"}, w.path);
    CHECK(out.code == 0);
    for (const char* line : lines) CHECK_MESSAGE(contains(out.text, line), out.text);
  };
  printed("train-sinc", {"\"features\": \"smplvelp-published\"", "\"num_heads\": 4", "\"num_layers\": 6",
                         "\"kl\": 0.00032", "\"latent\": 1e-05", "\"lr\": 0.0003", "\"weight_decay\": 0.01",
                         "\"schedule\": \"step\"", "\"batch\": 32", "\"epochs\": 1001", "\"seed\": 42", "\"every\": 25",
                         "\"encoder\": \"distilbert\"", "\"window\": 300", "\"shortest\": 15", "\"proportion\": 0.5"});
  printed("train-teach", {"\"features\": \"smplvelp-published\"", "\"num_heads\": 4", "\"kl\": 1e-05", "\"lr\": 7e-05",
                          "\"schedule\": \"constant\"", "\"batch\": 8", "\"epochs\": 1001", "\"seed\": 42",
                          "\"hist_frames\": 5", "\"longest\": 750", "\"loss_on_transition\": true"});
}
