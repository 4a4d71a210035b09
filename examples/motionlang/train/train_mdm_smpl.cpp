// motionlang train-mdm-smpl: the denoiser that STMC composes. The preset "bundled" trains the bundled model.
#include <algorithm>
#include <array>
#include <string_view>

#include "../usage_error.hpp"
#include "stmc_run.hpp"
#include "train_diffusion.hpp"

namespace program {

namespace {

constexpr const char* bundled = "bundled";
constexpr std::array<std::string_view, 4> presets{"mdm-smpl-published", "mdm-smpl-paper", "small", bundled};

void require_absent(bool given, const char* option, const std::string& why) {
  if (given) ml::raise<usage_error>(102, option, why);
}

void run_bundled(const DiffusionOptions& o, StmcRun run) {
  constexpr const char* why = " is not for --preset bundled";
  require_absent(!o.texts.annotations.empty(), "--annotations", ml::concat_text(why, ", which reads --captions"));
  require_absent(!o.common.splits.empty(), "--splits", ml::concat_text(why, ", which has no validation and no tests"));
  require_absent(!o.text_encoder.empty(), "--text-encoder", ml::concat_text(why, ", which learns its own"));
  require_absent(!o.statistics.empty(), "--statistics", ml::concat_text(why, ", which measures its own"));
  if (o.texts.captions.empty() && !o.common.print_config)
    ml::raise<usage_error>(102, "--preset bundled needs --captions");
  skip_texts_of(run);
  read_settings(run.config, o.common);
  as_usage([&] { run.config.require_consistent(); });
  if (!begin_training(o.common, ml::config_json(run.config))) return;
  run.data = o.common.data, run.captions = o.texts.captions;
  run.run = o.common.run;
  run.run.communicator = processes();
  run.about = {{"license", o.common.license}, {"provenance", o.common.provenance}, {"commit", o.common.commit}};
  run_stmc(run);
}

}  // namespace

void add_train_mdm_smpl(CLI::App& app) {
  const DiffusionCommand c(
      app, "train-mdm-smpl",
      "Trains MDM-SMPL, the model of STMC, as published, or with --preset bundled as the bundled model. Ctrl-C saves; "
      "the same command continues",
      {presets.begin(), presets.end()},
      "CLIP ViT-B/32 for text.encoder = clip: ViT-B-32.pt, the folder clip-vit-base-patch32, or the .npy file of an "
      "embedding cache");
  const auto run = std::make_shared<StmcRun>();
  add_start_options(*c.app, *run, "With --preset bundled: ");
  c.app->callback([o = c.options, run] {
    if (o->common.preset == bundled) return run_bundled(*o, *run);
    const std::string why = " is for --preset bundled, not for " + o->common.preset;
    require_absent(!run->vectors.empty(), "--word-vectors", why);
    require_absent(!run->start.empty(), "--start", why);
    if (std::ranges::find(presets, o->common.preset) == presets.end())
      ml::raise<usage_error>(103, "--preset ", o->common.preset, ": expected ", ml::join_text(presets));
    run_diffusion<ml::MdmSmplSystem>(*o, &ml::mdm_smpl_preset);
  });
}

}  // namespace program
