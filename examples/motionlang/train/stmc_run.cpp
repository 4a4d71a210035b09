#include "stmc_run.hpp"

#include <cstdio>
#include <optional>

#include <motionlang/backend/autodiff.hpp>
#include <motionlang/backend/eigen.hpp>
#include <motionlang/train/stmc_training.hpp>
#include <motionlang/weights/word_vector_file.hpp>

#include "../commands.hpp"
#include "../files/motion_files.hpp"
#include "../option_checks.hpp"
#include "../progress_bar.hpp"
#include "training_display.hpp"

namespace program {

void add_start_options(CLI::App& command, StmcRun& o, const std::string& when) {
  file_option(command, "--word-vectors", o.vectors,
              when +
                  "Vectors of words beyond those of the captions, from `motionlang word-vectors`. Every word that "
                  "the captions say twice then is one piece");
  file_option(command, "--start", o.start,
              when +
                  "Start with the weights of this model, which has the same sizes. Its words and features may "
                  "differ. Texts are not learnt first, unless their steps are given");
}

void skip_texts_of(StmcRun& o) {
  if (!o.start.empty()) o.config.text_steps = 0;
}

void run_stmc(const StmcRun& o) {
  auto data = [&] {
    ProgressBar bar("reading motions");
    return ml::TrainingSet(o.captions, o.data, bar);
  }();
  std::printf("%s, %.1f minutes\n", ml::counted(data.segments().size(), "segment").c_str(), data.seconds() / 60);
  const ml::StmcStart start{.model = o.start,
                            .vectors = o.vectors.empty() ? ml::WordVectors() : ml::read_word_vectors(o.vectors)};
  TrainingDisplay display;
  std::optional<ProgressBar> texts;
  auto learning = [&](ml::Index done, ml::Index total) {
    if (!texts) texts.emplace("learning texts");
    const bool goes_on = (*texts)(done, total);
    if (done == total) texts->finish();
    return goes_on;
  };
  auto about = o.about;
  about["command"] = command_line;
  const auto model = ml::train_stmc<ml::Autodiff<ml::EigenBackend<float>>>(
      o.config, data, start, o.run, std::move(about), display.callbacks(), learning);
  if (o.run.communicator.rank() > 0) return;  // the first process wrote the model
  std::printf("weights  %s\nloss     %s\nTry them: motionlang generate --model %s --timeline FILE\n",
              model.string().c_str(), (o.run.out / "loss.svg").string().c_str(), model.string().c_str());
}

}  // namespace program
