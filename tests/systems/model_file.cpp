// Files of STMC models: what is saved is loaded, and what is wrong is refused with its place and both values.
#include <doctest/doctest.h>

#include <sys/resource.h>

#include <csignal>
#include <limits>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/backend/xtensor.hpp>

#include "../support/small_model.hpp"
#include "../support/temporary_folder.hpp"

namespace ml = motionlang;
using ml::DType, ml::Index, ml::Shape;
using B = ml::EigenBackend<float>;

namespace {

/// The tensors and metadata of a good file, to be changed in one place by each test.
struct Parts {
  struct Numbers {
    Shape shape;
    std::vector<float> values;
  };
  std::map<std::string, Numbers> tensors;
  std::map<std::string, std::string> metadata;

  Parts() {
    auto m = small::model<B>();
    metadata = ml::stmc_metadata(small::config(), m.text_encoder.tokenizer);
    ml::visit_tensors(m, [&](const std::string& name, const auto& t) {
      tensors[name] = {t.shape(), small::numbers(t)};
    });
  }
  std::vector<std::byte> bytes() const {
    ml::TensorStore store;
    for (const auto& [name, t] : tensors) store.add<float>(name, t.shape, t.values, DType::F32);
    return ml::safetensors_bytes(store.views(), metadata);
  }
};

ml::Stmc<B> load(const std::vector<std::byte>& bytes) {
  return ml::load_stmc<B>(ml::SafetensorsFile::from_bytes(bytes, "model.safetensors"));
}

struct Refusal {
  int id = 0;  // 0: the file is accepted
  std::string message;
};
template <class F>
Refusal refusal(F load) {
  try {
    load();
    return {0, "accepted"};
  } catch (const ml::error& e) {
    return {e.id(), e.what()};
  }
}
template <class Change>
void check_refused(Change change, int id, const std::vector<std::string>& said) {
  Parts parts;
  change(parts);
  const auto bytes = parts.bytes();
  const auto refused = refusal([&] { load(bytes); });
  CHECK_MESSAGE(refused.id == id, refused.message);
  CHECK_MESSAGE(refused.message.find("model.safetensors") != std::string::npos, refused.message);
  for (const std::string& part : said) CHECK_MESSAGE(refused.message.find(part) != std::string::npos, refused.message);
}
void check_metadata(const std::string& key, const std::string& value, int id, const std::vector<std::string>& said) {
  check_refused([&](Parts& p) { p.metadata[key] = value; }, id, said);
}

}  // namespace

TEST_CASE("save and load: the same bits, the same motion") {
  const TemporaryFolder folder;
  const auto path = folder / "model.safetensors";
  const auto model = small::model<B>();
  ml::save_stmc(path, model, small::config(), {{"license", "MIT"}, {"provenance", "drawn"}}, DType::F32);
  const auto again = ml::load_stmc<B>(path);
  Index tensors = 0;
  ml::zip(model, again, [&](const std::string& name, const auto& a, const auto& b) {
    if constexpr (ml::is_tensor<std::remove_cvref_t<decltype(a)>>) {
      CHECK_MESSAGE(small::numbers(a) == small::numbers(b), name);
      ++tensors;
    }
  });
  CHECK(tensors == 60);
  CHECK(again.diffusion.steps() == 8);
  CHECK(again.text_encoder.tokenizer.vocabulary() == model.text_encoder.tokenizer.vocabulary());
  const auto timeline = small::several_tracks();
  CHECK(small::numbers(again.generate(timeline, {.seed = 1})) == small::numbers(model.generate(timeline, {.seed = 1})));

  const auto metadata = ml::SafetensorsFile::open(path).metadata();
  CHECK(metadata.at("license") == "MIT");
  CHECK(metadata.at("provenance") == "drawn");
  const auto config = ml::stmc_config(ml::SafetensorsFile::open(path));
  CHECK(config.denoiser.latent_dim == 32);
  CHECK(config.fps == 20);
  CHECK(config.guidance == 2.5);
  CHECK(config.noise_scale == ml::NoiseScale::posterior_std);
  CHECK(config.sampler == ml::SamplingOptions::Sampler::ddpm);
  CHECK(config.sampling_steps == 0);
}

TEST_CASE("a model without registers: its file has no tensor of them, it makes the same motion") {
  auto none = small::config();
  none.denoiser.nb_registers = 0;
  const auto model = small::model<B>(none);
  CHECK(model.denoiser.traits().longest_crop == small::model<B>().denoiser.traits().longest_crop + 2);
  const TemporaryFolder folder;
  const auto path = folder / "model.safetensors";
  ml::save_stmc(path, model, none, {}, DType::F32);
  const auto file = ml::SafetensorsFile::open(path);
  CHECK(file.metadata().at("denoiser.nb_registers") == "0");
  CHECK(file.find("denoiser.registers") == nullptr);
  CHECK(file.tensors().size() == 59);
  const auto again = ml::load_stmc<B>(file);
  const auto made = [](const ml::Stmc<B>& m) {
    return small::numbers(m.generate(small::several_tracks(), {.seed = 1}));
  };
  CHECK(made(again) == made(model));
  CHECK(made(again) != made(small::model<B>()));

  auto metadata = file.metadata();
  metadata.at("denoiser.nb_registers") = "2";
  const auto bytes = ml::safetensors_bytes(file.tensors(), metadata);
  CHECK(refusal([&] { load(bytes); }).message.find("no tensor 'denoiser.registers'") != std::string::npos);
}

TEST_CASE("a model is sampled as its file asks, unless the caller says how") {
  const TemporaryFolder folder;
  using Sampler = ml::SamplingOptions::Sampler;
  auto wanted = small::config();
  wanted.sampler = Sampler::ddim, wanted.sampling_steps = 3;
  const auto model = small::model<B>();
  ml::save_stmc(folder / "model.safetensors", model, wanted, {}, DType::F32);
  const auto again = ml::load_stmc<B>(folder / "model.safetensors");
  CHECK(ml::SafetensorsFile::open(folder / "model.safetensors").metadata().at("sampling") == "ddim 3");
  const auto timeline = small::one_track();
  const auto made = [&](const ml::Stmc<B>& m, const ml::StmcOptions& o) {
    return small::numbers(m.generate(timeline, {.seed = 1}, o));
  };
  auto ddim = model.sampling;
  ddim.sampler = Sampler::ddim;
  CHECK(made(again, {}) == made(model, {.steps = 3, .sampling = ddim}));
  CHECK(made(again, {.steps = 0, .sampling = model.sampling}) == made(model, {}));
  CHECK(made(again, {.steps = 2}) == made(model, {.steps = 2, .sampling = ddim}));
  wanted.sampling_steps = 9;
  CHECK_THROWS_WITH_AS(ml::save_stmc(folder / "model.safetensors", model, wanted, {}),
                       doctest::Contains("[motionlang.config.101]"), ml::config_error);
}

TEST_CASE("half precision: every weight within its rounding, saved again it is the same file") {
  const TemporaryFolder folder;
  const auto model = small::model<B>();
  ml::save_stmc(folder / "half.safetensors", model, small::config(), {});
  const auto half = ml::load_stmc<B>(folder / "half.safetensors");
  bool differs = false;
  ml::zip(model, half, [&](const std::string& name, const auto& a, const auto& b) {
    if constexpr (ml::is_tensor<std::remove_cvref_t<decltype(a)>>) {
      double worst = 0;  // half has 11 significant bits, and steps of 2^-24 below 2^-14
      for (std::size_t i = 0; i < a.span().size(); ++i) {
        const double x = a.span()[i], y = b.span()[i];
        worst = std::max(worst, std::abs(x - y) / std::max(std::abs(x) * 0x1p-11, 0x1p-25));
        differs = differs || x != y;
      }
      CHECK_MESSAGE(worst <= 1, name);
    }
  });
  CHECK(differs);
  ml::save_stmc(folder / "again.safetensors", half, small::config(), {});
  CHECK(ml::read_file(folder / "half.safetensors") == ml::read_file(folder / "again.safetensors"));
  const auto x = ml::load_stmc<ml::XtensorBackend<double>>(folder / "half.safetensors");
  CHECK(small::is_finite(x.generate(small::one_text(), {.seed = 1})));
}

TEST_CASE("a save that fails leaves the old file") {
  const TemporaryFolder folder;
  const auto path = folder / "model.safetensors";
  auto model = small::model<B>();
  ml::save_stmc(path, model, small::config(), {});
  const auto before = ml::read_file(path);
  auto check_unchanged = [&] {
    CHECK(ml::read_file(path) == before);
    CHECK(std::distance(std::filesystem::directory_iterator(folder.path), {}) == 1);
  };
  CHECK_THROWS_WITH_AS(ml::save_stmc(path, model, small::config(), {{"license", "\xFF"}}),
                       doctest::Contains("[motionlang.io.403]"), ml::io_error);
  check_unchanged();

  // a disk that is full: no file may grow beyond a kilobyte
  rlimit old{};
  ::getrlimit(RLIMIT_FSIZE, &old);
  const auto ignore = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small_files{1024, old.rlim_max};
  ::setrlimit(RLIMIT_FSIZE, &small_files);
  const auto refused = refusal([&] { ml::save_stmc(path, model, small::config(), {{"license", "other"}}); });
  ::setrlimit(RLIMIT_FSIZE, &old);
  std::signal(SIGXFSZ, ignore);
  CHECK(refused.id == 401);
  CHECK_MESSAGE(refused.message.find(path.string()) != std::string::npos, refused.message);
  check_unchanged();

  // half precision ends at 65504: a file with an infinite weight could not be loaded any more
  model.denoiser.registers = ml::Tensor<B, 2>::full(model.denoiser.registers->shape(), 1e5);
  CHECK_THROWS_WITH_AS(ml::save_stmc(path, model, small::config(), {}),
                       doctest::Contains("[motionlang.numeric.301] TensorStore: number 0 of 'denoiser.registers'"),
                       ml::numeric_error);
  check_unchanged();
}

TEST_CASE("names that do not match") {
  check_refused([](Parts& p) { p.tensors.erase("denoiser.to_skel_layer.bias"); }, 406,
                {"1 tensor is missing, 0 are not expected:\n  missing    denoiser.to_skel_layer.bias"});
  check_refused(
      [](Parts& p) {
        p.tensors["denoiser.more"] = {{2}, {1, 2}};
      },
      406, {"0 tensors are missing, 1 is not expected:\n  unexpected denoiser.more"});
  check_refused([](Parts& p) { p.tensors.erase("denoiser.seqTransEncoder.layers.1.linear1.weight"); }, 406,
                {"no tensor 'denoiser.seqTransEncoder.layers.1.linear1.weight'"});
  check_refused([](Parts& p) { p.tensors.clear(); }, 406, {"no tensor"});
}

TEST_CASE("shapes that do not match, each with both") {
  check_refused(
      [](Parts& p) {
        p.tensors["denoiser.to_skel_layer.bias"].shape = {5, 41};
      },
      407, {"tensor 'denoiser.to_skel_layer.bias' is (5, 41), the model has (205)"});
  check_refused(
      [](Parts& p) {
        p.tensors["denoiser.registers"].shape = {32, 2};
      },
      407, {"tensor 'denoiser.registers' is (32, 2), the metadata say (2, 32)"});
}

TEST_CASE("numbers that are not finite") {
  for (const float wrong : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    check_refused([&](Parts& p) { p.tensors["denoiser.to_skel_layer.bias"].values[7] = wrong; }, 301,
                  {"number 7 of tensor 'denoiser.to_skel_layer.bias' is ", std::isnan(wrong) ? "nan" : "inf"});
  }
}

TEST_CASE("of several numbers that are not finite the first is reported, for any use and on any number of threads") {
  Parts p;
  p.tensors["denoiser.registers"].values[1] = std::numeric_limits<float>::quiet_NaN();
  p.tensors["text_encoder.projection.weight"].values[2] = std::numeric_limits<float>::infinity();
  const TemporaryFolder folder;
  ml::write_file(folder / "model.safetensors", p.bytes());
  const auto file = ml::SafetensorsFile::open(folder / "model.safetensors");
  const int before = ml::thread_count();
  for (const int threads : {1, 2}) {
    ml::set_thread_count(threads);
    for (const auto use : {ml::LoadFor::any_use, ml::LoadFor::inference}) {
      auto model = small::model<B>();
      const Refusal r = refusal([&] { ml::load_module(model, file, "", use); });
      CHECK(r.id == 301);
      CHECK_MESSAGE(r.message.find("number 1 of tensor 'denoiser.registers' is nan") != std::string::npos, r.message);
    }
  }
  ml::set_thread_count(before);
}

TEST_CASE("loaded for inference, a model is ready unless something is missing; for any use it is as in the file") {
  const auto packed = [](const ml::Stmc<B>& m) { return m.denoiser.text_in.weight.data().attached() != nullptr; };
  Parts p;
  const auto file = [&] { return ml::SafetensorsFile::from_bytes(p.bytes(), "model.safetensors"); };
  auto model = small::model<B>();
  ml::load_module(model, file());
  CHECK(!packed(model));
  ml::load_module(model, file(), "", ml::LoadFor::inference);
  CHECK(packed(model));
  CHECK(packed(load(p.bytes())));

  p.tensors.erase("denoiser.to_skel_layer.bias");
  auto part = small::model<B>();
  part.denoiser.to_skel_layer.bias =
      ml::Tensor<B, 1>::full(part.denoiser.to_skel_layer.bias.shape(), NAN);  // its own, not the file's
  const auto report = ml::load_module_partly(part, file(), "", ml::LoadFor::inference);
  CHECK(report.missing == std::vector<std::string>{"denoiser.to_skel_layer.bias"});
  CHECK(!packed(part));
}

TEST_CASE("metadata: every key is needed and checked") {
  const Parts good;
  for (const auto& entry : good.metadata) {
    const std::string& key = entry.first;
    if (key == "diffusion.noise_scale" || key == "denoiser.activation" || key == "denoiser.max_len" ||
        key == "text.longest" || key == "sampling")
      continue;  // have defaults
    Parts parts;
    parts.metadata.erase(key);
    const auto bytes = parts.bytes();
    const int id = refusal([&] { load(bytes); }).id;
    CHECK_MESSAGE((id == 103 || id == 107), key);
  }
  check_metadata("model", "tmr", 103, {"not an STMC model of format 1"});
  check_metadata("format", "2", 103, {"not an STMC model of format 1"});
  check_metadata("features", "guoh3dfeats", 103, {"'guoh3dfeats'"});
  check_metadata("diffusion.schedule", "linear", 103, {"'linear'"});
  check_metadata("diffusion.noise_scale", "loud", 103, {"'loud'"});
  check_metadata("denoiser.num_layers", "two", 107, {"'denoiser.num_layers' = 'two' is not a number"});
  check_metadata("denoiser.num_layers", "2.5", 107, {"'2.5'"});
  check_metadata("denoiser.nfeats", "204", 101, {"204", "205"});
  check_metadata("denoiser.num_heads", "3", 101, {"denoiser.num_heads = 3 does not divide the even width 32"});
  check_metadata("text.heads", "5", 101, {"text.heads = 5 does not divide the even width 16"});
  check_metadata("text.vocabulary", "[CLS]\n[SEP]", 107, {"2 pieces"});
  check_metadata("text.vocabulary", "[CLS]\n[SEP]\n[UNK]\na\na", 107, {"'a' is duplicated"});
  check_metadata("text.vocabulary", "[CLS]\n[SEP]\n[UNK]\na", 407, {"text_encoder.embedding.weight", "(4, 16)"});
  for (const char* fps : {"0", "-20", "nan", "inf", "1e300"})
    check_metadata("fps", fps, 101, {"'fps' = ", "is not in 1 ... 1000"});
  check_metadata("diffusion.steps", "5000", 101, {"'diffusion.steps' = 5000 is not in 1 ... 1024"});
  check_metadata("denoiser.activation", "sine", 103, {"'sine'"});
  check_metadata("guidance", "nan", 101, {"'guidance' = nan"});
  check_metadata("sampling", "ddim -3", 101, {"-3 steps of sampling, the process has 8"});
  check_metadata("sampling", "ddpm 9", 101, {"9 steps of sampling, the process has 8"});
  check_metadata("sampling", "ddpm many", 107, {"'sampling' = 'many'"});
  for (const char* sampler : {"", "euler 5", "DDPM"})
    check_metadata("sampling", sampler, 103, {"is not one of ddpm, ddim, plms"});
}

TEST_CASE("hostile sizes are refused before memory is taken") {
  const Parts good;
  rusage before{}, after{};
  ::getrusage(RUSAGE_SELF, &before);
  for (const auto& [key, value] : good.metadata) {
    if (value.empty() || value.find_first_not_of("0123456789") != std::string::npos) continue;
    if (key == "format" || key == "fps") continue;
    for (const char* size : {"-1", "0", "99999999999999999999999", "9223372036854775807", "100001"}) {
      Parts parts;
      parts.metadata[key] = size;
      const auto bytes = parts.bytes();
      const auto refused = refusal([&] { load(bytes); });
      if (key == "denoiser.nb_registers" && std::string(size) == "0") {  // a model may have none, the file has some
        CHECK_MESSAGE(refused.message.find("unexpected denoiser.registers") != std::string::npos, refused.message);
        continue;
      }
      CHECK_MESSAGE((refused.id == 101 || refused.id == 107), refused.message);
      CHECK_MESSAGE(refused.message.find(key) != std::string::npos, refused.message);
    }
    // within the limits, but not what the tensors are: refused by the first tensor that disagrees
    if (key == "diffusion.steps" || key == "denoiser.nfeats" || key.ends_with("heads")) continue;
    if (key == "denoiser.max_len" || key == "text.longest") continue;  // no tensor depends on them
    Parts parts;
    parts.metadata[key] = key.ends_with("layers") || key.ends_with("registers") ? "256" : "8192";
    const auto bytes = parts.bytes();
    const auto refused = refusal([&] { load(bytes); });
    CHECK_MESSAGE((refused.id == 406 || refused.id == 407), refused.message);
  }
  ::getrusage(RUSAGE_SELF, &after);
  CHECK(after.ru_maxrss - before.ru_maxrss < 32 * 1024);  // kilobytes
}

TEST_CASE("a file that ends too early is refused wherever it ends") {
  const auto bytes = Parts().bytes();
  for (std::size_t end :
       {std::size_t{0}, std::size_t{7}, std::size_t{8}, std::size_t{100}, bytes.size() / 2, bytes.size() - 1}) {
    const std::vector<std::byte> part(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(end));
    const auto refused = refusal([&] { load(part); });
    CHECK_MESSAGE(refused.id == 402, refused.message);
  }
  CHECK(refusal([] { ml::load_stmc<B>("/nowhere/model.safetensors"); }).id == 401);
}
