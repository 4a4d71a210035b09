#include "generation.hpp"

#include <motionlang/io/run_folder.hpp>

#include "../commands.hpp"

namespace program {

namespace {

/// Of a folder; "" of a file, and of a folder that only has one of ours in it.
std::string system_of(const std::filesystem::path& model) {
  return std::filesystem::is_directory(model) ? ml::find_run(model).system : "";
}

}  // namespace

std::unique_ptr<Generator> load_generator(const std::string& backend, const std::filesystem::path& model,
                                          const ModelSources& sources) {
  const std::string system = system_of(model);
  if (system == "actor" || system == "temos") {
    if (backend != "eigen") ml::raise<ml::config_error>(103, system, " is generated with backend 'eigen', not '", backend, "'");
    return system == "actor" ? load_actor(model) : load_temos(model, sources);
  }
  const bool published = !system.empty();
  if (backend == "eigen") return published ? load_published_eigen(model, sources) : load_eigen(model_file(model));
  if (backend == "xtensor") return published ? load_published_xtensor(model, sources) : load_xtensor(model_file(model));
  if (backend == "reference")
    return published ? load_published_reference(model, sources) : load_reference(model_file(model));
  ml::raise<ml::config_error>(103, "backend '", backend, "' is none of eigen, xtensor, reference");
}

const ml::Interval& only_text(const ml::Timeline& timeline) {
  if (timeline.intervals.size() != 1)
    ml::raise<ml::timeline_error>(509, timeline.intervals.size(), " texts in a timeline; this model takes one, with a duration");
  return timeline.intervals.front();
}
void require_no_noise(const GenerationSettings& settings) {
  if (!settings.noise_file.empty())
    ml::raise<ml::config_error>(102, "--noise is for diffusion models; this one takes --seed");
}

std::filesystem::path model_file(const std::filesystem::path& path) {
  if (!std::filesystem::is_directory(path)) return path;
  std::vector<std::filesystem::path> found;
  for (const auto& entry : std::filesystem::directory_iterator(path)) {
    if (entry.path().extension() == ".safetensors") found.push_back(entry.path());
  }
  if (found.size() != 1)
    ml::raise<ml::io_error>(401, path.string(), ": ", found.size(), " .safetensors files where one is expected");
  return found.front();
}

}  // namespace program
