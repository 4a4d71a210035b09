// motionlang tokens: the motion tokens of TM2T, of motions and as pictures.
#include <cstdio>

#include <motionlang/backend/eigen.hpp>
#include <motionlang/generate/token_clips.hpp>
#include <motionlang/weights/tm2t_run.hpp>

#include "../commands.hpp"
#include "../files/motion_files.hpp"
#include "../machine_options.hpp"
#include "../option_checks.hpp"
#include "../progress_bar.hpp"

namespace program {

namespace {

using B = ml::EigenBackend<float>;

struct TokenOptions {
  std::vector<std::string> inputs;
  std::string model, page;
  std::vector<ml::Index> codes;
  ml::Index most = 24;
  MotionReadOptions read;
  MachineOptions machine;
};

void run(const TokenOptions& o) {
  o.machine.apply();
  if (o.inputs.empty() && o.page.empty())
    ml::raise<usage_error>(102, "motions are required, or --page for pictures of the codes");
  ml::InputFiles inputs(o.inputs);
  inputs.add(o.read.joints);
  inputs.add(o.read.asf);
  inputs.refuse(o.page);
  const auto model = ml::load_tm2t_tokenizer<B>(ml::find_run(ml::found_model_folder(o.model)));
  const ml::Index known = model.vocabulary().codes;
  std::vector<std::vector<ml::Index>> all;
  for (const std::string& input : o.inputs) {
    for (const ml::Motion& motion : read_motions(input, o.read)) {
      all.push_back(ml::tokens_of(model, motion));
      std::printf("%s %s\n", ml::printable(input).c_str(), ml::join_text(all.back(), " ").c_str());
    }
  }
  if (all.size() > 1) std::printf("%zu of %td codes in use\n", ml::counted_codes(all).size(), known);
  if (o.page.empty()) return;
  const auto codes = ml::codes_to_show(o.codes, all, o.most, known);
  const auto clips = ml::token_clips(model, std::span(codes));
  ml::write_file(o.page, std::string_view(ml::token_page(clips, "Motion tokens of " + o.model)));
  std::printf("%s  %s\n", ml::counted(clips.size(), "code").c_str(), o.page.c_str());
}

}  // namespace

void add_tokens(CLI::App& app) {
  const auto o = std::make_shared<TokenOptions>();
  CLI::App* c = app.add_subcommand(
      "tokens", "Prints the motion tokens of motions, and draws what each code of TM2T's tokenizer stands for");
  c->add_option("input", o->inputs, "Motion files")->check(CLI::ExistingFile);
  c->add_option("--model", o->model, "Folder with a motion tokenizer: from train-tm2t, or VQVAEV3_... as published")
      ->required()
      ->check(CLI::ExistingDirectory);
  c->add_option("--page", o->page, "Page (.html) with a film strip of four frames for each code");
  c->add_option(
       "--codes", o->codes,
       "Numbers of the codes to draw. The default is the commonest of the motions, or without motions the first")
      ->delimiter(',')
      ->check(not_negative());
  c->add_option("--most", o->most, "Number of codes to draw without --codes")
      ->check(in_range(1, 100000))
      ->capture_default_str();
  o->read.add_to(*c);
  o->machine.add_to(*c);
  c->callback([o] { run(*o); });
}

}  // namespace program
