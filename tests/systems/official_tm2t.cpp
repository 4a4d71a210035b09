// TM2T's folders and those of MDM for actions: what they load as, what generation makes of it, the errors when
// something is missing.
#include <motionlang/weights/mdm_action_run.hpp>
#include <motionlang/weights/tm2t_run.hpp>

#include "../support/check_error.hpp"
#include "../support/file_of_model.hpp"
#include "../support/official_tm2t.hpp"
#include "../support/small_model.hpp"
#include "../support/temporary_folder.hpp"
#include "../support/tensors.hpp"

namespace ml = motionlang;
namespace fs = std::filesystem;
using ml::Index;
using official::B;

TEST_CASE("TM2T: the recurrent model, the tokenizer beside it, word vectors above") {
  const TemporaryFolder folder;
  const auto config = official::small_tm2t();
  const fs::path run = official::write_tm2t_runs(folder.path, config);
  CHECK(ml::is_tm2t_generator(ml::find_run(run)));
  CHECK(!ml::is_tm2t_generator(ml::find_run(run.parent_path() / "VQVAEV3")));
  const auto loaded = ml::load_tm2t_run<B>(ml::find_run(run));
  CHECK(loaded.fps == 20);
  CHECK(loaded.width() == 263);
  const auto wanted = official::tm2t(config);
  const ml::GloVe words(official::tm2t_words, official::tm2t_vectors(), 4);
  const std::vector<std::string> texts{"a person walks", "turn"};
  const auto a =
      loaded.model.generate(loaded.words.encode<B>(std::span<const std::string>(texts)), ml::Philox{.seed = 3});
  const auto b = wanted.generate(words.encode<B>(std::span<const std::string>(texts)), ml::Philox{.seed = 3});
  CHECK(a.offsets == b.offsets);
  REQUIRE(a.rows.size(0) > 0);
  CHECK(a.rows.size(0) % 4 == 0);
  CHECK(small::is_finite(a.rows));
  for (std::size_t i = 0; i < a.rows.span().size(); ++i)
    CHECK(a.rows.span()[i] == doctest::Approx(b.rows.span()[i]).epsilon(1e-4));
}

TEST_CASE("TM2T: the transformer from motions to texts, its tokenizer, its words") {
  const TemporaryFolder folder;
  auto config = official::small_tm2t();
  config.motion_to_text.value_width = config.motion_to_text.head_width + 3;
  const fs::path t2m = official::write_tm2t_runs(folder.path, config), run = t2m.parent_path() / "M2T_EL2_DL1_NH2_PS";
  CHECK(ml::is_tm2t_describer(ml::find_run(run)));
  CHECK(!ml::is_tm2t_describer(ml::find_run(t2m)));
  CHECK(!ml::is_tm2t_generator(ml::find_run(run)));
  const auto loaded = ml::load_tm2t_describer<B>(ml::find_run(run));
  CHECK((loaded.fps == 20 && loaded.width() == 263));
  CHECK(loaded.model.m2t_transformer.encoder.layer_stack.at(1).slf_attn.heads == 2);
  CHECK(!loaded.model.m2t_transformer.trg_word_prj);  // shared
  const auto wanted = official::tm2t(config);
  const ml::GloVe words(official::tm2t_words, official::tm2t_vectors(), 4);
  const ml::Sequences<B> x(tensors::normal<B, 2>({40, 263}, 5), ml::Offsets{16, 24});
  const auto found = loaded.model.descriptions(x, loaded.words, {.beams = 3}),
             same = wanted.descriptions(x, words, {.beams = 3});
  REQUIRE(found.size() == 2);
  for (std::size_t i = 0; i < 2; ++i) {
    REQUIRE(found[i].size() == same[i].size());
    CHECK(found[i][0].text == loaded.model.describe(x, loaded.words, {.beams = 3})[i]);
    for (std::size_t k = 0; k < found[i].size(); ++k) {
      CHECK(found[i][k].text == same[i][k].text);
      CHECK(found[i][k].log_probability == doctest::Approx(same[i][k].log_probability).epsilon(1e-4));
      CHECK(found[i][k].log_probability < 0);
    }
  }
  CHECK_ERROR(ml::load_tm2t_describer<B>(ml::find_run(t2m)), "not TM2T's transformer from motions to texts");
  CHECK_ERROR(ml::load_tm2t_tokenizer<B>(ml::find_run(t2m)), "not TM2T's motion tokenizer");
  const std::string options = ml::read_file(run / "opt.txt");
  official::write_text(run / "opt.txt", "---- Options\nn_head: 3\n---- End\n");
  CHECK_ERROR(ml::load_tm2t_describer<B>(ml::find_run(run)), "n_head is 3, ");
  official::write_text(run / "opt.txt", options);
  config.motion_to_text.target_symbols = 9;
  official::write_tm2t_runs(folder.path, config);
  CHECK_ERROR(ml::load_tm2t_describer<B>(ml::find_run(run)), "writes 9 symbols, the words found are 7");
  config.motion_to_text.source_symbols = 14;
  official::write_tm2t_runs(folder.path, config);
  CHECK_ERROR(ml::load_tm2t_describer<B>(ml::find_run(run)), "has 14 motion symbols");
}

TEST_CASE("TM2T: what is missing, what does not fit") {
  const TemporaryFolder folder;
  auto config = official::small_tm2t();
  const fs::path run = official::write_tm2t_runs(folder.path, config), tokenizer = run.parent_path() / "VQVAEV3";
  const auto load = [&](const ml::Tm2tRunOptions& options = {}) {
    return ml::load_tm2t_run<B>(ml::find_run(run), options);
  };
  CHECK_ERROR(ml::load_tm2t_run<B>(ml::find_run(tokenizer)), "not TM2T's recurrent model");
  CHECK_ERROR(ml::load_tm2t_run<B>(ml::find_run(folder.path)), "of no known system, expected tm2t");

  fs::rename(folder / "glove", folder / "words");
  CHECK_ERROR(load(), "put glove/our_vab_data.npy");
  CHECK(load({.words = folder / "words"}).words.size() == 7);
  fs::rename(folder / "words", folder / "glove");

  fs::rename(tokenizer, folder / "elsewhere");
  CHECK_ERROR(load(), "0 folders with a motion tokenizer beside it");
  CHECK(load({.tokenizer = folder / "elsewhere"}).width() == 263);
  fs::copy(folder / "elsewhere", run.parent_path() / "first", fs::copy_options::recursive);
  fs::copy(folder / "elsewhere", run.parent_path() / "second", fs::copy_options::recursive);
  CHECK_ERROR(load(), "2 folders with a motion tokenizer beside it");
  const std::string options = ml::read_file(run / "opt.txt");
  const auto with = [&](const std::string& line) {
    std::string text = options;
    official::write_text(run / "opt.txt", text.insert(text.find("batch_size"), line + "\n"));
  };
  with("tokenizer_name: second");
  CHECK(load().width() == 263);
  fs::remove_all(run.parent_path() / "first");
  fs::remove_all(run.parent_path() / "second" / "meta");
  official::write_text(run / "opt.txt", options);
  CHECK_ERROR(load(), "meta/mean.npy and meta/std.npy are missing");
  fs::remove_all(run.parent_path() / "second");
  official::write_text(run / "opt.txt", "---- Options\ndim_mot_hid: 99\n---- End\n");
  CHECK_ERROR(load({.tokenizer = folder / "elsewhere"}),
              "dim_mot_hid is 99, tensor 't2m_model.motion_decoder_step.input_emb.weight'");
  official::write_text(run / "opt.txt", "---- Options\nearly_or_late: late\n---- End\n");
  CHECK_ERROR(load({.tokenizer = folder / "elsewhere"}), "early_or_late is late, the tensors are those of early");
  official::write_text(run / "opt.txt", options);
  config.text_to_motion.symbols = 14;
  official::write_tm2t_runs(folder.path, config);
  CHECK_ERROR(load(), "has 14 motion symbols");
}

namespace {
/// In the place of a checkpoint: tensors of these shapes, all zeros.
void write_shapes(const fs::path& run, std::initializer_list<std::pair<const char*, ml::FileShape>> tensors) {
  const auto file = models::file_of_shapes(tensors);
  ml::write_safetensors(run / "model/finest.tar", file.tensors());
}
}  // namespace

TEST_CASE("TM2T: files that are too small for networks of their sizes are refused before memory is taken") {
  const TemporaryFolder folder;
  const fs::path t2m = official::write_tm2t_runs(folder.path, official::small_tm2t()),
                 m2t = t2m.parent_path() / "M2T_EL2_DL1_NH2_PS", tokenizer = t2m.parent_path() / "VQVAEV3";
  const Index huge = 70'000;
  const std::string step = "t2m_model.motion_decoder_step.", reads = "m2t_transformer.encoder.",
                    writes = "m2t_transformer.decoder.";
  write_shapes(t2m, {{(step + "input_emb.weight").c_str(), {13, huge}},
                     {(step + "gru.0.weight_ih").c_str(), {1, 1}},
                     {"t2m_model.text_encoder.input_emb.weight", {1, 4}},
                     {"t2m_model.text_encoder.gru.weight_hh_l0", {1, 1}}});
  official::write_text(t2m / "opt.txt", "---- Options\n---- End\n");
  CHECK_ERROR(ml::load_tm2t_run<B>(ml::find_run(t2m)),
              "model/finest.tar: 910006 numbers, a network of its sizes has at least");
  write_shapes(m2t, {{(reads + "src_word_emb.weight").c_str(), {13, huge}},
                     {(reads + "layer_stack.0.pos_ffn.w_1.weight").c_str(), {huge, 1}},
                     {(reads + "layer_stack.0.slf_attn.w_qs.weight").c_str(), {8, 1}},
                     {(reads + "layer_stack.0.slf_attn.w_vs.weight").c_str(), {8, 1}},
                     {(reads + "position_enc.positional_encoding").c_str(), {1, 1}},
                     {(writes + "trg_word_emb.weight").c_str(), {8, 1}},
                     {(writes + "layer_stack.0.slf_attn.w_qs.weight").c_str(), {1, 1}},
                     {(writes + "position_enc.positional_encoding").c_str(), {1, 1}}});
  official::write_text(m2t / "opt.txt", "---- Options\n---- End\n");
  CHECK_ERROR(ml::load_tm2t_describer<B>(ml::find_run(m2t)),
              "model/finest.tar: 980027 numbers, a network of its sizes has at least");
  const auto write_codes = [&](Index width) {
    write_shapes(tokenizer, {{"vq_encoder.main.0.weight", {huge, 1, 1}},
                             {"quantizer.embedding.weight", {10, width}},
                             {"vq_decoder.main.0.model.0.weight", {1}}});
  };
  official::write_text(tokenizer / "opt.txt", "---- Options\n---- End\n");
  write_codes(1);
  const std::string refusal = "[motionlang.config.102] " + (tokenizer / "model/finest.tar").string() +
                              ": 70011 numbers, a network of its sizes has at least 14700";
  CHECK_ERROR(ml::load_tm2t_tokenizer<B>(ml::find_run(tokenizer)), refusal.c_str());
  write_codes(0);
  CHECK_ERROR(ml::load_tm2t_tokenizer<B>(ml::find_run(tokenizer)), "tensor 'quantizer.embedding.weight' is (10, 0)");
}

TEST_CASE("MDM for actions: args.json and a checkpoint; motions of 60 frames of rotations") {
  const TemporaryFolder folder;
  const auto sizes = official::small();
  official::write_mdm_action_run(folder.path, sizes);
  CHECK(ml::is_mdm_action_run(ml::find_run(folder.path)));
  const auto run = ml::load_mdm_action_run<B>(ml::find_run(folder.path));
  CHECK(run.labels.size() == 12);
  CHECK(run.model.guidance == 1);
  CHECK(run.model.diffusion.steps() == sizes.steps);
  const ml::MdmActions<B> wanted{.denoiser = official::mdm_actions(sizes),
                                 .diffusion = ml::GaussianDiffusion(ml::CosineSchedule{.steps = sizes.steps})};
  const std::vector<Index> actions{3, 7};
  const auto a = run.model.generate(actions, ml::Philox{.seed = 2}),
             b = wanted.generate(actions, ml::Philox{.seed = 2});
  CHECK(a.rows.shape() == ml::Shape{120, 150});
  CHECK(small::is_finite(a.rows));
  for (std::size_t i = 0; i < a.rows.span().size(); ++i)
    CHECK(a.rows.span()[i] == doctest::Approx(b.rows.span()[i]).epsilon(1e-3));

  official::write_mdm_action_run(folder.path, sizes, 0.1);
  CHECK(ml::load_mdm_action_run<B>(ml::find_run(folder.path)).model.guidance == 2.5);
  official::write_mdm_run(folder / "texts", sizes);
  CHECK(!ml::is_mdm_action_run(ml::find_run(folder / "texts")));
  CHECK_ERROR(ml::load_mdm_action_run<B>(ml::find_run(folder / "texts")),
              "motions of 263 numbers a frame; models of actions have 150");
}
