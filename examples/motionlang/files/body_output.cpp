// Motions on a body: the user's own of the SMPL family, or the free one. Apart from motion_files.cpp, for its backend takes time to
// compile.
#include <span>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/io/body_file.hpp>
#include <motionlang/io/body_glb.hpp>
#include <motionlang/io/body_viewer.hpp>
#include <motionlang/io/figure_body.hpp>

#include "motion_files.hpp"

namespace program {

std::string write_on_body(const std::filesystem::path& path, std::span<const ml::Motion> motions, const BodyOptions& options) {
  if (motions.empty()) ml::raise<ml::config_error>(101, path.string(), ": no motion");
  using B = ml::EigenBackend<float>;
  const bool free = options.file == "free";
  auto body = free ? ml::figure_body<B>(motions.front().skeleton)
                   : ml::read_body<B>(options.file, {.betas = std::ssize(options.betas), .expressions = 0});
  ml::prepare(body.model);
  const std::vector<float> betas(options.betas.begin(), options.betas.end());
  std::vector<ml::Motion> own;
  for (const ml::Motion& m : motions) own.push_back(free ? m : on_smpl(m));
  const std::string kind = kind_of(path);
  std::string files;
  if (kind == ".glb") {
    ml::write_body_glb(path, body, std::span<const ml::Motion>(own), std::span<const float>(betas));
  } else if (kind == ".html") {
    std::vector<ml::ViewerMotion> shown;
    for (ml::Motion& m : own) shown.push_back({std::move(m)});
    ml::write_body_viewer(path, body, std::span<const ml::ViewerMotion>(shown), std::span<const float>(betas));
  } else if (kind == ".obj" && own.size() == 1) {
    files = ml::concat_text(ml::write_body_objs(path, body, own.front(), std::span<const float>(betas)), " files: ");
  } else {
    ml::raise<ml::config_error>(103, path.string(), ": ", motions.size(),
                                " motions on a body are written to .glb and .html, one also to .obj, not '", kind, "'");
  }
  return ml::concat_text(files, path.string(), ": ", motions.size(), " motions on ", free ? "the free body" : to_string(body.kind),
                         " of ", body.model.vertices(), " vertices\n");
}

}  // namespace program
