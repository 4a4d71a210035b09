// The trainer: stopped and resumed, on one thread and on two, it makes the same numbers.
#include <doctest/doctest.h>

#include <motionlang/backend/usual.hpp>
#include <motionlang/formats/bvh.hpp>
#include <motionlang/train/stmc_training.hpp>
#include <motionlang/weights/stmc_file.hpp>

#include "../support/small_stmc_training.hpp"
#include "../support/threads.hpp"
#include "../support/training_set.hpp"

namespace ml = motionlang;
using Stmc = ml::StmcTraining<ml::Autodiff<ml::EigenBackend<float>>>;

namespace {

const ml::TrainingSet& data() { return captioned::training_set(); }

ml::StmcTrainingConfig config() { return small::stmc_training(); }

struct Run {
  TemporaryFolder folder;
  std::filesystem::path checkpoint = folder / "checkpoint.safetensors";
  std::vector<double> losses;

  /// Trains until step `last`; goes on where an earlier call stopped, from the file.
  void until(ml::Index last) {
    ml::Trainer trainer(Stmc(config(), data()));
    if (std::filesystem::exists(checkpoint)) trainer.resume(checkpoint);
    while (trainer.steps_done() < last) losses.push_back(trainer.step());
    CHECK(trainer.record().losses.size() == static_cast<std::size_t>(last));
    trainer.save(checkpoint);
  }
  std::string state() const { return ml::read_file(checkpoint); }
};

}  // namespace

TEST_CASE("two steps and two more are four steps, bit for bit, on one thread and on two") {
  Run whole, parts, two_threads;
  {
    const Threads one(1);
    whole.until(4);
    parts.until(2);
    parts.until(4);
  }
  {
    const Threads two(2);
    two_threads.until(4);
  }
  CHECK(whole.losses.size() == 4);
  CHECK(parts.losses == whole.losses);
  CHECK(two_threads.losses == whole.losses);
  CHECK(parts.state() == whole.state());  // weights, averages, moments, losses, metadata
  CHECK(two_threads.state() == whole.state());
}

TEST_CASE("a cap on the ratio of signal to noise weighs clear samples more, up to the cap") {
  const auto loss_of_features = [](double cap) {
    ml::StmcTrainingConfig c = config();
    c.losses.snr_cap = cap, c.noise_focus = 0, c.optimiser.batch = 12;
    Stmc task(c, data());
    const auto terms = task.part_loss(ml::Philox{.seed = 3}, 0, {0, c.optimiser.batch}, {}).terms;
    REQUIRE(terms.front().name == "features");
    return static_cast<double>(terms.front().value.item());
  };
  const double same = loss_of_features(1), weighed = loss_of_features(10), more = loss_of_features(100);
  CHECK(weighed > 1.1 * same);
  CHECK(weighed < 10 * same);
  CHECK(more > weighed);
}

TEST_CASE("a scale of the pose makes its deviations smaller, and leaves those of the root") {
  const TemporaryFolder folder;
  const auto deviations = [&](double scale) {
    auto c = config();
    c.pose_scale = scale;
    Stmc(c, data()).export_model(folder / "model", {});
    return ml::values_of<float>(ml::SafetensorsFile::open(folder / "model").tensor("motion_normalizer.std"));
  };
  const auto whole = deviations(1), half = deviations(0.5);
  REQUIRE(whole.size() == 205);
  for (std::size_t i = 0; i < 205; ++i) {
    const bool moves = whole[i] != 1;  // a feature that never changes keeps 1
    CHECK(half[i] == doctest::Approx(i < 4 || !moves ? whole[i] : whole[i] / 2).epsilon(2e-3));
  }
}

TEST_CASE("texts are learnt first: the encoder alone changes, the same on one thread and on two") {
  const TemporaryFolder folder;
  auto c = config();
  c.text_steps = 200;
  auto run = [&](int threads, const std::string& name) {
    const Threads scope(threads);
    ml::Trainer trainer(Stmc(c, data()));
    trainer.task().export_model(folder / "before", {});
    const double loss = trainer.task().learn_texts();
    trainer.task().export_model(folder / name, {});
    return loss;
  };
  const double loss = run(1, "one");
  CHECK(run(2, "two") == loss);
  CHECK(loss < 2);  // of numbers with variance 1 or less, their means and deviations
  CHECK(ml::read_file(folder / "one") == ml::read_file(folder / "two"));
  const auto before = ml::SafetensorsFile::open(folder / "before"), after = ml::SafetensorsFile::open(folder / "one");
  for (const auto& t : before.tensors()) {
    if (t.name.starts_with(ml::caption_tensors)) continue;  // depend on the texts
    const bool same = ml::values_of<float>(t) == ml::values_of<float>(after.tensor(t.name));
    CHECK_MESSAGE(same == !t.name.starts_with("text_encoder."), t.name);
  }
}

TEST_CASE("the verb of a caption tells actions apart whose poses are nearly the same") {
  // Two segments of the same clip: no summary can tell them apart, only their verbs.
  const TemporaryFolder folder;
  ml::write_bvh(folder / "walk.bvh", synthetic::walk({.frames = 60}));
  ml::write_file(folder / "captions.tsv", "walk\t0\t3\tlegs\twave hello\nwalk\t0\t3\tlegs\tnod gravely\n");
  const ml::TrainingSet alike(folder / "captions.tsv", folder.path, {});
  const auto likeness = [&](double verb_weight) {
    auto c = config();
    c.text_steps = 200;
    c.losses.verb = verb_weight;
    ml::Trainer trainer(Stmc(c, alike));
    trainer.task().learn_texts();
    trainer.task().export_model(folder / "model", {});
    const auto model = ml::load_stmc<ml::EigenBackend<float>>(folder / "model");
    const auto x = model.text_encoder(std::vector<std::string>{"wave hello", "nod gravely", "stand still"});
    double xy = 0, xx = 0, yy = 0;
    for (ml::Index j = 0; j < x.size(1); ++j) {
      const double a = x.at(0, j) - x.at(2, j), b = x.at(1, j) - x.at(2, j);
      xy += a * b, xx += a * a, yy += b * b;
    }
    return xy / std::sqrt(xx * yy);
  };
  CHECK(likeness(1) < likeness(0) - 0.2);
}

TEST_CASE("a training starts with what a model knows, although it has word vectors and other statistics") {
  using B = ml::EigenBackend<float>;
  const TemporaryFolder folder;
  auto c = config();
  ml::Trainer first(Stmc(c, data()));
  first.step();
  first.task().export_model(folder / "first", {});
  const auto trained = ml::load_stmc<B>(folder / "first");

  c.optimiser.seed = 2;
  const std::vector<std::string> words{"walk", "stroll"};
  const std::vector<float> numbers{1, 0, 0.5f, 0.25f};
  ml::Trainer second(Stmc(c, data(), ml::WordVectors::rounded(words, numbers)));
  second.task().start_from(folder / "first");
  second.task().export_model(folder / "second", {});
  const auto started = ml::load_stmc<B>(folder / "second");

  // Words of both vocabularies are encoded as before, letters too.
  const std::vector<std::string> text{"a"};
  const auto before = trained.text_encoder(text).to_vector(), after = started.text_encoder(text).to_vector();
  for (std::size_t i = 0; i < before.size(); ++i) CHECK(after[i] == doctest::Approx(before[i]).epsilon(1e-3));

  // The denoiser does the same with frames of other statistics.
  const ml::Offsets offsets(std::vector<ml::Index>{5});
  auto rng = ml::Philox{.seed = 3};
  const auto x = ml::Tensor<B, 2>::randn({5, 205}, rng);
  const std::vector<ml::Index> t{7};
  auto model = trained;
  auto other = model.motion_normalizer;
  for (ml::Index f = 0; f < 205; ++f) {
    other.std.mutable_data().data()[f] *= f % 2 == 0 ? 1.5f : 0.75f;
    other.mean.mutable_data().data()[f] += 0.25f * other.std.span()[static_cast<std::size_t>(f)];
  }
  const auto said = ml::TextFeatures<B>::pooled(model.text_encoder(text));
  const auto expected = model.motion_normalizer.denormalize(model.denoiser(ml::Sequences<B>(x, offsets), t, said).rows);
  const auto moved = other.normalize(model.motion_normalizer.denormalize(x));
  ml::detail::change_normalizer(model.denoiser, model.motion_normalizer, other);
  const auto got = other.denormalize(model.denoiser(ml::Sequences<B>(moved, offsets), t, said).rows);
  for (std::size_t i = 0; i < got.span().size(); ++i)
    CHECK(got.span()[i] == doctest::Approx(expected.span()[i]).epsilon(1e-3).scale(1));
}

TEST_CASE("words get the rows that a trained vocabulary has for them or for their parts") {
  const ml::WordPiece known({"[CLS]", "[SEP]", "[UNK]", "walk", "##s", "run"});
  const ml::WordPiece wanted({"[CLS]", "[SEP]", "[UNK]", "run", "walks", "hop"});
  const std::vector<float> rows{0, 1, 2, 3, 5, 8};
  using Rows = std::vector<float>;
  CHECK(ml::detail::started_rows(wanted, known, rows, false) ==
        Rows{0, 1, 3.25f, 8, 4, 3.25f});                                                 // the mean of the others
  CHECK(ml::detail::started_rows(wanted, known, rows, true) == Rows{0, 1, 2, 8, 2, 2});  // heard by their vectors
}

TEST_CASE("training changes every weight, and its export is a model") {
  ml::Trainer trainer(Stmc(config(), data()));
  const TemporaryFolder folder;
  trainer.task().export_model(folder / "before.safetensors", {});
  trainer.step();
  trainer.task().export_model(folder / "after.safetensors", {{"license", "MIT"}});
  trainer.save(folder / "checkpoint.safetensors");
  const auto before = ml::SafetensorsFile::open(folder / "before.safetensors");
  const auto trained = ml::SafetensorsFile::open(folder / "checkpoint.safetensors");
  for (const auto& t : before.tensors()) {
    if (t.name.starts_with(ml::caption_tensors)) continue;  // not a weight
    const bool statistics = t.name.find("normalizer") != std::string::npos;
    const auto old = ml::values_of<float>(t), now = ml::values_of<float>(trained.tensor("model." + t.name));
    double largest = 0;
    for (std::size_t i = 0; i < old.size(); ++i)
      largest = std::max(largest, static_cast<double>(std::abs(old[i] - now[i])) / (1e-3 + std::abs(old[i])));
    if (statistics)
      CHECK_MESSAGE(largest < 1e-3, t.name);  // half precision
    else
      CHECK_MESSAGE(largest > 0, t.name);
  }
  const auto model = ml::load_stmc<ml::EigenBackend<float>>(folder / "after.safetensors");
  CHECK(model.denoiser.to_skel_layer.out() == 205);
  CHECK(ml::SafetensorsFile::open(folder / "after.safetensors").metadata().at("license") == "MIT");
}

TEST_CASE("a checkpoint that cannot be used is refused, and stays") {
  Run run;
  run.until(1);
  const std::string good = run.state();

  for (const std::size_t end : {std::size_t{0}, std::size_t{100}, good.size() - 1}) {
    ml::write_file(run.checkpoint, std::string_view(good).substr(0, end));
    ml::Trainer trainer(Stmc(config(), data()));
    CHECK_THROWS_WITH_AS(trainer.resume(run.checkpoint), doctest::Contains("[motionlang.io.402]"), ml::io_error);
    CHECK(trainer.steps_done() == 0);
    CHECK(run.state() == good.substr(0, end));
  }
  ml::write_file(run.checkpoint, good);

  auto other = config();
  other.network.latent_dim = 32;
  CHECK_THROWS_WITH_AS(ml::Trainer(Stmc(other, data())).resume(run.checkpoint),
                       doctest::Contains("another denoiser.latent_dim (16, not 32)"), ml::config_error);
  other = config();
  other.vocabulary = 30;
  CHECK_THROWS_WITH_AS(ml::Trainer(Stmc(other, data())).resume(run.checkpoint),
                       doctest::Contains("another text.vocabulary;"), ml::config_error);

  other = config();
  other.optimiser.lr *= 2;
  CHECK_THROWS_WITH_AS(ml::Trainer(Stmc(other, data())).resume(run.checkpoint),
                       doctest::Contains("another training.optimiser.lr ("), ml::config_error);

  const captioned::Clips clips;
  std::string captions = ml::read_file(clips.captions);
  captions.replace(captions.find("a person walks forward | someone walks"), 38,
                   "someone walks | a person walks forward");
  ml::write_file(clips.captions, captions);
  const ml::TrainingSet edited(clips.captions, clips.folder.path, {});
  CHECK_THROWS_WITH_AS(ml::Trainer(Stmc(config(), edited)).resume(run.checkpoint),
                       doctest::Contains("another training.data ("), ml::config_error);

  // a save that fails: the folder has become a file
  ml::Trainer trainer(Stmc(config(), data()));
  CHECK_THROWS_AS(trainer.save(run.checkpoint / "below"), ml::io_error);
  CHECK(run.state() == good);
}

TEST_CASE("captions that cannot be used are refused with their line") {
  const captioned::Clips clips;
  auto check = [&](const std::string& line, const std::string& message) {
    const auto file = clips.folder / "wrong.tsv";
    ml::write_file(file, "# clip\tstart\tend\tparts\tcaptions\n" + line + "\n");
    CHECK_THROWS_WITH_AS(ml::TrainingSet(file, clips.folder.path, {}), doctest::Contains(message.c_str()),
                         ml::io_error);
  };
  check("walk\t0\t2\tlegs", "wrong.tsv:2: expected clip, start, end, parts, captions");
  check("walk\tnow\t2\tlegs\ta person walks", "wrong.tsv:2: 'now' is not a time");
  check("walk\t0:30\t1:10\tlegs\ta person walks", "wrong.tsv:2: '0:30' is not a time");
  check("walk\t0\tinf\tlegs\ta person walks", "wrong.tsv:2: 'inf' is not a time");
  check("walk\t2\t2\tlegs\ta person walks", "wrong.tsv:2: the segment is empty");
  check("walk\t0\t2\twings\ta person walks", "wrong.tsv:2: 'wings' is not a body part");
  check("fly\t0\t2\tlegs\ta person flies", "no ");
  check("walk\t0\t0.2\tlegs\ta person walks", "holds 4 frames");
}
