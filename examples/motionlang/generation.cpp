#include "generation.hpp"

#include "commands.hpp"

namespace program {

std::unique_ptr<Generator> load_generator(const std::string& backend, const std::filesystem::path& model) {
  if (backend == "eigen") return load_eigen(model);
  if (backend == "xtensor") return load_xtensor(model);
  if (backend == "reference") return load_reference(model);
  ml::raise<ml::config_error>(103, "backend '", backend, "' is none of eigen, xtensor, reference");
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
