// motionlang describe: describes motions in words with a TM2T from motions to texts. The default is the bundled one. It
// may also come from train-tm2t or from its repository.
#include <cstdio>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/generate/describe_files.hpp>

#include "../commands.hpp"
#include "../files/motion_files.hpp"
#include "../formatted.hpp"
#include "../machine_options.hpp"
#include "../option_checks.hpp"
#include "../progress_bar.hpp"

namespace program {

namespace {

using B = ml::EigenBackend<float>;

struct DescribeOptions {
  std::vector<std::string> inputs;
  std::string model = default_describing_model().string(), tokenizer, words, out;
  ml::DescribeOptions how;
  bool json = false;
  std::uint64_t seed = 0;
  MotionReadOptions read;
  MachineOptions machine;
};

/// Throws what files_to_describe throws; usage_error 102 if the table would replace an input.
std::vector<ml::FileToDescribe> files_of(const DescribeOptions& o) {
  std::string skipped;
  auto out = ml::files_to_describe(o.inputs, &skipped);
  std::fputs(skipped.c_str(), stderr);
  if (out.empty()) ml::raise<ml::config_error>(101, "describe: no motion file in ", o.inputs.front());
  ml::InputFiles inputs{o.read.joints, o.read.asf};
  for (const ml::FileToDescribe& f : out) inputs.add(f.path);
  inputs.refuse(o.out);
  if (!o.out.empty()) ml::require_different_clips(out);
  return out;
}

void run(const DescribeOptions& o) {
  if (!o.out.empty()) require_folder_of(o.out);
  o.machine.apply();
  const auto files = files_of(o);
  const ml::MotionDescriber<B> describer(
      ml::load_tm2t_describer<B>(ml::find_run(o.model), {.tokenizer = o.tokenizer, .words = o.words}));
  ml::DescribedFiles described;
  try {
    ProgressBar bar("describing");
    ml::describe_files(describer, files, o.read, o.how, described, {.seed = o.seed}, bar);
  } catch (const ml::cancelled&) {}
  const bool stopped = described.done < files.size();
  const auto& parts = described.parts;
  if (!o.out.empty() && !parts.empty()) ml::write_file(o.out, ml::caption_table(parts, o.model, described.problems));
  for (const std::string& problem : described.problems)
    std::fprintf(stderr, "skipped: %s\n", ml::printable(with_options(problem)).c_str());
  if (parts.empty() && !stopped)
    ml::raise<ml::config_error>(101, "describe: none of the ", ml::counted(files.size(), "file"),
                                " could be described");
  print(o.json ? ml::described_json(parts) : ml::described_text(parts));
  if (!o.json && !o.out.empty()) std::printf("table    %s\n", o.out.c_str());
  if (stopped) throw ml::cancelled();  // the descriptions so far are kept
}

}  // namespace

void add_describe(CLI::App& app) {
  const auto o = std::make_shared<DescribeOptions>();
  CLI::App* c = app.add_subcommand("describe", "Captions motions with a TM2T model from motions to texts");
  path_option(*c, "input", o->inputs,
              "Motion files (.bvh, .amc, .npz of AMASS, .npy of joints or features, .glb, .vrma) and folders of "
              "them. Motions longer than 196 frames at the model's rate are captioned in parts")
      ->required();
  folder_option(*c, "--model", o->model,
                "Folder of the model: from train-tm2t, or M2T_... as published. The default is the bundled model");
  folder_option(*c, "--tokenizer", o->tokenizer,
                "Folder of the motion tokenizer. The default is to look beside the model");
  folder_option(*c, "--text-encoder", o->words,
                "Folder of the word vectors (our_vab_data.npy). The default is to look in the folders above the model");
  c->add_option("-o,--out", o->out,
                "Also write a table of captions, which index and the train commands read. Clips are named by their "
                "paths below the given folder")
      ->check(not_empty());
  checked_option(*c, "--top", o->how.top, in_range(1, 100),
                 "Number of captions for each motion, if there are as many different ones");
  CLI::Option* beams =
      checked_option(*c, "--beams", o->how.beams, in_range(1, 100),
                     "Beams of the search, at least as many as --top; 1 takes the most probable word at each step");
  CLI::Option* sample =
      c->add_flag("--sample", o->how.sample, "Sample words by their probability instead of searching")->excludes(beams);
  c->add_option("--top-k", o->how.top_k, "Sample only from this many of the most probable words")
      ->needs(sample)
      ->check(in_range(1, 1000000))
      ->capture_default_str();
  c->add_option("--seed", o->seed, "Seed of the samples")->needs(sample)->check(seed_number())->capture_default_str();
  c->add_flag("--json", o->json, "Print the result as JSON");
  o->read.add_to(*c);
  o->machine.add_to(*c);
  c->callback([o] { run(*o); });
}

}  // namespace program
