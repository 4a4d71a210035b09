#include "generation.hpp"

#include <charconv>

#include <motionlang/weights/mdm_action_run.hpp>
#include <motionlang/weights/run_folder.hpp>
#include <motionlang/weights/stmc_file.hpp>

#include "../commands.hpp"

namespace program {

namespace {

/// The system of a folder, "" of a file and of a folder that only has one of ours in it; of our own trainings "trained
/// actor" and so on.
std::string system_of(const ml::RunFolder& run) {
  if (ml::is_mdm_action_run(run)) return "mdm of actions";
  const ml::FileValue* system = run.system == "motionlang" ? run.option("system") : nullptr;
  const std::string own = system == nullptr ? "" : to_string(*system);
  const bool trained = own == "actor" || own == "temos" || own == "tmr" || own == "sinc" || own == "teach";
  return trained ? "trained " + own : run.system;
}

/// Null for what goes through STMC.
std::unique_ptr<Generator> load_other(const std::string& system, const std::filesystem::path& model,
                                      const ModelSources& sources) {
  if (system == "actor") return load_actor(model);
  if (system == "temos") return load_temos(model, sources);
  if (system == "tm2t") return load_tm2t(model, sources);
  if (system == "mdm of actions") return load_mdm_actions(model);
#ifdef MOTIONLANG_TRAINING
  if (system == "trained actor") return load_trained_actor(model);
  if (system.starts_with("trained ") || system == "tmr") return load_trained_text_motion(model, sources);
#else
  if (system.starts_with("trained ") || system == "tmr")
    ml::raise<usage_error>(103, model.string(),
                           ": models of train-actor, train-temos, train-sinc, train-teach and train-tmr, and TMR, need "
                           "a program with training "
                           "(-DMOTIONLANG_TRAINING=ON)");
#endif
  return nullptr;
}

}  // namespace

std::unique_ptr<Generator> load_generator(const std::string& backend, const std::filesystem::path& path,
                                          const ModelSources& sources) {
  std::filesystem::path model = path;
  std::string system;
  if (std::filesystem::is_directory(path)) {
    ml::RunFolder run = ml::find_run(path);
    if (run.system.empty()) {
      model = model_folder(path);
      run = ml::find_run(model);
    }
    system = system_of(run);
  }
  if (auto other = load_other(system, model, sources)) {
    if (backend != "eigen")
      ml::raise<usage_error>(103, model.string(), " (", system, ") is generated with backend 'eigen', not '", backend,
                             "'");
    return other;
  }
  const bool published = !system.empty();
  if (!published && !(sources.text_encoder.empty() && sources.statistics.empty() && sources.tokenizer.empty()))
    ml::raise<usage_error>(
        102, model.string(),
        ": --text-encoder, --statistics and --tokenizer are for published models; this one has its own");
  if (backend == "eigen") return published ? load_published_eigen(model, sources) : load_eigen(model_file(model));
  if (backend == "xtensor") return published ? load_published_xtensor(model, sources) : load_xtensor(model_file(model));
  if (backend == "reference")
    return published ? load_published_reference(model, sources) : load_reference(model_file(model));
  ml::raise<usage_error>(103, "backend '", backend, "' is not one of eigen, xtensor, reference");
}

const ml::Interval& only_text(const ml::Timeline& timeline) {
  if (timeline.intervals.size() != 1)
    ml::raise<ml::timeline_error>(509, ml::counted(timeline.intervals.size(), "text"),
                                  " in a timeline; this model takes one, with a duration");
  return timeline.intervals.front();
}
ml::Index action_of(const std::string& text, std::span<const std::string> labels, ml::Index classes) {
  const auto found = std::find(labels.begin(), labels.end(), text);
  if (found != labels.end()) return found - labels.begin();
  ml::Index number = -1;
  const char* const end = text.data() + text.size();
  if (std::from_chars(text.data(), end, number).ptr == end && number >= 0 && number < classes) return number;
  const std::string known = labels.empty() ? "" : "; they are called " + ml::join_text(labels);
  ml::raise<ml::config_error>(103, "action '", text, "' is not one of 0 ... ", classes - 1, known);
}
void require_no_noise(const GenerationSettings& settings) {
  if (!settings.noise_file.empty())
    ml::raise<usage_error>(102, "--noise is for diffusion models; this one takes --seed");
  if (!settings.record_file.empty() || !settings.reuse_file.empty())
    ml::raise<usage_error>(102,
                           "--record and --reuse are for diffusion models; this one makes every motion in one step");
  if (settings.keep)
    ml::raise<usage_error>(
        102, "--keep is for diffusion models of texts (STMC, MDM, MotionDiffuse); this one makes whole motions");
}

void require_no_sampling(const GenerationSettings& settings) {
  if (settings.steps || settings.guidance || !settings.sampler.empty())
    ml::raise<usage_error>(
        102, "--steps, --sampler, --preset and --guidance are for diffusion models; this one takes no such steps");
}

void require_steps(const GenerationSettings& settings, const Generator& model) {
  if (model.steps() == 0) return require_no_sampling(settings);
  if (settings.steps.value_or(0) > model.steps())
    ml::raise<usage_error>(105, ml::counted(*settings.steps, "step is", "steps are"), " asked for, this model has ",
                           model.steps());
}

std::filesystem::path model_folder(const std::filesystem::path& path) {
  const auto inside = path / "model";
  return !std::filesystem::exists(path / "config.json") && std::filesystem::exists(inside / "config.json") ? inside
                                                                                                           : path;
}

std::filesystem::path model_file(const std::filesystem::path& path) {
  if (!std::filesystem::is_directory(path)) return path;
  std::vector<std::filesystem::path> found;
  for (const auto& entry : std::filesystem::directory_iterator(path)) {
    if (entry.path().extension() == ".safetensors" && entry.path().filename() != "checkpoint.safetensors")  // of train
      found.push_back(entry.path());
  }
  if (found.size() != 1)
    ml::raise<ml::io_error>(401, path.string(), ": ", found.size(), " .safetensors files where one is expected");
  return found.front();
}

}  // namespace program
