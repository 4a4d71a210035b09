// motionlang pack: the folder of a published model as a model folder of ours.
#include <cstdio>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/weights/model_summary.hpp>
#include <motionlang/weights/pack_run.hpp>

#include "../commands.hpp"
#include "../option_checks.hpp"

namespace program {

namespace {

namespace ml = motionlang;
using B = ml::EigenBackend<float>;

struct PackOptions {
  std::string run, out, license, provenance, text_encoder, statistics, tokenizer;
  bool with_text_encoder = false;
};

void run(const PackOptions& o) {
  ml::pack_run<B>(ml::find_run(o.run), o.out,
                  {.license = o.license,
                   .provenance = o.provenance,
                   .sources = {.text_encoder = o.text_encoder, .statistics = o.statistics},
                   .text_encoder = o.with_text_encoder,
                   .tokenizer = o.tokenizer});
  std::printf("%s\n%s", o.out.c_str(), ml::describe_folder(o.out).c_str());
}

}  // namespace

void add_pack(CLI::App& app) {
  const auto o = std::make_shared<PackOptions>();
  CLI::App* c = app.add_subcommand("pack",
                                   "Packs a published model (STMC, MDM, MotionDiffuse, ACTOR, TEMOS, TMR, TEACH, SINC, "
                                   "TM2T) into one folder with config.json and weights.safetensors");
  folder_option(*c, "run", o->run, "Folder as the repository leaves it")->required();
  c->add_option("-o,--out", o->out, "Folder to write")->required();
  c->add_option("--license", o->license, "Licence of the weights")->required();
  c->add_option("--provenance", o->provenance, "Origin of the weights: repository and data")->required();
  folder_option(*c, "--statistics", o->statistics,
                "Folder with mean and std of the features, if the model's own folder lacks them");
  path_option(*c, "--text-encoder", o->text_encoder, "Text encoder. The default is to look beside the model");
  folder_option(*c, "--tokenizer", o->tokenizer,
                "TM2T: folder of the motion tokenizer. The default is to look beside the model");
  c->add_flag("--with-text-encoder", o->with_text_encoder,
              "Copy the text encoder into the folder. For TEMOS, TEACH and SINC this is the tokenizer, for TM2T the "
              "word vectors");
  c->callback([o] { run(*o); });
}

}  // namespace program
