// Motions on a body: the user's own of the SMPL family, or the free one. Apart from motion_files.cpp, for its backend takes time to
// compile.
#include <cstdio>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/io/body_file.hpp>
#include <motionlang/io/body_glb.hpp>
#include <motionlang/io/body_viewer.hpp>
#include <motionlang/io/figure_body.hpp>

#include "motion_files.hpp"

namespace program {

void write_on_body(const std::filesystem::path& path, std::span<const ml::Motion> motions, const BodyOptions& options) {
  if (motions.empty()) ml::raise<ml::config_error>(101, path.string(), ": no motion");
  using B = ml::EigenBackend<float>;
  const bool free = options.file == "free";
  const auto body = free ? ml::figure_body<B>(motions.front().skeleton)
                         : ml::read_body<B>(options.file, {.betas = std::ssize(options.betas), .expressions = 0});
  const std::vector<float> betas(options.betas.begin(), options.betas.end());
  std::vector<ml::Motion> own;
  for (const ml::Motion& m : motions) own.push_back(free ? m : on_smpl(m));
  const std::string kind = kind_of(path);
  if (kind == ".glb") {
    ml::write_body_glb(path, body, std::span<const ml::Motion>(own), std::span<const float>(betas));
  } else if (kind == ".html") {
    std::vector<ml::ViewerMotion> shown;
    for (ml::Motion& m : own) shown.push_back({std::move(m)});
    ml::write_body_viewer(path, body, std::span<const ml::ViewerMotion>(shown), std::span<const float>(betas));
  } else if (kind == ".obj" && own.size() == 1) {
    std::printf("%td files: ", ml::write_body_objs(path, body, own.front(), std::span<const float>(betas)));
  } else {
    ml::raise<ml::config_error>(103, path.string(), ": ", motions.size(),
                                " motions on a body are written to .glb and .html, one also to .obj, not '", kind, "'");
  }
  std::printf("%s: %zu motions on %s of %td vertices\n", path.c_str(), motions.size(),
              free ? "the free body" : to_string(body.kind).c_str(), body.model.vertices());
}

}  // namespace program
