// motionlang remember: puts recorded motions and their captions into the weights of a model. Nothing is trained.
#include <cstdio>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/file/input_files.hpp>
#include <motionlang/train/remembered_motions.hpp>
#include <motionlang/weights/motion_memory_file.hpp>
#include <motionlang/weights/run_folder.hpp>
#include <motionlang/weights/stmc_file.hpp>

#include "../commands.hpp"
#include "../formatted.hpp"
#include "../option_checks.hpp"
#include "../progress_bar.hpp"

namespace program {

namespace {

struct RememberCommand {
  std::string model, captions, data, output;
  std::vector<std::string> words;
};

void run(const RememberCommand& o) {
  using B = ml::EigenBackend<float>;
  const ml::FilePath model(ml::stmc_model_file(o.model));
  ml::InputFiles{o.captions}.refuse(o.output);
  const auto stmc = ml::load_stmc<B>(model);
  const auto known = ml::load_known_captions(model, stmc.text_encoder);
  ProgressBar bar("reading clips");
  const ml::TrainingSet data(o.captions, o.data, bar);
  bar.finish();
  const ml::MotionMemory memory = ml::remembered_motions(known, data, o.words);
  ml::write_motion_memory(model, ml::FilePath(o.output), memory);
  double seconds = 0;
  for (const ml::Motion& m : memory.motions()) seconds += m.seconds();
  std::printf("%s remembers %s (%.0f s); %s of %s recall one\n", o.output.c_str(),
              ml::counted(memory.motions().size(), "motion").c_str(), seconds,
              ml::counted(memory.captions_with_motions(), "caption").c_str(),
              ml::counted(memory.captions().actions().size(), "caption").c_str());
}

}  // namespace

void add_remember(CLI::App& app) {
  const auto o = std::make_shared<RememberCommand>();
  CLI::App* c = app.add_subcommand("remember",
                                   "Puts recorded motions and their captions into weights. `generate` then follows "
                                   "them for these captions and for texts like them. Nothing is trained");
  path_option(*c, "--model", o->model, "Weights that know their captions, which train writes: a file or its folder")
      ->required();
  file_option(*c, "--captions", o->captions, "Table of captions, as `train` reads it")->required();
  folder_option(*c, "--data", o->data, "Folder with the clips that the captions name")->required();
  c->add_option("--words", o->words,
                "Only recordings with one of these words in a caption: nod,wave. \"nod\" also finds \"nodding\". "
                "Without it, all are remembered")
      ->delimiter(',');
  c->add_option("--output", o->output,
                "The new weights. They have only these motions, not those that the old ones remembered")
      ->required()
      ->check(not_empty());
  c->callback([o] { run(*o); });
}

}  // namespace program
