// The whole job: a timeline of three texts and 12 s, all 100 steps, with random weights of the published size
// (stmc_full) and with the bundled model (stmc_bundled): real-time factor (time taken, loading included, by length of
// the motion), and peak memory beyond the file of weights. And how long a program takes from its start to the end of
// its first denoising step, and its memory then (start). Every run is a program of its own: this one, started again.
//
// usage: bench_generate [THREADS] [--bf16 | --bf16x3] [stmc_full stmc_bundled start ...]
#include <motionlang/stmc.hpp>
#include <motionlang/weights/stmc_file.hpp>

#include "again.hpp"
#include "models.hpp"

namespace {

using namespace bench;
using B = ml::EigenBackend<float>;
namespace fs = std::filesystem;

constexpr ml::StmcModelConfig published{.denoiser = ml::MdmSmplConfig{.activation = ml::Activation::gelu},
                                        .text = {.width = 512, .heads = 8, .d_ff = 2048, .layers = 2, .out = 512}};

void write_published(const fs::path& path) {
  const ml::WordPiece words({"[CLS]", "[SEP]", "[UNK]", "a", "person", "walks"}, "words");
  ml::save_stmc(path, ml::make_stmc<B>(published, words, ml::Philox{.seed = 1}), published, {}, ml::DType::F32);
}
void write_mdm(const fs::path& path) {
  ml::Philox rng{.seed = 1};
  ml::TensorStore store;
  store.add_module(ml::MdmSmplDenoiser<B>(mdm, rng));
  ml::write_safetensors(path, store.views());
}

void generate(const std::string& work, const fs::path& path, double start) {
  const auto stmc = ml::load_stmc<B>(path);
  const auto timeline = ml::parse_timeline(
      "walk forward # 0.0 # 7.0 # legs\n"
      "raise both arms # 2.0 # 6.0 # left arm # right arm\n"
      "turn around # 7.0 # 12.0 # legs # spine\n");
  const auto features = stmc.generate(timeline, ml::Philox{.seed = 7}, {.steps = 0});
  const double length = static_cast<double>(features.size(0)) / stmc.fps;
  report_value(work, "real-time factor", (now() - start) / length);
  report_value(work, "MB beyond the weights", peak_memory() - static_cast<double>(fs::file_size(path)) * 1e-6);
}

void first_step(const fs::path& path, double start) {
  ml::NoInit no_init;
  ml::MdmSmplDenoiser<B> model(mdm, no_init);
  ml::load_module(model, ml::SafetensorsFile::open(path), "", ml::LoadFor::inference);
  const MdmBatch<B> batch(equal(2, 200), {.seed = 1});
  model(batch.x, batch.t, batch.text);
  report_value("start", "ms to the end of the first step", (now() - start) * 1e3);
  report_value("start", "MB of the program then", peak_memory());
}

/// The work of the program that was started again for one measurement.
void run(const std::string& work, const fs::path& path, double start) {
  if (work == "write published") return write_published(path);
  if (work == "write mdm") return write_mdm(path);
  if (work == "start") return first_step(path, start);
  generate(work, path, start);
}

}  // namespace

int main(int argc, char** argv) {
  const Arguments asked_for(argc, argv);
  if (argc == 7 && std::string(argv[3]) == "run") return run(argv[4], argv[5], std::atof(argv[6])), 0;
  const auto again = [&](const std::string& work, const fs::path& path) {
    const bool halves = ml::product_precision() == ml::Precision::bf16;
    return run_again({std::to_string(ml::thread_count()), halves ? "--bf16" : "--fp32", "run", work, path.string(),
                      std::to_string(now())});
  };
  bool good = true;
  if (asked_for.asked("stmc_full")) {
    const TemporaryFile file;
    good = again("write published", file.path) && again("stmc_full", file.path);
  }
  if (asked_for.asked("stmc_bundled")) good = again("stmc_bundled", MOTIONLANG_BENCH_MODEL) && good;
  if (asked_for.asked("start")) {
    const TemporaryFile file;
    good = again("write mdm", file.path) && good;
    for (int i = 0; i < 5; ++i) good = again("start", file.path) && good;
  }
  return good ? 0 : 1;
}
